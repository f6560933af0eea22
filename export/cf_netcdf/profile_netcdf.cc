#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "export/cf_netcdf/bin_variables.h"
#include "export/cf_netcdf/cf_netcdf.h"
#include "export/cf_netcdf/global_attributes.h"
#include "export/cf_netcdf/profile_records.h"
#include "export/cf_netcdf/wind_variables.h"
#include "export/csv/json.h"
#include "export/geoid/geoid.h"

namespace quadsonde::product {
namespace {

using profiles::Bin;
using Type = NcFile::Type;

constexpr std::size_t time_chunk = 64;
constexpr const char* parts =
    " n_obs effective_n_obs wind_sd_sampling wind_sd_calibration wind_sd_trim wind_sd_noise wind_sd_climb_law";

double seconds_of(ingest::UtcTime t) { return static_cast<double>(t.ns) * 1e-9; }

/// Defines and writes one file.
class ProfileFile {
 public:
  /// @param findings  whether the profile's legs, levels and tests are told; else the file is a section of several legs
  ProfileFile(const ProfileRecords& records, const profiles::WindProfile& profile, bool findings,
              const ProductSource& source, const NetcdfMetadata& metadata)
      : r_(records), profile_(profile), findings_(findings), source_(source), metadata_(metadata) {}

  ingest::Result<std::string> bytes() {
    name_ids();
    define_axes();
    define_site();
    WindVariables wind(file_, grid_);
    define_bins();
    write_global_attributes(file_, text(), source_, metadata_);
    write_findings();
    file_.end_definitions();
    put_axes();
    put_site();
    put_bins(wind);
    return file_.finish();
  }

 private:
  void name_ids() {
    const auto flight = flight_id(metadata_, source_);
    for (const auto& record : r_.records)
      profile_ids_.push_back(findings_ ? fmt::format("{}-{}", flight, record.name) : identifier(record.name));
    // Without an identifier the site is named by what is known of it.
    const auto& site = metadata_.station.site();
    station_ = site.empty() ? fmt::format("{:.4f},{:.4f}", r_.place.lat_deg, r_.place.lon_deg) : site;
    for (const auto& id : profile_ids_) id_length_ = std::max(id_length_, id.size());
    id_length_ = std::max(id_length_, station_.size());
  }

  void define_axes() {
    time_ = file_.unlimited("time");
    altitude_ = file_.dimension("altitude", r_.altitude.size());
    nv_ = file_.dimension("nv", 2);
    letters_ = file_.dimension("id_strlen", id_length_);
    grid_ = {{time_, altitude_},
             {1, r_.altitude.size()},
             // CF section 9.6: where a coordinate is missing the data would have to be missing, too.
             r_.takeoff_msl ? "lat lon height station_id profile_id" : "lat lon station_id profile_id",
             "altitude: time: mean",
             true,
             parts};
    v_.station_id = file_.variable("station_id", Type::character, {letters_});
    file_.attribute(v_.station_id, "cf_role", "timeseries_id");
    file_.attribute(v_.station_id, "long_name",
                    !metadata_.station.wigos_id.empty() ? "WIGOS station identifier of the launch site"
                    : metadata_.station.site().empty()
                        ? "launch site by latitude and longitude, as it has no other identifier"
                        : "identifier of the launch site");
    v_.profile_id = file_.variable("profile_id", Type::character, {time_, letters_}, {time_chunk, id_length_});
    file_.attribute(v_.profile_id, "cf_role", "profile_id");
    file_.attribute(v_.profile_id, "long_name", "unique identifier of the profile");
    v_.time = file_.variable("time", Type::float64, {time_}, {time_chunk});
    put_texts(v_.time, {{"standard_name", "time"},
                        {"long_name", "mid time of the profile"},
                        {"units", time_units},
                        {"calendar", "standard"},
                        {"axis", "T"},
                        {"bounds", "time_bnds"},
                        {"coverage_content_type", "coordinate"}});
    v_.time_bnds = file_.variable("time_bnds", Type::float64, {time_, nv_}, {time_chunk, 2});
    v_.altitude = file_.variable("altitude", Type::float64, {altitude_});
    put_texts(v_.altitude, {{"standard_name", "altitude"},
                            {"long_name", "altitude of the bin centre above the geoid"},
                            {"units", "m"},
                            {"positive", "up"},
                            {"axis", "Z"},
                            {"bounds", "altitude_bnds"},
                            {"coverage_content_type", "coordinate"}});
    v_.altitude_bnds = file_.variable("altitude_bnds", Type::float64, {altitude_, nv_});
  }

  void define_site() {
    const std::string of_what = r_.place_is_takeoff ? " of the launch site" : ", mean of the profile";
    v_.lat = file_.variable("lat", Type::float64, {});
    put_texts(v_.lat, {{"standard_name", "latitude"},
                       {"long_name", "latitude" + of_what},
                       {"units", "degrees_north"},
                       {"axis", "Y"},
                       {"coverage_content_type", "coordinate"}});
    v_.lon = file_.variable("lon", Type::float64, {});
    put_texts(v_.lon, {{"standard_name", "longitude"},
                       {"long_name", "longitude" + of_what},
                       {"units", "degrees_east"},
                       {"axis", "X"},
                       {"coverage_content_type", "coordinate"}});
    if (r_.takeoff_msl) define_height();
    const VariableLayout scalar{{}, {}, "lat lon", "", false, ""};
    if (r_.takeoff_msl)
      v_.surface = define(file_, scalar, Type::float64,
                          {"surface_altitude", "surface_altitude", "altitude of the take-off point above the geoid",
                           "m", "", "", "auxiliaryInformation"});
    if (undulation_) {
      v_.geoid =
          define(file_, scalar, Type::float64,
                 {"geoid_height", "geoid_height_above_reference_ellipsoid",
                  "height of the geoid above the ellipsoid: altitude plus this is the height above the ellipsoid", "m",
                  "", "", "auxiliaryInformation"});
      file_.attribute(v_.geoid, "comment", geoid_.provenance());
    }
    define_crs(file_);
  }

  void define_bins() {
    v_.n_obs = define(file_, grid_, Type::int32,
                      {"n_obs", "number_of_observations", "number of samples with an estimate in the bin", "1", "", "",
                       "auxiliaryInformation"});
    for (const auto& v : bin_variables()) {
      if (!v.always && !any_value(v)) continue;
      extra_.push_back({&v, define(file_, grid_, v.type, v.text)});
      if (v.text.name == "sample_time") file_.attribute(extra_.back().id, "calendar", "standard");
    }
    define_kernel();
    constexpr std::array<signed char, 3> legs{0, 1, 2};
    v_.leg = file_.variable("leg", Type::byte, {time_}, {time_chunk});
    file_.attribute(v_.leg, "long_name", "leg of the flight that the record holds");
    file_.attribute(v_.leg, "flag_values", legs);
    put_texts(v_.leg, {{"flag_meanings", "up down all"},
                       {"coordinates", "lat lon station_id profile_id"},
                       {"coverage_content_type", "auxiliaryInformation"}});
  }

  /// What belongs to no bin, as the JSON of the profile has it.
  void write_findings() {
    // A reader of one flight's profile must not take it for one.
    if (!findings_) return file_.attribute(NcFile::global, "quadsonde_merged", "section");
    const auto put = [&](const char* name, const Json& json) {
      if (!json.is_null() && !json.empty())
        file_.attribute(NcFile::global, name, json.dump(-1, ' ', false, Json::error_handler_t::replace));
    };
    file_.attribute(NcFile::global, "quadsonde_method", profiles::name(profile_.method));
    put("quadsonde_legs", json_found_legs(profile_));
    put("quadsonde_levels", json_levels(profile_));
    put("quadsonde_up_down", json_up_down(profile_));
    if (profile_.optimal)
      file_.attribute(NcFile::global, "quadsonde_degrees_of_freedom", profile_.optimal->degrees_of_freedom);
  }

  bool any_value(const BinVariable& v) const {
    return std::any_of(r_.records.begin(), r_.records.end(), [&](const ProfileRecord& record) {
      return std::any_of(record.leg->bins.begin(), record.leg->bins.end(),
                         [&](const Bin& bin) { return v.value(bin).has_value(); });
    });
  }

  /// The kernel of method optimal, where it is that of the file's altitudes.
  void define_kernel() {
    const auto& optimal = profile_.optimal;
    if (!optimal || static_cast<std::size_t>(optimal->kernel.rows()) != r_.altitude.size()) return;
    true_altitude_ = file_.dimension("true_altitude", r_.altitude.size());
    const VariableLayout layout{{altitude_, true_altitude_}, {}, "lat lon station_id", "", false, ""};
    v_.kernel = define(file_, layout, Type::float32,
                       {"averaging_kernel", "",
                        "averaging kernel, mean of both components: how the wind at each true_altitude (same values "
                        "as altitude) enters that at altitude",
                        "1", "", "", "qualityInformation"});
    has_kernel_ = true;
  }

  ProductText text() const {
    ProductText t;
    t.feature_type = "timeSeriesProfile", t.cdm_data_type = "TimeSeriesProfile";
    t.title = findings_ ? "Vertical wind profile of a multirotor" : "Time-height section of the wind by a multirotor";
    t.summary =
        "Horizontal wind estimated from the attitude and the motion of a multirotor, averaged in altitude bins.";
    t.processing_level = "binned profile";
    t.comment = fmt::format("{}; bins of {} m above {}", heights_text(source_, geoid_.provenance()), profile_.bin_m,
                            profile_.datum == profiles::Datum::agl ? "take-off" : "the sea");
    t.lat.add(r_.place.lat_deg), t.lon.add(r_.place.lon_deg);
    for (const double z : r_.altitude) t.altitude.add(z);
    const auto& records = r_.records;
    t.from = records.front().from, t.to = records.front().to;
    for (const auto& record : records) t.from = std::min(t.from, record.from), t.to = std::max(t.to, record.to);
    t.time_step_s = records.size() > 1
                        ? (records.back().mid_s() - records.front().mid_s()) / static_cast<double>(records.size() - 1)
                        : ingest::to_seconds(t.to - t.from);
    t.vertical_resolution = fmt::format("{} m", profile_.bin_m);
    return t;
  }

  void put_axes() {
    const auto n = r_.records.size(), levels = r_.altitude.size();
    std::string ids;
    std::vector<double> mids, times, edges;
    std::vector<signed char> legs;
    for (std::size_t i = 0; i < n; ++i) {
      ids += padded(profile_ids_[i], id_length_);
      mids.push_back(r_.records[i].mid_s());
      times.push_back(seconds_of(r_.records[i].from)), times.push_back(seconds_of(r_.records[i].to));
      legs.push_back(static_cast<signed char>(r_.records[i].leg->name));
    }
    for (std::size_t i = 0; i < levels; ++i) edges.push_back(r_.bottom[i]), edges.push_back(r_.top[i]);
    file_.put(v_.station_id, {id_length_}, padded(station_, id_length_));
    file_.put(v_.profile_id, {n, id_length_}, ids);
    file_.put(v_.time, {n}, mids);
    file_.put(v_.time_bnds, {n, 2}, times);
    file_.put(v_.altitude, {levels}, r_.altitude);
    file_.put(v_.altitude_bnds, {levels, 2}, edges);
    file_.put(v_.leg, {n}, legs);
  }

  void put_site() {
    const auto scalar = [&](NcFile::Variable variable, double value) {
      file_.put(variable, {}, std::span<const double>(&value, 1));
    };
    scalar(v_.lat, r_.place.lat_deg);
    scalar(v_.lon, r_.place.lon_deg);
    if (r_.takeoff_msl) scalar(v_.surface, r_.takeoff_msl->m);
    if (undulation_) scalar(v_.geoid, *undulation_);
    if (!r_.takeoff_msl) return;
    std::vector<double> heights;
    for (std::size_t i = 0; i < r_.records.size(); ++i)
      for (const double z : r_.altitude) heights.push_back(z - r_.takeoff_msl->m);
    file_.put(v_.height, {r_.records.size(), r_.altitude.size()}, heights);
  }

  void define_height() {
    v_.height = file_.variable("height", Type::float64, grid_.dimensions, grid_.chunks);
    file_.nan_is_missing(v_.height, Type::float64);
    put_texts(v_.height, {{"standard_name", "height"},
                          {"long_name", "height of the bin centre above ground at the take-off point"},
                          {"units", "m"},
                          {"positive", "up"},
                          {"coverage_content_type", "coordinate"}});
  }

  void put_bins(WindVariables& wind) {
    const std::vector<std::size_t> shape{r_.records.size(), r_.altitude.size()};
    WindNumbers numbers;
    std::vector<std::int32_t> counts;
    std::vector<std::vector<double>> extra(extra_.size());  // as extra_
    for (const auto& record : r_.records) {
      for (const auto& bin : record.leg->bins) {
        numbers.add(bin.wind, bin.quality, bin.reasons);
        const bool has_wind = std::holds_alternative<estimator::WindEstimate>(bin.wind);
        counts.push_back(has_wind ? static_cast<std::int32_t>(bin.samples) : 0);
        for (std::size_t i = 0; i < extra.size(); ++i)
          extra[i].push_back(or_nan_double(extra_[i].variable->value(bin)));
      }
    }
    wind.put(numbers, shape);
    file_.put(v_.n_obs, shape, counts);
    for (std::size_t i = 0; i < extra.size(); ++i) file_.put(extra_[i].id, shape, extra[i]);
    if (!has_kernel_) return;
    std::vector<double> kernel;
    for (Eigen::Index i = 0; i < profile_.optimal->kernel.rows(); ++i)
      for (Eigen::Index j = 0; j < profile_.optimal->kernel.cols(); ++j)
        kernel.push_back(profile_.optimal->kernel(i, j));
    file_.put(v_.kernel, {r_.altitude.size(), r_.altitude.size()}, kernel);
  }

  void put_texts(NcFile::Variable variable, std::initializer_list<std::pair<const char*, std::string>> texts) {
    for (const auto& [name, value] : texts) file_.attribute(variable, name, std::string_view(value));
  }

  const ProfileRecords& r_;
  const profiles::WindProfile& profile_;
  const bool findings_;
  const ProductSource& source_;
  const NetcdfMetadata& metadata_;
  const Geoid geoid_ = Geoid::open();
  const std::optional<double> undulation_ = geoid_.undulation(r_.place);
  std::vector<std::string> profile_ids_;
  std::string station_;
  std::size_t id_length_ = 32;
  NcFile file_;
  NcFile::Dimension time_ = -1, altitude_ = -1, nv_ = -1, letters_ = -1, true_altitude_ = -1;
  VariableLayout grid_;
  struct {
    NcFile::Variable station_id, profile_id, time, time_bnds, altitude, altitude_bnds, lat, lon, height, surface, geoid,
        n_obs, leg, kernel;
  } v_{};
  struct Extra {
    const BinVariable* variable;
    NcFile::Variable id;
  };
  std::vector<Extra> extra_;
  bool has_kernel_ = false;
};

}  // namespace

ingest::Result<std::string> profile_netcdf(const profiles::WindProfile& profile, const ProductSource& source,
                                           const NetcdfMetadata& metadata) {
  const auto records = profile_records(profile, metadata, "netCDF");
  if (!records) return ingest::fail(records.error());
  for (std::size_t i = 1; i < records->records.size(); ++i)
    if (!(records->records[i - 1].mid_s() < records->records[i].mid_s()))
      return ingest::fail(ingest::Kind::inconsistent,
                          "ascents and descents share their mid time, and a time axis must grow", {},
                          "ask for --leg up, down or all");
  return ProfileFile(*records, profile, true, source, metadata).bytes();
}

ingest::Result<std::string> section_netcdf(const profiles::Section& section, const ProductSource& source,
                                           const NetcdfMetadata& metadata) {
  const auto records = section_records(section, metadata);
  if (!records) return ingest::fail(records.error());
  profiles::WindProfile facts;
  facts.datum = section.datum;
  facts.bin_m = section.bin_m;
  return ProfileFile(*records, facts, false, source, metadata).bytes();
}

}  // namespace quadsonde::product
