// CF-1.8 sections 1.2, 2.5, 4 and 5: coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/validate/netcdf_file.h"

namespace quadsonde::product {
namespace {

void check_values(const NcVariable& v, Findings& found) {
  if (v.data != NcData::all) return;
  const auto values = NetcdfFile::data(v);
  if (std::any_of(values.begin(), values.end(), [](double x) { return !std::isfinite(x); })) {
    found.add(rule("cf.coordinate-finite"), v.name, "a value is missing or no number");
    return;
  }
  bool rises = true, falls = true;
  for (std::size_t i = 1; i < values.size(); ++i) {
    rises = rises && values[i] > values[i - 1];
    falls = falls && values[i] < values[i - 1];
  }
  if (values.size() > 1 && !rises && !falls)
    found.add(rule("cf.monotonic"), v.name, "its values neither rise nor fall throughout");
}

/// valid_min, valid_max, valid_range of anything.
void check_valid_range(const NcVariable& v, Findings& found) {
  if (v.data != NcData::all) return;
  const auto number = [&](const char* name, std::size_t i) {
    const auto* a = NetcdfFile::attribute(v, name);
    return a && a->numbers.size() > i ? std::optional(a->numbers[i]) : std::nullopt;
  };
  auto low = number("valid_min", 0), high = number("valid_max", 0);
  if (!low) low = number("valid_range", 0);
  if (!high) high = number("valid_range", 1);
  for (const double value : v.values) {
    const auto* fill = NetcdfFile::attribute(v, "_FillValue");
    if (std::isnan(value) || (fill && !fill->numbers.empty() && value == fill->numbers.front())) continue;
    if ((low && value < *low) || (high && value > *high)) {
      found.add(rule("cf.valid-range"), v.name, fmt::format("{} lies outside its valid range", value));
      return;
    }
  }
}

void check_latitude_longitude(const NcVariable& v, Findings& found) {
  const auto name = NetcdfFile::standard_name_of(v), units = NetcdfFile::text(v, "units");
  const bool latitude = name == "latitude" || units == "degrees_north",
             longitude = name == "longitude" || units == "degrees_east";
  if (!latitude && !longitude) return;
  constexpr std::array<std::string_view, 6> north{"degrees_north", "degree_north", "degree_N",
                                                  "degrees_N",     "degreeN",      "degreesN"};
  constexpr std::array<std::string_view, 6> east{"degrees_east", "degree_east", "degree_E",
                                                 "degrees_E",    "degreeE",     "degreesE"};
  const auto& right = latitude ? north : east;
  const auto* which = latitude ? rule("cf.latitude") : rule("cf.longitude");
  if (std::find(right.begin(), right.end(), units) == right.end())
    found.add(which, v.name + ":units", "they are \"" + units + "\"");
  const double low = latitude ? -90 : -180, high = latitude ? 90 : 360;
  if (v.data != NcData::all) return;
  for (const double value : NetcdfFile::data(v))
    if (value < low || value > high) {
      found.add(which, v.name, fmt::format("{} lies outside {} to {}", value, low, high));
      return;
    }
}

void check_vertical(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  const auto positive = lower_case(NetcdfFile::text(v, "positive"));
  const bool said = NetcdfFile::attribute(v, "positive") != nullptr;
  if (said && positive != "up" && positive != "down")
    found.add(rule("cf.positive"), v.name + ":positive", "it is \"" + positive + "\"");
  else if (said && !f.is_vertical(v))
    found.add(rule("cf.positive"), v.name + ":positive", "the variable is no height");
  if (said || !f.is_coordinate(v) || !f.is_vertical(v)) return;
  const auto units = NetcdfFile::text(v, "units");
  if (!f.units.of(units, "Pa").convertible)
    found.add(rule("cf.positive-missing"), v.name, "it is a vertical coordinate without positive");
}

void check_time(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  const bool is_time =
      NetcdfFile::standard_name_of(v) == "time" || NetcdfFile::text(v, "axis") == "T" || v.name == "time";
  if (!is_time) return;
  const auto units = NetcdfFile::text(v, "units");
  if (!units.empty() && !f.units.of(units, "seconds since 1970-01-01").convertible)
    found.add(rule("cf.time-units"), v.name + ":units", "\"" + units + "\" is no time since a date");
  const auto calendar = lower_case(NetcdfFile::text(v, "calendar"));
  constexpr std::array<std::string_view, 10> calendars{"",        "standard", "gregorian", "proleptic_gregorian",
                                                       "noleap",  "365_day",  "all_leap",  "366_day",
                                                       "360_day", "julian"};
  if (std::find(calendars.begin(), calendars.end(), calendar) == calendars.end())
    found.add(rule("cf.calendar"), v.name + ":calendar", "it is \"" + calendar + "\"");
}

void check_axis(const NcVariable& v, Findings& found) {
  if (!NetcdfFile::attribute(v, "axis")) return;
  const auto axis = NetcdfFile::text(v, "axis");
  if (axis != "X" && axis != "Y" && axis != "Z" && axis != "T")
    found.add(rule("cf.axis"), v.name + ":axis", "it is \"" + axis + "\"");
}

void check_named_coordinates(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  for (const auto& name : words(NetcdfFile::text(v, "coordinates"))) {
    const auto where = v.name + ":coordinates";
    const auto* coordinate = f.find(name);
    if (!coordinate) {
      found.add(rule("cf.coordinates"), where, "there is no " + name);
      continue;
    }
    for (std::size_t i = 0; i < coordinate->dimensions.size(); ++i) {
      const bool length_of_text = is_text(coordinate->type) && i + 1 == coordinate->dimensions.size();
      const auto d = coordinate->dimensions[i];
      if (length_of_text || std::find(v.dimensions.begin(), v.dimensions.end(), d) != v.dimensions.end()) continue;
      found.add(
          rule("cf.coordinates-dimensions"), where,
          fmt::format("{} has the dimension {}, which the variable lacks", name, f.dimension(*coordinate, i).name));
    }
  }
}

void check_grid_mapping(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  const auto named = words(NetcdfFile::text(v, "grid_mapping"));
  if (!named.empty()) {
    auto name = named.front();
    if (name.ends_with(':')) name.pop_back();
    const auto* mapping = f.find(name);
    if (!mapping) found.add(rule("cf.grid-mapping"), v.name + ":grid_mapping", "there is no " + name);
  }
  if (!f.is_grid_mapping(v)) return;
  if (NetcdfFile::text(v, "grid_mapping_name").empty())
    found.add(rule("cf.grid-mapping-name"), v.name, "it has no grid_mapping_name");
  int together = 0;
  for (const auto* name :
       {"reference_ellipsoid_name", "prime_meridian_name", "horizontal_datum_name", "geographic_crs_name"})
    together += NetcdfFile::attribute(v, name) != nullptr;
  if (together != 0 && together != 4)
    found.add(rule("cf.crs-names"), v.name, fmt::format("{} of the four are there", together));
}

}  // namespace

void check_cf_coordinates(const NetcdfFile& f, Findings& found) {
  for (const auto& v : f.variables()) {
    const bool coordinate = f.is_coordinate_variable(v);
    if (coordinate && !is_text(v.type)) check_values(v, found);
    if (coordinate)
      for (const auto* name : {"_FillValue", "missing_value"})
        if (NetcdfFile::attribute(v, name))
          found.add(rule("cf.coordinate-fill"), v.name, std::string("it has ") + name);
    check_valid_range(v, found);
    check_axis(v, found);
    check_latitude_longitude(v, found);
    check_vertical(f, v, found);
    check_time(f, v, found);
    check_named_coordinates(f, v, found);
    check_grid_mapping(f, v, found);
  }
}

}  // namespace quadsonde::product
