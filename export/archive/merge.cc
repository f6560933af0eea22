#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "export/archive/regrid.h"
#include "export/archive/subset.h"
#include "export/cf_netcdf/global_attributes.h"
#include "export/cf_netcdf/nc_file.h"
#include "export/cf_netcdf/wind_variables.h"
#include "ingest/flight/local_frame.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Result;
using Type = NcFile::Type;

constexpr std::size_t most_profiles = 20000, most_cells = 20'000'000, time_chunk = 64;
constexpr const char* time_units = "seconds since 1970-01-01T00:00:00Z";
constexpr double one_site_m = 200;

ingest::UtcTime utc_of(double seconds) { return {std::llround(seconds * 1e3) * 1'000'000}; }

/// One leg of one profile.
struct MergedRecord {
  const ArchiveEntry* entry;
  StoredRecord record;  ///< its bins on the common grid
  std::string id;
};

struct Merged {
  MergeAxis axis = MergeAxis::altitude;
  double bin_m = 10;
  std::vector<double> edges;  ///< of the grid, one more than bins
  std::vector<MergedRecord> records;
  bool one_site = true;
  double lat_deg = 0, lon_deg = 0;  ///< of the one site
  std::size_t levels() const { return edges.size() - 1; }
};

double most_frequent_bin(const std::vector<ArchiveEntry>& entries) {
  std::map<double, std::size_t> counts;
  for (const auto& e : entries) ++counts[std::round(e.bin_m * 1000) / 1000];
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

Result<void> find_grid(Merged& m, const std::vector<ArchiveEntry>& entries, const MergeSettings& settings) {
  m.axis = settings.axis;
  m.bin_m = settings.bin_m.value_or(most_frequent_bin(entries));
  std::optional<double> low, high;
  for (const auto& e : entries) {
    if (m.axis == MergeAxis::height && !e.surface_msl_m)
      return fail(Kind::missing, "the height of its take-off point is not known", {e.file(), {}, {}, {}},
                  "merge on the altitude, or leave this profile out");
    const double zero = m.axis == MergeAxis::height ? *e.surface_msl_m : 0;
    low = std::min(low.value_or(1e9), e.bottom_msl_m - zero), high = std::max(high.value_or(-1e9), e.top_msl_m - zero);
  }
  // A millimetre of rounding makes no bin.
  const auto first = std::floor((*low + 1e-3) / m.bin_m), last = std::ceil((*high - 1e-3) / m.bin_m);
  for (double i = first; i <= last; ++i) m.edges.push_back(i * m.bin_m);
  return {};
}

void find_site(Merged& m, const std::vector<ArchiveEntry>& entries) {
  const auto& first = entries.front();
  double lat = 0, lon = 0;
  for (const auto& e : entries) lat += e.lat_deg - first.lat_deg, lon += std::remainder(e.lon_deg - first.lon_deg, 360);
  const auto n = static_cast<double>(entries.size());
  m.lat_deg = first.lat_deg + lat / n, m.lon_deg = std::remainder(first.lon_deg + lon / n, 360);
  m.one_site = std::all_of(entries.begin(), entries.end(), [&](const ArchiveEntry& e) {
    return (!e.station.empty() && e.station == first.station) ||
           ingest::distance_m({m.lat_deg, m.lon_deg}, {e.lat_deg, e.lon_deg}) <= one_site_m;
  });
}

Result<void> take_records(Merged& m, const Archive& from, const std::vector<ArchiveEntry>& entries,
                          const ArchiveSettings& settings) {
  constexpr const char* legs[] = {"up", "down", "all"};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (settings.stopped && settings.stopped())
      return fail(Kind::no_answer, "stopped before it was finished", {}, "nothing was written; run it again");
    const auto& e = entries[i];
    const auto bytes = from.read(e);
    if (!bytes) return fail(bytes.error());
    auto profile = read_profile_netcdf(ingest::as_bytes(*bytes), e.file());
    if (!profile) return fail(profile.error());
    const double zero = m.axis == MergeAxis::height ? *e.surface_msl_m : 0;
    for (auto& record : profile->records) {
      record.bins = regrid(*profile, record, zero, m.edges);
      m.records.push_back({&e, std::move(record), fmt::format("{}-{}", e.name, legs[record.leg])});
    }
    if (m.records.size() * m.levels() > most_cells)
      return fail(Kind::limit,
                  fmt::format("one file of more than {} bins is more than a netCDF reader likes", most_cells), {},
                  "narrow the query, or export a folder");
    if (settings.progress) settings.progress(static_cast<double>(i + 1) / static_cast<double>(entries.size()));
  }
  std::stable_sort(m.records.begin(), m.records.end(),
                   [](const auto& a, const auto& b) { return a.record.mid_s < b.record.mid_s; });
  for (std::size_t i = 1; i < m.records.size(); ++i)
    if (m.records[i].record.mid_s <= m.records[i - 1].record.mid_s)
      return fail(Kind::inconsistent,
                  fmt::format("{} and {} share their mid time, and a time axis must grow", m.records[i - 1].id,
                              m.records[i].id),
                  {}, "narrow the query, as by --vehicle-id, or export a folder");
  return {};
}

class MergedFile {
 public:
  explicit MergedFile(const Merged& m) : m_(m), n_(m.records.size()), levels_(m.levels()) {}

  Result<std::string> bytes(const ProductText& text, const NetcdfMetadata& metadata, const std::string& id) {
    define_axes();
    define_site();
    WindVariables wind(file_, grid_);
    define_bins();
    write_common_attributes(file_, text, metadata, id);
    const std::int32_t merged = 1;
    file_.attribute(NcFile::global, "quadsonde_merged", std::span<const std::int32_t>(&merged, 1));
    file_.end_definitions();
    put_axes();
    put_site();
    put_bins(wind);
    return file_.finish();
  }

 private:
  using Texts = std::initializer_list<std::pair<const char*, std::string>>;
  void texts(NcFile::Variable variable, Texts list) {
    for (const auto& [name, value] : list) file_.attribute(variable, name, std::string_view(value));
  }

  void define_axes() {
    const bool height = m_.axis == MergeAxis::height;
    const char* z = height ? "height" : "altitude";
    time_ = file_.unlimited("time"), z_ = file_.dimension(z, levels_), nv_ = file_.dimension("nv", 2);
    grid_ = {{time_, z_}, {std::min<std::size_t>(n_, time_chunk), levels_}, {}, {}, true, " n_obs"};
    grid_.coordinates = "lat lon station_id profile_id";
    // CF section 9.6: where a coordinate is missing the data would have to be missing, too.
    const bool known = std::all_of(m_.records.begin(), m_.records.end(),
                                   [](const auto& r) { return r.entry->surface_msl_m.has_value(); });
    if (known) grid_.coordinates += height ? " altitude" : " height";
    grid_.cell_methods = std::string(z) + ": time: mean";
    v_.time = file_.variable("time", Type::float64, {time_}, {time_chunk});
    texts(v_.time, {{"standard_name", "time"},
                    {"long_name", "mid time of the record"},
                    {"units", time_units},
                    {"calendar", "standard"},
                    {"axis", "T"},
                    {"bounds", "time_bnds"},
                    {"coverage_content_type", "coordinate"}});
    v_.time_bnds = file_.variable("time_bnds", Type::float64, {time_, nv_}, {time_chunk, 2});
    v_.z = file_.variable(z, Type::float64, {z_});
    texts(v_.z, {{"standard_name", z},
                 {"long_name", height ? "height of the bin centre above ground at the take-off point"
                                      : "altitude of the bin centre above the geoid"},
                 {"units", "m"},
                 {"positive", "up"},
                 {"axis", "Z"},
                 {"bounds", std::string(z) + "_bnds"},
                 {"coverage_content_type", "coordinate"}});
    v_.z_bnds = file_.variable(std::string(z) + "_bnds", Type::float64, {z_, nv_});
    v_.other_z = file_.variable(height ? "altitude" : "height", Type::float64, grid_.dimensions, grid_.chunks);
    file_.nan_is_missing(v_.other_z, Type::float64);
    texts(v_.other_z, {{"standard_name", height ? "altitude" : "height"},
                       {"long_name", height ? "altitude of the bin centre above the geoid"
                                            : "height of the bin centre above ground at the take-off point"},
                       {"units", "m"},
                       {"positive", "up"},
                       {"coverage_content_type", "coordinate"}});
  }

  NcFile::Variable words(const char* name, const char* role, const char* long_name, bool per_record,
                         const std::vector<std::string>& values) {
    Words w{-1, per_record, 1, values};
    for (const auto& value : values) w.length = std::max(w.length, value.size());
    const auto letters = file_.dimension((std::string(name) + "_strlen").c_str(), w.length);
    w.variable = per_record ? file_.variable(name, Type::character, {time_, letters}, {time_chunk, w.length})
                            : file_.variable(name, Type::character, {letters});
    texts(w.variable, {{"cf_role", role}, {"long_name", long_name}});
    words_.push_back(std::move(w));
    return words_.back().variable;
  }

  void define_site() {
    const bool one = m_.one_site;
    const std::vector<NcFile::Dimension> where = one ? std::vector<NcFile::Dimension>{} : std::vector{time_};
    const std::vector<std::size_t> chunks = one ? std::vector<std::size_t>{} : std::vector{time_chunk};
    v_.lat = file_.variable("lat", Type::float64, where, chunks);
    texts(v_.lat, {{"standard_name", "latitude"},
                   {"units", "degrees_north"},
                   {"long_name", one ? "mean latitude of the launch site" : "latitude of the launch site"}});
    v_.lon = file_.variable("lon", Type::float64, where, chunks);
    texts(v_.lon, {{"standard_name", "longitude"},
                   {"units", "degrees_east"},
                   {"long_name", one ? "mean longitude of the launch site" : "longitude of the launch site"}});
    if (one) texts(v_.lat, {{"axis", "Y"}}), texts(v_.lon, {{"axis", "X"}});
    for (const auto v : {v_.lat, v_.lon}) texts(v, {{"coverage_content_type", "coordinate"}});
    std::vector<std::string> stations, ids, sources, inputs, vehicles;
    for (const auto& r : m_.records) {
      stations.push_back(!r.entry->station.empty() ? r.entry->station
                                                   : fmt::format("{:.4f},{:.4f}", r.entry->lat_deg, r.entry->lon_deg));
      ids.push_back(r.id), sources.push_back(r.entry->name + ".nc"), inputs.push_back(r.entry->input_sha256);
      vehicles.push_back(r.entry->vehicle);
    }
    if (one) stations.resize(1);
    words("station_id", one ? "timeseries_id" : "", "identifier of the launch site, or its latitude and longitude",
          !one, stations);
    words("profile_id", "profile_id", "unique identifier of the record", true, ids);
    words("source_file", "", "netCDF file of the archive that the record is from", true, sources);
    words("source_sha256", "", "SHA-256 of the log that the record is from", true, inputs);
    words("vehicle", "", "vehicle that flew the record", true, vehicles);
    const VariableLayout per_record{{time_}, {time_chunk}, "lat lon station_id profile_id", "", false, ""};
    v_.surface = define(file_, per_record, Type::float64,
                        {"surface_altitude", "surface_altitude", "altitude of the take-off point above the geoid", "m",
                         "", "", "auxiliaryInformation"});
    define_crs(file_);
  }

  void define_bins() {
    v_.n_obs = define(file_, grid_, Type::int32,
                      {"n_obs", "number_of_observations", "number of samples with an estimate in the bin", "1", "", "",
                       "auxiliaryInformation"});
    constexpr std::array<signed char, 3> legs{0, 1, 2};
    v_.leg = file_.variable("leg", Type::byte, {time_}, {time_chunk});
    texts(v_.leg, {{"long_name", "leg of the flight that the record holds"}});
    file_.attribute(v_.leg, "flag_values", legs);
    texts(v_.leg, {{"flag_meanings", "up down all"},
                   {"coordinates", "lat lon station_id profile_id"},
                   {"coverage_content_type", "auxiliaryInformation"}});
  }

  void put_axes() {
    std::vector<double> mids, spans, centres, edges, other;
    std::vector<signed char> legs;
    for (std::size_t i = 0; i < levels_; ++i) {
      edges.push_back(m_.edges[i]), edges.push_back(m_.edges[i + 1]);
      centres.push_back((m_.edges[i] + m_.edges[i + 1]) / 2);
    }
    for (const auto& r : m_.records) {
      mids.push_back(r.record.mid_s), spans.push_back(r.record.from_s), spans.push_back(r.record.to_s);
      legs.push_back(static_cast<signed char>(r.record.leg));
      const double surface = r.entry->surface_msl_m.value_or(std::nan(""));
      for (const double c : centres) other.push_back(m_.axis == MergeAxis::height ? c + surface : c - surface);
    }
    file_.put(v_.time, {n_}, mids), file_.put(v_.time_bnds, {n_, 2}, spans);
    file_.put(v_.z, {levels_}, centres), file_.put(v_.z_bnds, {levels_, 2}, edges);
    file_.put(v_.other_z, {n_, levels_}, other), file_.put(v_.leg, {n_}, legs);
  }

  void put_site() {
    std::vector<double> lats, lons, surfaces;
    for (const auto& r : m_.records) {
      lats.push_back(r.entry->lat_deg), lons.push_back(r.entry->lon_deg);
      surfaces.push_back(r.entry->surface_msl_m.value_or(std::nan("")));
    }
    if (m_.one_site) lats = {m_.lat_deg}, lons = {m_.lon_deg};
    const std::vector<std::size_t> shape = m_.one_site ? std::vector<std::size_t>{} : std::vector{n_};
    file_.put(v_.lat, shape, lats), file_.put(v_.lon, shape, lons), file_.put(v_.surface, {n_}, surfaces);
    for (const auto& w : words_) {
      std::string all;
      for (const auto& value : w.values) all += padded(value, w.length);
      file_.put(w.variable, w.per_record ? std::vector{n_, w.length} : std::vector{w.length}, all);
    }
  }

  void put_bins(WindVariables& wind) {
    WindNumbers numbers;
    std::vector<std::int32_t> counts;
    for (const auto& r : m_.records)
      for (const auto& bin : r.record.bins) {
        const auto quality = bin.quality == 1   ? estimator::Quality::good
                             : bin.quality == 3 ? estimator::Quality::doubtful
                                                : estimator::Quality::bad;
        numbers.add(wind_of(bin), quality, bin.reasons);
        counts.push_back(
            static_cast<std::int32_t>(std::min<std::int64_t>(bin.has_wind() ? bin.samples : 0, INT32_MAX)));
      }
    wind.put(numbers, {n_, levels_});
    file_.put(v_.n_obs, {n_, levels_}, counts);
  }

  struct Words {
    NcFile::Variable variable;
    bool per_record;
    std::size_t length;
    std::vector<std::string> values;
  };
  const Merged& m_;
  const std::size_t n_, levels_;
  NcFile file_;
  NcFile::Dimension time_ = -1, z_ = -1, nv_ = -1;
  VariableLayout grid_;
  std::vector<Words> words_;
  struct {
    NcFile::Variable time, time_bnds, z, z_bnds, other_z, lat, lon, surface, n_obs, leg;
  } v_{};
};

ProductText text_of(const Merged& m) {
  ProductText t;
  t.feature_type = m.one_site ? "timeSeriesProfile" : "profile";
  t.cdm_data_type = m.one_site ? "TimeSeriesProfile" : "Profile";
  t.title = "Vertical wind profiles of multirotors";
  t.summary = "Horizontal wind estimated from the attitude and the motion of multirotors, averaged in bins by height.";
  t.processing_level = "binned profiles, merged";
  t.comment = fmt::format(
      "profiles of an archive on one grid of {} m: a bin is the mean of the profile's bins with a wind that lie in it, "
      "weighted by overlap, where they cover at least half of it; uncertainties of averaged bins count as fully "
      "correlated, quality is that of the worst; source_file and source_sha256 name what a record is from",
      m.bin_m);
  t.from = utc_of(m.records.front().record.from_s), t.to = t.from;
  for (const auto& r : m.records) {
    t.from = std::min(t.from, utc_of(r.record.from_s)), t.to = std::max(t.to, utc_of(r.record.to_s));
    t.lat.add(m.one_site ? m.lat_deg : r.entry->lat_deg), t.lon.add(m.one_site ? m.lon_deg : r.entry->lon_deg);
  }
  for (std::size_t i = 0; i < m.levels(); ++i) t.altitude.add((m.edges[i] + m.edges[i + 1]) / 2);
  t.time_step_s = m.records.size() > 1 ? (m.records.back().record.mid_s - m.records.front().record.mid_s) /
                                             static_cast<double>(m.records.size() - 1)
                                       : ingest::to_seconds(t.to - t.from);
  t.vertical_resolution = fmt::format("{} m", m.bin_m);
  return t;
}

/// What all of them say, and nothing where they differ.
std::string common(const std::vector<ArchiveEntry>& entries, std::string ArchiveEntry::*what) {
  const auto& first = entries.front().*what;
  const bool same = std::all_of(entries.begin(), entries.end(), [&](const auto& e) { return e.*what == first; });
  return same ? first : std::string();
}

}  // namespace

Result<std::string> merged_netcdf(const Archive& from, const std::vector<ArchiveEntry>& entries,
                                  const MergeSettings& merge, const ArchiveSettings& settings) {
  if (entries.empty())
    return fail(Kind::no_answer, "no profile fits, so there is nothing to merge", {from.root().string(), {}, {}, {}},
                "ask for more with `quadsonde archive query`");
  if (entries.size() > most_profiles)
    return fail(Kind::limit,
                fmt::format("{} profiles are too many for one file; {} are the most", entries.size(), most_profiles),
                {}, "narrow the query, or export a folder");
  Merged m;
  if (auto done = find_grid(m, entries, merge); !done) return fail(done.error());
  find_site(m, entries);
  if (auto done = take_records(m, from, entries, settings); !done) return fail(done.error());
  NetcdfMetadata metadata;
  metadata.vehicle = common(entries, &ArchiveEntry::vehicle);
  metadata.station.license = common(entries, &ArchiveEntry::license);
  metadata.station.institution = common(entries, &ArchiveEntry::institution);
  return MergedFile(m).bytes(text_of(m), metadata, "merged-" + std::to_string(entries.size()));
}

}  // namespace quadsonde::product
