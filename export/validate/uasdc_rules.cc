// The WMO UAS demonstration campaign's layout. Source: README of raw_uas_to_netCDF in synoptic/wmo-uasdc.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <regex>

#include "export/validate/netcdf_file.h"

namespace quadsonde::product {
namespace {

struct TableVariable {
  std::string_view name;
  bool required;
  std::string_view units;  ///< numbers must mean the same as in these
};
constexpr TableVariable table[] = {
    {"time", true, ""},
    {"lat", true, "degrees_north"},
    {"lon", true, "degrees_east"},
    {"altitude", true, "m"},
    {"air_temperature", true, "K"},
    {"humidity_mixing_ratio", true, "kg kg-1"},
    {"air_pressure", true, "Pa"},
    {"dew_point_temperature", false, "K"},
    {"wind_direction", false, "degree"},
    {"wind_speed", false, "m s-1"},
    {"relative_humidity", false, "%"},
    {"turbulent_kinetic_energy", false, "m2 s-2"},
    {"eddy_dissipation_rate", false, ""},
    {"non_coordinate_geopotential", false, "m2 s-2"},
    {"geopotential_height", false, "m"},
};

bool is_code(const std::string& text, std::size_t most) {
  return !text.empty() && text.size() <= most && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  });
}

/// "20230327025804" of seconds since 1970, the second cut.
std::string stamp_of(double seconds) {
  const auto whole = std::chrono::sys_seconds(std::chrono::seconds(static_cast<long long>(std::floor(seconds))));
  const auto day = std::chrono::floor<std::chrono::days>(whole);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(whole - day);
  return fmt::format("{:04}{:02}{:02}{:02}{:02}{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count());
}

void check_file_name(const NetcdfFile& f, Findings& found) {
  static const std::regex pattern(R"(UASDC_(\d{3})_([a-zA-Z0-9]{1,5})_(\d{14})Z\.nc)");
  const auto& name = f.file_name();
  std::smatch m;
  if (name.size() > 255 || !std::regex_match(name, m, pattern)) {
    found.add(rule("uasdc.file-name"), "", "it is \"" + name + "\"");
    if (name.find("operatorID") != std::string::npos || name.find("airframeID") != std::string::npos)
      found.add(rule("uasdc.placeholder"), "", "the name still has operatorID or airframeID in it");
    return;
  }
  const auto* time = f.find("time");
  if (time && time->data == NcData::all && !time->values.empty() && std::isfinite(time->values.front()) &&
      std::abs(time->values.front()) < 1e11)
    if (const auto stamp = stamp_of(time->values.front()); stamp != m[3].str())
      found.add(rule("uasdc.file-time"), "",
                fmt::format("the name says {}, the first observation {}", m[3].str(), stamp));
  if (const auto platform = f.global_text("platform_name"); !platform.empty() && platform != m[2].str())
    found.add(rule("uasdc.file-airframe"), "", fmt::format("the name says {}, platform_name {}", m[2].str(), platform));
}

void check_globals(const NetcdfFile& f, Findings& found) {
  const auto said = [&](const char* name) {
    return f.global(name) ? "it is \"" + f.global_text(name) + "\"" : std::string("it is not there");
  };
  const auto conventions = f.global_text("Conventions");
  if (conventions.find("CF-1.8") == std::string::npos || conventions.find("WMO-CF-1.0") == std::string::npos)
    found.add(rule("uasdc.conventions"), ":Conventions", said("Conventions"));
  if (f.global_text("wmo__cf_profile") != "FM 303-2024")
    found.add(rule("uasdc.profile"), ":wmo__cf_profile", said("wmo__cf_profile"));
  if (f.global_text("featureType") != "trajectory")
    found.add(rule("uasdc.feature-type"), ":featureType", said("featureType"));
  if (!is_code(f.global_text("platform_name"), 5))
    found.add(rule("uasdc.platform-name"), ":platform_name", said("platform_name"));
  if (f.global_text("flight_id").empty()) found.add(rule("uasdc.flight-id"), ":flight_id", said("flight_id"));
  static const std::regex metres(R"(-?\d+(\.\d+)?\s*m)");
  const auto terrain = f.global_text("site_terrain_elevation_height");
  if (terrain.size() > 40 || !std::regex_match(terrain, metres))
    found.add(rule("uasdc.terrain"), ":site_terrain_elevation_height", said("site_terrain_elevation_height"));
  const auto level = f.global_text("processing_level");
  if (level != "a1" && level != "b1" && level != "c1")
    found.add(rule("uasdc.processing-level"), ":processing_level", said("processing_level"));
}

void check_variable(const NetcdfFile& f, const TableVariable& row, const NcVariable& v, Findings& found) {
  if (v.dimensions.size() != 1 || f.dimension(v, 0).name != "obs")
    found.add(rule("uasdc.dimension"), v.name, "its dimension is " + (v.dimensions.empty() ? "none" : f.shape_text(v)));
  if (v.type != NcType::float64) found.add(rule("uasdc.type"), v.name, fmt::format("its type is {}", name_of(v.type)));
  const auto units = NetcdfFile::text(v, "units");
  if (!row.units.empty() && !f.units.of(units, std::string(row.units)).same)
    found.add(rule("uasdc.units"), v.name + ":units",
              fmt::format("they are \"{}\", the table has {}", units, row.units));
  static const std::regex since(R"(seconds since \d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)");
  if (row.name == "time" && (units.size() > 60 || !std::regex_match(units, since)))
    found.add(rule("uasdc.time-units"), "time:units", "they are \"" + units + "\"");
  if (row.name == "eddy_dissipation_rate" && !f.units.of(units).known)
    found.add(rule("uasdc.edr-units"), v.name + ":units", "they are \"" + units + "\"");
  const auto* fill = NetcdfFile::attribute(v, "_FillValue");
  const bool coordinate = row.name == "time" || row.name == "lat" || row.name == "lon" || row.name == "altitude";
  if (!coordinate && (!fill || fill->numbers.empty() || !std::isnan(fill->numbers.front())))
    found.add(rule("uasdc.fill"), v.name, fill ? "its _FillValue is no NaN" : "it has no _FillValue");
  std::string absent;
  for (const auto* name : {"units", "long_name", "processing_level"})
    if (NetcdfFile::text(v, name).empty()) absent += (absent.empty() ? "" : ", ") + std::string(name);
  if (!absent.empty()) found.add(rule("uasdc.attributes"), v.name, "empty or not there: " + absent);
}

/// "it is not there", and which variable outside the table may be meant: `pressure` for `air_pressure`.
std::string absent_text(const NetcdfFile& f, const TableVariable& row) {
  for (const auto& v : f.variables())
    if (row.name.ends_with("_" + v.name)) return "it is not there; is it \"" + v.name + "\"?";
  return "it is not there";
}

}  // namespace

void ask_uasdc_units(NetcdfFile& f) {
  for (const auto& row : table)
    if (const auto* v = f.find(row.name); v && !row.units.empty())
      f.units.ask(NetcdfFile::text(*v, "units"), std::string(row.units));
}

void check_uasdc(const NetcdfFile& f, Findings& found) {
  check_file_name(f, found);
  check_globals(f, found);
  for (const auto& row : table) {
    if (const auto* v = f.find(row.name))
      check_variable(f, row, *v, found);
    else if (row.required)
      found.add(rule("uasdc.required"), std::string(row.name), absent_text(f, row));
  }
  if (std::none_of(f.variables().begin(), f.variables().end(),
                   [](const auto& v) { return NetcdfFile::attribute(v, "cf_role") != nullptr; }))
    found.add(rule("uasdc.cf-role"), "", "no variable has a cf_role");
  for (const auto& v : f.variables()) {
    const bool known =
        std::any_of(std::begin(table), std::end(table), [&](const auto& row) { return row.name == v.name; });
    if (!known && v.name != "obs")
      found.add(rule("uasdc.unknown-variable"), v.name, "the campaign's table does not have it");
  }
}

}  // namespace quadsonde::product
