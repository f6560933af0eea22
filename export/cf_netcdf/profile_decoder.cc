#include "export/cf_netcdf/profile_decoder.h"

#include <netcdf.h>
#include <netcdf_mem.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace quadsonde::product {
namespace {

using nlohmann::json;

// Far above any profile: a flight has some legs and some hundred bins.
constexpr std::size_t most_values = 1'000'000, most_text = 65536;

class Decoder {
 public:
  explicit Decoder(ingest::Bytes bytes) {
    // The library only reads what it is told not to write.
    opened_ = nc_open_mem("profile.nc", NC_NOWRITE, bytes.size(), const_cast<std::uint8_t*>(bytes.data()), &id_);
  }

  json decode() {
    if (opened_ != NC_NOERR) return not_ours("it cannot be opened as netCDF");
    if (!attribute("quadsonde_version")) return not_ours("it has no attribute quadsonde_version");
    if (attribute("featureType") != "timeSeriesProfile") return not_ours("its featureType is not timeSeriesProfile");
    if (attribute("quadsonde_merged")) return not_ours("it is made of several");
    json said = json::object();
    for (const auto* name :
         {"quadsonde_version", "quadsonde_input_file", "quadsonde_input_sha256", "quadsonde_settings",
          "quadsonde_vehicle", "id", "platform", "license", "institution", "date_created"})
      if (const auto text = attribute(name)) said[name] = *text;
    int flight = 0;
    if (nc_get_att_int(id_, NC_GLOBAL, "quadsonde_input_flight", &flight) == NC_NOERR)
      said["quadsonde_input_flight"] = flight;
    for (const auto* name : {"lat", "lon", "surface_altitude"})
      if (const auto values = numbers(name); values.size() == 1) said[name] = values[0];
    for (const auto* name : {"time", "time_bnds", "altitude", "altitude_bnds", "leg", "eastward_wind", "northward_wind",
                             "wind_speed", "wind_from_direction", "eastward_wind_se", "northward_wind_se",
                             "wind_error_covariance", "wind_qc", "n_obs", "wind_qc_reasons"})
      said[name] = numbers(name);
    // Not every version has these, nor every flight.
    for (const auto& [name, member] : optional_bin_variables())
      if (auto values = numbers(name); !values.empty()) said[name] = std::move(values);
    if (const auto ids = texts("station_id"); ids.size() == 1) said["station_id"] = ids[0];
    said["profile_id"] = texts("profile_id");
    if (int v = -1; nc_inq_varid(id_, "wind_qc_reasons", &v) == NC_NOERR)
      said["reason_names"] = attribute("flag_meanings", v).value_or("");
    return said;
  }

 private:
  static json not_ours(const char* why) { return {{"not_ours", why}}; }

  std::optional<std::string> attribute(const char* name, int of = NC_GLOBAL) {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    if (nc_inq_att(id_, of, name, &type, &length) != NC_NOERR || type != NC_CHAR || length > most_text)
      return std::nullopt;
    std::string text(length, '\0');
    if (nc_get_att_text(id_, of, name, text.data()) != NC_NOERR) return std::nullopt;
    return text;
  }

  /// Variable, lengths of its dimensions and how many values those make; empty if it is not there or too large.
  std::optional<std::pair<int, std::vector<std::size_t>>> variable(const char* name, std::size_t& values) {
    int v = -1, dimensions = 0, ids[NC_MAX_VAR_DIMS];
    if (nc_inq_varid(id_, name, &v) != NC_NOERR) return std::nullopt;
    if (nc_inq_varndims(id_, v, &dimensions) != NC_NOERR || dimensions > 3) return std::nullopt;
    if (nc_inq_vardimid(id_, v, ids) != NC_NOERR) return std::nullopt;
    std::vector<std::size_t> lengths;
    values = 1;
    for (int i = 0; i < dimensions; ++i) {
      std::size_t length = 0;
      if (nc_inq_dimlen(id_, ids[i], &length) != NC_NOERR || length == 0 || length > most_values / values)
        return std::nullopt;
      values *= length;
      lengths.push_back(length);
    }
    return std::pair{v, lengths};
  }

  std::vector<double> numbers(const char* name) {
    std::size_t count = 0;
    const auto found = variable(name, count);
    nc_type type = NC_NAT;
    if (!found || nc_inq_vartype(id_, found->first, &type) != NC_NOERR || type == NC_CHAR || type > NC_UINT64)
      return {};
    std::vector<double> values(count);
    const int got = nc_get_var_double(id_, found->first, values.data());
    return got == NC_NOERR ? values : std::vector<double>{};
  }

  std::vector<std::string> texts(const char* name) {
    std::size_t count = 0;
    const auto found = variable(name, count);
    nc_type type = NC_NAT;
    if (!found || found->second.empty() || nc_inq_vartype(id_, found->first, &type) != NC_NOERR || type != NC_CHAR)
      return {};
    std::string all(count, '\0');
    if (nc_get_var_text(id_, found->first, all.data()) != NC_NOERR) return {};
    std::vector<std::string> list;
    for (std::size_t at = 0; at < count; at += found->second.back())
      list.push_back(all.substr(at, found->second.back()).c_str());
    return list;
  }

  int id_ = -1, opened_ = NC_NOERR;
};

}  // namespace

const std::vector<std::pair<const char*, std::optional<double> StoredBin::*>>& optional_bin_variables() {
  static const std::vector<std::pair<const char*, std::optional<double> StoredBin::*>> variables{
      {"wind_sd_noise", &StoredBin::noise},
      {"wind_sd_calibration", &StoredBin::calibration},
      {"wind_sd_trim", &StoredBin::trim},
      {"wind_sd_climb_law", &StoredBin::climb_law},
      {"wind_sd_sampling", &StoredBin::sampling},
      {"effective_n_obs", &StoredBin::effective_samples},
      {"eastward_wind_sigma", &StoredBin::sigma_east},
      {"northward_wind_sigma", &StoredBin::sigma_north},
      {"wind_from_direction_spread", &StoredBin::spread_from_deg},
      {"vertical_resolution", &StoredBin::resolution_m},
      {"degrees_of_freedom", &StoredBin::freedom},
      {"air_pressure", &StoredBin::pressure_pa},
      {"air_temperature", &StoredBin::temperature_k},
      {"relative_humidity", &StoredBin::relative_humidity_pct},
      {"barometric_altitude", &StoredBin::barometric_altitude_m}};
  return variables;
}

std::string decode_profile(ingest::Bytes bytes) {
  // nlohmann writes NaN and infinity as null.
  return Decoder(bytes).decode().dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace quadsonde::product
