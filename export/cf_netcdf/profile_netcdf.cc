#include <fmt/format.h>

#include <array>

#include "export/cf_netcdf/cf_netcdf.h"
#include "export/cf_netcdf/global_attributes.h"
#include "export/cf_netcdf/profile_records.h"
#include "export/cf_netcdf/wind_variables.h"
#include "export/geoid/geoid.h"

namespace quadsonde::product {
namespace {

using profiles::Bin;
using Type = NcFile::Type;

constexpr const char* time_units = "seconds since 1970-01-01T00:00:00Z";
constexpr std::size_t time_chunk = 64;
constexpr const char* parts = " n_obs effective_n_obs wind_sd_sampling wind_sd_calibration wind_sd_trim";

double seconds_of(ingest::UtcTime t) { return static_cast<double>(t.ns) * 1e-9; }

/// What a bin knows beside its wind.
struct BinVariable {
  VariableText text;
  Type type;
  std::optional<double> (*value)(const Bin&);
};
const std::vector<BinVariable>& bin_variables() {
  const std::string mean = "altitude: time: mean", spread = "altitude: time: standard_deviation";
  const char *quality = "qualityInformation", *auxiliary = "auxiliaryInformation", *measured = "physicalMeasurement";
  static const std::vector<BinVariable> variables{
      {{"effective_n_obs", "", "number of independent samples that the bin is worth", "1", "", "", auxiliary},
       Type::float32,
       [](const Bin& b) { return b.effective_samples; }},
      {{"wind_sd_sampling", "",
        "what turbulence adds to the uncertainty (k=1, per component) where the bin stands for the mean state", "m s-1",
        "", "", quality},
       Type::float32,
       [](const Bin& b) { return b.sd_sampling; }},
      {{"wind_sd_calibration", "",
        "part of drag, latency, climb law and heading in the uncertainty (k=1, per component)", "m s-1", "", "",
        quality},
       Type::float32,
       [](const Bin& b) { return b.sd_calibration; }},
      {{"wind_sd_trim", "", "part of the tilt trim in the uncertainty (k=1, per component)", "m s-1", "", "", quality},
       Type::float32,
       [](const Bin& b) { return b.sd_trim; }},
      {{"eastward_wind_sigma", "eastward_wind", "turbulence of the eastward wind in the bin", "m s-1", spread, "",
        measured},
       Type::float32,
       [](const Bin& b) { return b.sigma ? std::optional(b.sigma->y()) : std::nullopt; }},
      {{"northward_wind_sigma", "northward_wind", "turbulence of the northward wind in the bin", "m s-1", spread, "",
        measured},
       Type::float32,
       [](const Bin& b) { return b.sigma ? std::optional(b.sigma->x()) : std::nullopt; }},
      {{"wind_from_direction_spread", "wind_from_direction", "spread of the direction of the samples", "degree",
        spread + " (Yamartino)", "", measured},
       Type::float32,
       [](const Bin& b) { return b.spread_from_deg; }},
      {{"sample_altitude", "", "mean altitude of the samples of the bin above the geoid", "m", mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.height_msl && b.samples ? std::optional(b.height_msl->m) : std::nullopt; }},
      {{"sample_lat", "", "mean latitude of the samples of the bin", "degrees_north", mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.place ? std::optional(b.place->lat_deg) : std::nullopt; }},
      {{"sample_lon", "", "mean longitude of the samples of the bin", "degrees_east", mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.place ? std::optional(b.place->lon_deg) : std::nullopt; }},
      {{"sample_time", "", "mean time of the samples of the bin", time_units, mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.utc ? std::optional(seconds_of(*b.utc)) : std::nullopt; }},
  };
  return variables;
}

/// Defines and writes one file.
class ProfileFile {
 public:
  ProfileFile(const ProfileRecords& records, const profiles::WindProfile& profile, const ProductSource& source,
              const NetcdfMetadata& metadata)
      : r_(records), profile_(profile), source_(source), metadata_(metadata) {}

  ingest::Result<std::string> bytes() {
    name_ids();
    define_axes();
    define_site();
    WindVariables wind(file_, grid_);
    define_bins();
    write_global_attributes(file_, text(), source_, metadata_);
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
      profile_ids_.push_back(fmt::format("{}-{}", flight, profiles::name(record.leg->name)));
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
             "lat lon height station_id profile_id",
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
    v_.height = file_.variable("height", Type::float64, grid_.dimensions, grid_.chunks);
    file_.nan_is_missing(v_.height, Type::float64);
    put_texts(v_.height, {{"standard_name", "height"},
                          {"long_name", "height of the bin centre above ground at the take-off point"},
                          {"units", "m"},
                          {"positive", "up"},
                          {"coverage_content_type", "coordinate"}});
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
      extra_.push_back(define(file_, grid_, v.type, v.text));
      if (v.text.name == "sample_time") file_.attribute(extra_.back(), "calendar", "standard");
    }
    constexpr std::array<signed char, 3> legs{0, 1, 2};
    v_.leg = file_.variable("leg", Type::byte, {time_}, {time_chunk});
    file_.attribute(v_.leg, "long_name", "leg of the flight that the record holds");
    file_.attribute(v_.leg, "flag_values", legs);
    put_texts(v_.leg, {{"flag_meanings", "up down all"},
                       {"coordinates", "lat lon station_id profile_id"},
                       {"coverage_content_type", "auxiliaryInformation"}});
  }

  ProductText text() const {
    ProductText t;
    t.feature_type = "timeSeriesProfile", t.cdm_data_type = "TimeSeriesProfile";
    t.title = "Vertical wind profile of a multirotor";
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
    std::vector<double> heights;
    for (std::size_t i = 0; i < r_.records.size(); ++i)
      for (const double z : r_.altitude)
        heights.push_back(or_nan_double(r_.takeoff_msl ? std::optional(z - r_.takeoff_msl->m) : std::nullopt));
    file_.put(v_.height, {r_.records.size(), r_.altitude.size()}, heights);
  }

  void put_bins(WindVariables& wind) {
    const std::vector<std::size_t> shape{r_.records.size(), r_.altitude.size()};
    WindNumbers numbers;
    std::vector<std::int32_t> counts;
    std::vector<std::vector<double>> extra(extra_.size());
    for (const auto& record : r_.records) {
      for (const auto& bin : record.leg->bins) {
        numbers.add(bin.wind, bin.quality, bin.reasons);
        const bool has_wind = std::holds_alternative<estimator::WindEstimate>(bin.wind);
        counts.push_back(has_wind ? static_cast<std::int32_t>(bin.samples) : 0);
        for (std::size_t i = 0; i < extra.size(); ++i) extra[i].push_back(or_nan_double(bin_variables()[i].value(bin)));
      }
    }
    wind.put(numbers, shape);
    file_.put(v_.n_obs, shape, counts);
    for (std::size_t i = 0; i < extra.size(); ++i) file_.put(extra_[i], shape, extra[i]);
  }

  void put_texts(NcFile::Variable variable, std::initializer_list<std::pair<const char*, std::string>> texts) {
    for (const auto& [name, value] : texts) file_.attribute(variable, name, std::string_view(value));
  }

  const ProfileRecords& r_;
  const profiles::WindProfile& profile_;
  const ProductSource& source_;
  const NetcdfMetadata& metadata_;
  const Geoid geoid_ = Geoid::open();
  const std::optional<double> undulation_ = geoid_.undulation(r_.place);
  std::vector<std::string> profile_ids_;
  std::string station_;
  std::size_t id_length_ = 32;
  NcFile file_;
  NcFile::Dimension time_ = -1, altitude_ = -1, nv_ = -1, letters_ = -1;
  VariableLayout grid_;
  struct {
    NcFile::Variable station_id, profile_id, time, time_bnds, altitude, altitude_bnds, lat, lon, height, surface, geoid,
        n_obs, leg;
  } v_{};
  std::vector<NcFile::Variable> extra_;
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
  return ProfileFile(*records, profile, source, metadata).bytes();
}

}  // namespace quadsonde::product
