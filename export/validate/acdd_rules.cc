// ACDD-1.3: what global and variable attributes there should be, and whether they agree with the data.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <regex>

#include "export/validate/netcdf_file.h"
#include "ingest/flight/time.h"

namespace quadsonde::product {
namespace {

void check_globals(const NetcdfFile& f, Findings& found) {
  for (const auto* name : {"title", "summary", "keywords", "Conventions"})
    if (f.global_text(name).empty())
      found.add(rule("acdd.highly-recommended"), std::string(":") + name, "it is not there");
  std::vector<std::string> absent;
  for (const auto* name : {"id",
                           "naming_authority",
                           "history",
                           "source",
                           "processing_level",
                           "comment",
                           "acknowledgement",
                           "license",
                           "standard_name_vocabulary",
                           "date_created",
                           "creator_name",
                           "creator_email",
                           "creator_url",
                           "institution",
                           "project",
                           "publisher_name",
                           "publisher_email",
                           "publisher_url",
                           "geospatial_bounds",
                           "geospatial_lat_min",
                           "geospatial_lat_max",
                           "geospatial_lon_min",
                           "geospatial_lon_max",
                           "geospatial_vertical_min",
                           "geospatial_vertical_max",
                           "geospatial_vertical_positive",
                           "time_coverage_start",
                           "time_coverage_end"})
    if (!f.global(name)) absent.push_back(name);
  if (!absent.empty()) found.add(rule("acdd.recommended"), "", fmt::format("not there: {}", fmt::join(absent, ", ")));
}

void check_variables(const NetcdfFile& f, Findings& found) {
  constexpr std::array<std::string_view, 8> types{"image",
                                                  "thematicClassification",
                                                  "physicalMeasurement",
                                                  "auxiliaryInformation",
                                                  "qualityInformation",
                                                  "referenceInformation",
                                                  "modelResult",
                                                  "coordinate"};
  for (const auto& v : f.variables()) {
    if (!f.is_data(v)) continue;
    const auto type = NetcdfFile::text(v, "coverage_content_type");
    if (type.empty())
      found.add(rule("acdd.content-type-missing"), v.name, "it has no coverage_content_type");
    else if (std::find(types.begin(), types.end(), type) == types.end())
      found.add(rule("acdd.content-type"), v.name + ":coverage_content_type", "it is \"" + type + "\"");
    // One that says nothing of itself at all is told by CF's rule.
    if (NetcdfFile::text(v, "long_name").empty() && !NetcdfFile::text(v, "standard_name").empty())
      found.add(rule("acdd.long-name"), v.name, "it has no long_name");
  }
}

/// Seconds since 1970 of an ISO 8601 date or time.
std::optional<double> seconds_of(const std::string& text) {
  const auto date_only = text.size() == 10 ? text + "T00:00:00Z" : text;
  const auto utc = ingest::parse_iso8601(date_only);
  return utc ? std::optional(static_cast<double>(utc->ns) * 1e-9) : std::nullopt;
}

void check_dates(const NetcdfFile& f, Findings& found) {
  for (const auto* name : {"date_created", "date_modified", "date_issued", "date_metadata_modified",
                           "time_coverage_start", "time_coverage_end"})
    if (const auto text = f.global_text(name); f.global(name) && !seconds_of(text))
      found.add(rule("acdd.date"), std::string(":") + name, "it is \"" + text + "\"");
  static const std::regex duration(
      R"(P(?=.)(\d+(\.\d+)?Y)?(\d+(\.\d+)?M)?(\d+(\.\d+)?D)?(T(?=.)(\d+(\.\d+)?H)?(\d+(\.\d+)?M)?(\d+(\.\d+)?S)?)?)");
  for (const auto* name : {"time_coverage_duration", "time_coverage_resolution"}) {
    const auto text = f.global_text(name);
    if (f.global(name) && (text.size() > 60 || !std::regex_match(text, duration)))
      found.add(rule("acdd.duration"), std::string(":") + name, "it is \"" + text + "\"");
  }
}

std::optional<double> number_of(const NetcdfFile& f, const std::string& name) {
  const auto* a = f.global(name);
  return a && !a->numbers.empty() ? std::optional(a->numbers.front()) : std::nullopt;
}

struct Extent {
  double low = 0, high = 0;
};
std::optional<Extent> extent_of(const NcVariable* v) {
  if (!v || v->data != NcData::all) return std::nullopt;
  auto values = NetcdfFile::data(*v);
  std::erase_if(values, [](double x) { return std::isnan(x); });
  if (values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return Extent{*low, *high};
}

void check_extent(const NetcdfFile& f, const std::string& stem, const NcVariable* v, double tolerance,
                  Findings& found) {
  const auto extent = extent_of(v);
  if (!extent) return;
  const std::pair<std::string, double> ends[] = {{stem + "_min", extent->low}, {stem + "_max", extent->high}};
  for (const auto& [name, value] : ends)
    if (const auto said = number_of(f, name); said && !(std::abs(*said - value) <= tolerance))
      found.add(rule("acdd.extent"), ":" + name, fmt::format("it is {}, {} has {}", *said, v->name, value));
}

/// The variable that the vertical extent is about: a coordinate along Z, else the one called altitude.
const NcVariable* vertical_of(const NetcdfFile& f) {
  for (const auto& v : f.variables())
    if (NetcdfFile::text(v, "axis") == "Z") return &v;
  return f.with_standard_name("altitude");
}

void check_extents(const NetcdfFile& f, Findings& found) {
  check_extent(f, "geospatial_lat", f.with_standard_name("latitude"), 1e-6, found);
  check_extent(f, "geospatial_lon", f.with_standard_name("longitude"), 1e-6, found);
  check_extent(f, "geospatial_vertical", vertical_of(f), 0.01, found);
  if (const auto positive = f.global_text("geospatial_vertical_positive");
      f.global("geospatial_vertical_positive") && positive != "up" && positive != "down")
    found.add(rule("acdd.vertical-positive"), ":geospatial_vertical_positive", "it is \"" + positive + "\"");
  static const std::regex shape(R"(\s*(POINT|LINESTRING|POLYGON|MULTIPOINT)\s*(Z|M|ZM)?\s*\(.*\)\s*)");
  if (const auto bounds = f.global_text("geospatial_bounds");
      f.global("geospatial_bounds") && (bounds.size() > 4000 || !std::regex_match(bounds, shape)))
    found.add(rule("acdd.bounds"), ":geospatial_bounds", "it is \"" + bounds.substr(0, 80) + "\"");
}

/// The first and last instants: of the bounds of time where it has some.
void check_time_coverage(const NetcdfFile& f, Findings& found) {
  const auto* time = f.with_standard_name("time");
  if (!time || NetcdfFile::text(*time, "units").find("seconds since 1970-01-01") != 0) return;
  const auto* bounds = f.find(NetcdfFile::text(*time, "bounds"));
  const auto extent = extent_of(bounds ? bounds : time);
  if (!extent) return;
  const auto start = seconds_of(f.global_text("time_coverage_start")),
             end = seconds_of(f.global_text("time_coverage_end"));
  if (start && std::abs(*start - extent->low) > 1)
    found.add(rule("acdd.time-coverage"), ":time_coverage_start",
              fmt::format("it is {:.0f} s away from the first instant", *start - extent->low));
  if (end && std::abs(*end - extent->high) > 1)
    found.add(rule("acdd.time-coverage"), ":time_coverage_end",
              fmt::format("it is {:.0f} s away from the last instant", *end - extent->high));
}

}  // namespace

void check_acdd(const NetcdfFile& f, Findings& found) {
  check_globals(f, found);
  check_variables(f, found);
  check_dates(f, found);
  check_extents(f, found);
  check_time_coverage(f, found);
}

}  // namespace quadsonde::product
