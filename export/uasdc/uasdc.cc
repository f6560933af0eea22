#include "export/uasdc/uasdc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "export/cf_netcdf/global_attributes.h"
#include "export/cf_netcdf/nc_file.h"
#include "export/geoid/geoid.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

using Type = NcFile::Type;

constexpr std::size_t chunk = 1024;

/// A column of the campaign's table, with the standard name it has in CF and the level of processing of ARM: b1
/// measured and checked, c1 derived.
struct Column {
  const char *name, *standard_name, *long_name, *units, *level;
  bool required;  // is there also without values
  std::optional<double> (*value)(const Observation&);
};
constexpr Column columns[] = {
    // The campaign's converter reads exactly this text: no zone, a T between date and time.
    {"time", "time", "Time", "seconds since 1970-01-01T00:00:00", "b1", true,
     [](const Observation& o) -> std::optional<double> { return static_cast<double>(o.utc.ns) * 1e-9; }},
    {"lat", "latitude", "Latitude", "degrees_north", "b1", true,
     [](const Observation& o) -> std::optional<double> { return o.place.lat_deg; }},
    {"lon", "longitude", "Longitude", "degrees_east", "b1", true,
     [](const Observation& o) -> std::optional<double> { return std::remainder(o.place.lon_deg, 360); }},
    {"altitude", "altitude", "Altitude", "m", "b1", true,
     [](const Observation& o) -> std::optional<double> { return o.altitude.m; }},
    {"air_temperature", "air_temperature", "Air Temperature", "K", "b1", true,
     [](const Observation& o) { return o.air.temperature_k; }},
    {"humidity_mixing_ratio", "humidity_mixing_ratio", "Humidity Mixing Ratio", "kg kg-1", "c1", true,
     [](const Observation& o) { return o.air.mixing_ratio; }},
    {"air_pressure", "air_pressure", "Atmospheric Pressure", "Pa", "b1", true,
     [](const Observation& o) { return o.air.pressure_pa; }},
    {"wind_speed", "wind_speed", "Wind Speed", "m s-1", "c1", true,
     [](const Observation& o) { return coded_wind(o.wind).speed_m_s; }},
    {"wind_direction", "wind_from_direction", "Wind Direction", "degree", "c1", true,
     [](const Observation& o) { return coded_wind(o.wind).from_deg; }},
    {"dew_point_temperature", "dew_point_temperature", "Dew Point Temperature", "K", "c1", false,
     [](const Observation& o) { return o.air.dew_point_k; }},
    {"relative_humidity", "relative_humidity", "Relative Humidity", "%", "b1", false,
     [](const Observation& o) { return o.air.relative_humidity_pct; }},
};

class UasdcFile {
 public:
  UasdcFile(const Observations& observations, const ProductSource& source, const NetcdfMetadata& metadata)
      : all_(observations.all), observations_(observations), source_(source), metadata_(metadata) {}

  ingest::Result<std::string> bytes() {
    const auto obs = file_.unlimited("obs");
    std::vector<std::pair<NcFile::Variable, std::vector<double>>> made;
    for (const auto& column : columns) {
      std::vector<double> values;
      bool any = column.required;
      for (const auto& o : all_) {
        const auto value = column.value(o);
        any = any || value;
        values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
      }
      if (any) made.emplace_back(define(column, obs), std::move(values));
    }
    write_globals();
    file_.end_definitions();
    for (const auto& [variable, values] : made) file_.put(variable, {all_.size()}, values);
    return file_.finish();
  }

 private:
  NcFile::Variable define(const Column& column, NcFile::Dimension obs) {
    const auto v = file_.variable(column.name, Type::float64, {obs}, {std::min(chunk, all_.size())});
    file_.nan_is_missing(v, Type::float64);  // of every variable, the campaign's way
    file_.attribute(v, "standard_name", column.standard_name);
    file_.attribute(v, "long_name", column.long_name);
    file_.attribute(v, "units", column.units);
    const std::string_view name = column.name;
    if (name == "time") file_.attribute(v, "calendar", "standard");
    if (name == "altitude") {
      file_.attribute(v, "positive", "up");
      file_.attribute(v, "comment", "above the geoid " + Geoid::name());
    }
    if (name != "time" && name != "lat" && name != "lon" && name != "altitude")
      file_.attribute(v, "coordinates", "time lat lon altitude");
    file_.attribute(v, "processing_level", column.level);
    file_.attribute(v, "comment", comment_of(name));
    return v;
  }

  std::string comment_of(std::string_view name) const {
    const auto measured = [](const std::string& from, const char* nobody) {
      return from.empty() ? std::string(nobody) : "by " + from;
    };
    if (name == "air_temperature" || name == "relative_humidity")
      return measured(observations_.air_from, "not measured on this flight");
    if (name == "air_pressure") return measured(observations_.pressure_from, "not measured on this flight");
    if (name == "humidity_mixing_ratio" || name == "dew_point_temperature")
      return "of temperature, humidity and pressure over liquid water by WMO-No. 8 (2018), annexes 4.A and 4.B; "
             "without a value where one of them was not measured";
    if (name == "wind_direction")
      return "clockwise from true north; north is 360, calm (below 0.05 m/s) is 0; without a value below twice the "
             "uncertainty of the speed";
    return "";
  }

  void write_globals() {
    const auto put = [&](const char* name, std::string_view value) { file_.attribute(NcFile::global, name, value); };
    const auto& s = metadata_.station;
    put("Conventions", "CF-1.8, WMO-CF-1.0");
    put("wmo__cf_profile", "FM 303-2024");
    put("featureType", "trajectory");
    put("title", "Wind of a multirotor for the WMO UAS demonstration campaign");
    put("platform_name", s.airframe_id);
    put("flight_id", flight_id(metadata_, source_));
    if (metadata_.takeoff_msl) put("site_terrain_elevation_height", fmt::format("{:.0f}m", metadata_.takeoff_msl->m));
    put("processing_level", "c1");
    put("institution", s.institution);
    put("license", s.license);
    put("creator_name", s.contact_name);
    put("creator_email", s.contact_email);
    put("references", s.references);
    put("source", fmt::format("{} flight log, wind from tilt and ground velocity by quadsonde {}",
                              platform_text(metadata_), version()));
    put("history",
        fmt::format("{} quadsonde {}", ingest::to_iso8601(made_at(metadata_, all_.back().utc), 0), version()));
    put("comment", fmt::format("{}; left out: {} of quality bad, {} without time, place or height",
                               source_.made_heights.empty() ? "altitude is the height above the sea that the log gives"
                                                            : "altitude is " + source_.made_heights,
                               observations_.bad_left_out, observations_.unplaced));
    write_provenance(file_, source_, metadata_);
  }

  const std::vector<Observation>& all_;
  const Observations& observations_;
  const ProductSource& source_;
  const NetcdfMetadata& metadata_;
  NcFile file_;
};

}  // namespace

ingest::Result<std::string> uasdc_netcdf(const Observations& observations, const ProductSource& source,
                                         const NetcdfMetadata& metadata) {
  if (observations.all.empty())
    return ingest::fail(ingest::Kind::no_answer, "no UASDC netCDF: there is no observation", {},
                        "see the reasons in the CSV");
  return UasdcFile(observations, source, metadata).bytes();
}

ingest::Result<std::string> uasdc_file_name(const Station& station, ingest::UtcTime first) {
  const bool no_operator = station.operator_id.empty();
  if (no_operator || station.airframe_id.empty())
    return ingest::fail(ingest::Kind::usage,
                        fmt::format("a UASDC file is named after operator and airframe, and no {} is known",
                                    no_operator ? "operator_id" : "airframe_id"),
                        {station.file, {}, {}, {}},
                        "write [uasdc] operator_id = \"007\" and airframe_id = \"QS001\" into station.toml beside the "
                        "log (the campaign gives the first), or name the file with -o X.nc");
  std::string digits;
  for (const char c : ingest::to_iso8601({first.ns - first.ns % 1'000'000'000}, 0))
    if (c >= '0' && c <= '9') digits += c;
  return fmt::format("UASDC_{}_{}_{}Z.nc", station.operator_id, station.airframe_id, digits);
}

}  // namespace quadsonde::product
