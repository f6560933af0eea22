#include "export/cf_netcdf/global_attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/geoid/geoid.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

constexpr std::size_t most_problems = 20;

std::string one_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string maker() { return fmt::format("quadsonde {}", version()); }

void write_conventions(NcFile& file, const ProductText& text, const NetcdfMetadata& m, const std::string& id) {
  const auto put = [&](const char* name, std::string_view value) { file.attribute(NcFile::global, name, value); };
  put("Conventions", "CF-1.8, ACDD-1.3");
  put("featureType", text.feature_type);
  put("title", m.title.empty() ? text.title : m.title);
  put("summary", text.summary);
  put("keywords", "EARTH SCIENCE > ATMOSPHERE > ATMOSPHERIC WINDS > UPPER LEVEL WINDS");
  put("keywords_vocabulary", "GCMD Science Keywords");
  put("standard_name_vocabulary", "CF Standard Name Table v83");
  put("cdm_data_type", text.cdm_data_type);
  put("id", id);
  const auto& s = m.station;
  put("naming_authority", s.naming_authority);
  put("institution", s.institution);
  put("project", s.project);
  put("creator_name", s.contact_name);
  put("creator_email", s.contact_email);
  put("creator_url", s.contact_url);
  put("publisher_name", s.publisher_name);
  put("publisher_email", s.publisher_email);
  put("publisher_url", s.publisher_url);
  put("license", s.license);
  put("references", s.references);
  put("acknowledgement", s.acknowledgement);
  put("platform", platform_text(m));
  put("instrument", m.autopilot.empty() ? "attitude and velocity of the autopilot"
                                        : "attitude and velocity of the autopilot " + m.autopilot);
  put("source", "multirotor flight log, wind from tilt and ground velocity by " + maker());
  put("processing_level", text.processing_level);
  put("product_version", version());
  put("comment", text.comment);
}

void write_dates(NcFile& file, const ProductText& text, const NetcdfMetadata& m) {
  const auto put = [&](const char* name, std::string_view value) { file.attribute(NcFile::global, name, value); };
  const auto made = ingest::to_iso8601(made_at(m, text.to), 0);
  put("history", made + " " + maker());
  put("date_created", made);
  put("date_modified", made);
  put("date_metadata_modified", made);
  put("time_coverage_start", utc_text(text.from));
  put("time_coverage_end", utc_text(text.to));
  put("time_coverage_duration", iso_duration(ingest::to_seconds(text.to - text.from)));
  if (text.time_step_s) put("time_coverage_resolution", iso_duration(*text.time_step_s));
}

/// ACDD writes bounds as WKT; longitude first, as in the skeletons of the formats notes.
std::string bounds_text(const ProductText& text) {
  const double south = *text.lat.low, north = *text.lat.high, west = *text.lon.low, east = *text.lon.high;
  if (south == north && west == east)
    return fmt::format("POINT Z ({:.7f} {:.7f} {:.2f})", west, south, *text.altitude.low);
  return fmt::format("POLYGON (({0:.7f} {1:.7f}, {2:.7f} {1:.7f}, {2:.7f} {3:.7f}, {0:.7f} {3:.7f}, {0:.7f} {1:.7f}))",
                     west, south, east, north);
}

void write_extent(NcFile& file, const ProductText& text) {
  const auto put = [&](const char* name, auto value) { file.attribute(NcFile::global, name, value); };
  put("geospatial_bounds", std::string_view(bounds_text(text)));
  put("geospatial_bounds_crs", std::string_view("EPSG:4326"));
  put("geospatial_bounds_vertical_crs", std::string_view("EPSG:5773"));  // height above EGM96
  put("geospatial_lat_min", *text.lat.low);
  put("geospatial_lat_max", *text.lat.high);
  put("geospatial_lat_units", std::string_view("degrees_north"));
  put("geospatial_lon_min", *text.lon.low);
  put("geospatial_lon_max", *text.lon.high);
  put("geospatial_lon_units", std::string_view("degrees_east"));
  put("geospatial_vertical_min", *text.altitude.low);
  put("geospatial_vertical_max", *text.altitude.high);
  put("geospatial_vertical_units", std::string_view("m"));
  put("geospatial_vertical_positive", std::string_view("up"));
  put("geospatial_vertical_resolution", std::string_view(text.vertical_resolution));
}

}  // namespace

void Extent::add(double value) {
  low = low ? std::min(*low, value) : value;
  high = high ? std::max(*high, value) : value;
}

ingest::UtcTime made_at(const NetcdfMetadata& metadata, ingest::UtcTime last_sample) {
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    std::int64_t seconds = 0;
    const char* end = epoch + std::strlen(epoch);
    const auto read = std::from_chars(epoch, end, seconds);
    // Beyond the year 2255 it would not fit into a UtcTime.
    if (read.ec == std::errc() && read.ptr == end && seconds >= 0 && seconds < 9'000'000'000)
      return {seconds * 1'000'000'000};
  }
  return metadata.log_end.value_or(last_sample);
}

std::string flight_id(const NetcdfMetadata& metadata, const ProductSource& source) {
  auto file = std::filesystem::path(source.file).filename();
  if (file.extension() == ".gz" || file.extension() == ".zst") file = file.stem();
  return identifier(metadata.flight_id.empty() ? fmt::format("{}-{}", file.stem().string(), source.flight)
                                               : metadata.flight_id);
}

std::string identifier(std::string text) {
  constexpr std::string_view allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  for (auto& c : text)
    if (allowed.find(c) == std::string_view::npos) c = '_';
  return text;
}

std::string heights_text(const ProductSource& source, const std::string& geoid) {
  if (source.made_heights.empty())
    return "altitude is the height above the sea that the log gives, taken as above the geoid named in "
           "crs:geoid_name; geoid_height by " +
           geoid;
  return "the log has no height above the sea: altitude is " + source.made_heights + "; geoid_height by " + geoid;
}

std::string platform_text(const NetcdfMetadata& metadata) {
  const auto& s = metadata.station;
  const auto& name = s.platform_name.empty() ? metadata.vehicle : s.platform_name;
  return (s.platform_type.empty() ? "multirotor" : s.platform_type) + (name.empty() ? "" : " " + name);
}

std::string iso_duration(double seconds) {
  auto text = fmt::format("{:.3f}", std::max(0.0, seconds));
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return "PT" + text + "S";
}

std::string padded(std::string text, std::size_t length) {
  text.resize(length, '\0');
  return text;
}

void write_provenance(NcFile& file, const ProductSource& source, const NetcdfMetadata& metadata) {
  const auto put = [&](const char* name, std::string_view value) { file.attribute(NcFile::global, name, value); };
  put("quadsonde_station_file", metadata.station.file);
  put("quadsonde_wigos_id", metadata.station.wigos_id);
  put("quadsonde_site_name", metadata.station.name);
  put("quadsonde_operator_id", metadata.station.operator_id);
  put("quadsonde_airframe_id", metadata.station.airframe_id);
  put("quadsonde_heights", source.made_heights);
  put("quadsonde_version", version());
  put("quadsonde_input_file", source.file);
  put("quadsonde_input_sha256", source.sha256);
  file.attribute(NcFile::global, "quadsonde_input_flight", std::span<const std::int32_t>(&source.flight, 1));
  put("quadsonde_settings", one_line(json_settings(source.settings)));
  put("quadsonde_vehicle", one_line(json_vehicle_of(source)));
  auto problems = source.problems;
  // An attribute is no place for thousands; the JSON products have them all.
  if (problems.size() > most_problems) problems.resize(most_problems);
  put("quadsonde_problems", one_line(json_problems(problems)));
  const auto count = static_cast<std::int32_t>(source.problems.size());
  file.attribute(NcFile::global, "quadsonde_problem_count", std::span<const std::int32_t>(&count, 1));
}

void write_common_attributes(NcFile& file, const ProductText& text, const NetcdfMetadata& metadata,
                             const std::string& id) {
  write_conventions(file, text, metadata, id);
  write_dates(file, text, metadata);
  write_extent(file, text);
}

void write_global_attributes(NcFile& file, const ProductText& text, const ProductSource& source,
                             const NetcdfMetadata& metadata) {
  write_common_attributes(file, text, metadata, flight_id(metadata, source));
  write_provenance(file, source, metadata);
}

}  // namespace quadsonde::product
