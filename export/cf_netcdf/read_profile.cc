#include "export/cf_netcdf/read_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "export/cf_netcdf/nc_file.h"
#include "export/cf_netcdf/profile_decoder.h"
#include "export/isolated.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using nlohmann::json;

constexpr std::size_t most_bytes = std::size_t{64} << 20;
constexpr double year_2200 = 7258118400;

/// What the child said, looked at as something that a stranger said.
class Checked {
 public:
  explicit Checked(const json& said) : said_(said) {}

  StoredProfile profile() {
    StoredProfile p;
    p.version = text("quadsonde_version", 64), p.input_file = text("quadsonde_input_file", 1024);
    p.input_sha256 = text("quadsonde_input_sha256", 64);
    p.input_flight = static_cast<int>(number("quadsonde_input_flight").value_or(0));
    p.settings = text("quadsonde_settings", 65536), p.vehicle = text("quadsonde_vehicle", 65536);
    // What goes through these texts again walks down their nesting.
    for (const auto* object : {&p.settings, &p.vehicle})
      claim(std::count_if(object->begin(), object->end(), [](char c) { return c == '[' || c == '{'; }) < 256,
            "its settings are nested too deep");
    p.id = text("id", 256), p.platform = text("platform", 256), p.license = text("license", 1024);
    p.institution = text("institution", 1024), p.date_created = text("date_created", 64);
    // A site without an identifier is named by its place: 48.2081,16.3738.
    if (const auto id = text("station_id", 256);
        id.find_first_not_of("0123456789.,-") != std::string::npos || id.find(',') == std::string::npos)
      p.station_id = id;
    claim(p.input_sha256.size() == 64 && p.input_sha256.find_first_not_of("0123456789abcdef") == std::string::npos,
          "its quadsonde_input_sha256 is no SHA-256");
    claim(p.input_flight >= 1 && p.input_flight < 100000, "its quadsonde_input_flight is no number of a flight");
    claim(!p.version.empty(), "it names no quadsonde_version");
    place(p);
    axis(p);
    records(p);
    return p;
  }
  std::string complaint() const { return complaint_; }

 private:
  void claim(bool holds, const std::string& otherwise) {
    if (!holds && complaint_.empty()) complaint_ = otherwise;
  }
  const json* find(const char* name) const {
    const auto it = said_.find(name);
    return it == said_.end() ? nullptr : &*it;
  }
  std::string text(const char* name, std::size_t most) {
    const auto* found = find(name);
    if (!found || !found->is_string()) return {};
    auto value = found->get<std::string>();
    claim(value.size() <= most, fmt::format("its {} is longer than {} bytes", name, most));
    return value;
  }
  std::optional<double> number(const char* name) const {
    const auto* found = find(name);
    if (!found || !found->is_number()) return std::nullopt;
    return found->get<double>();
  }
  /// A column of numbers of the right length; NaN for null.
  std::vector<double> numbers(const char* name, std::size_t count, bool finite) {
    std::vector<double> values;
    const auto* found = find(name);
    if (found && found->is_array())
      for (const auto& one : *found) values.push_back(one.is_number() ? one.get<double>() : std::nan(""));
    claim(values.size() == count,
          fmt::format("its {} has {} values where {} were expected", name, values.size(), count));
    values.resize(count, std::nan(""));
    if (finite)
      claim(std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }),
            fmt::format("its {} has a value that is no number", name));
    return values;
  }

  void place(StoredProfile& p) {
    const auto lat = number("lat"), lon = number("lon");
    claim(lat && std::abs(*lat) <= 90 && lon && std::abs(*lon) <= 360, "its lat and lon are no place on Earth");
    p.lat_deg = lat.value_or(0), p.lon_deg = std::remainder(lon.value_or(0), 360);
    p.surface_msl_m = number("surface_altitude");
    claim(!p.surface_msl_m || std::abs(*p.surface_msl_m) < 20000, "its surface_altitude is no height on Earth");
  }
  void axis(StoredProfile& p) {
    const auto* levels = find("altitude");
    const auto n = levels && levels->is_array() ? levels->size() : 0;
    claim(n > 0, "it has no altitudes");
    const auto edges = numbers("altitude_bnds", 2 * n, true);
    for (std::size_t i = 0; i < n; ++i) {
      p.bottom_msl_m.push_back(edges[2 * i]), p.top_msl_m.push_back(edges[2 * i + 1]);
      claim(edges[2 * i] < edges[2 * i + 1] && std::abs(edges[2 * i]) < 200000, "its bins have no height");
      claim(i == 0 || edges[2 * i] >= edges[2 * i - 1] - 1e-3, "its bins do not follow each other");
    }
  }
  void records(StoredProfile& p) {
    const auto* times = find("time");
    const auto n = times && times->is_array() ? times->size() : 0;
    claim(n > 0, "it has no record");
    const auto mids = numbers("time", n, true), spans = numbers("time_bnds", 2 * n, true),
               legs = numbers("leg", n, true);
    const auto* ids = find("profile_id");
    for (std::size_t i = 0; i < n; ++i) {
      StoredRecord r;
      r.mid_s = mids[i], r.from_s = spans[2 * i], r.to_s = spans[2 * i + 1], r.leg = static_cast<int>(legs[i]);
      claim(r.from_s >= 0 && r.from_s <= r.mid_s && r.mid_s <= r.to_s && r.to_s < year_2200,
            "its times are none of a flight");
      claim(i == 0 || p.records.back().mid_s < r.mid_s, "its times do not grow");
      claim(r.leg >= 0 && r.leg <= 2, "its legs are none that there are");
      if (ids && ids->is_array() && i < ids->size() && (*ids)[i].is_string()) r.id = (*ids)[i].get<std::string>();
      claim(r.id.size() <= 256, "its profile_id is longer than 256 bytes");
      p.records.push_back(std::move(r));
    }
    bins(p);
  }
  void bins(StoredProfile& p) {
    const auto levels = p.bottom_msl_m.size(), cells = levels * p.records.size();
    std::vector<std::vector<double>> columns;
    for (const auto* name : {"eastward_wind", "northward_wind", "wind_speed", "wind_from_direction", "eastward_wind_se",
                             "northward_wind_se", "wind_error_covariance", "wind_qc", "n_obs", "wind_qc_reasons"})
      columns.push_back(numbers(name, cells, false));
    const auto known = [](double v) { return std::isfinite(v) ? std::optional(v) : std::nullopt; };
    std::vector<std::pair<std::optional<double> StoredBin::*, std::vector<double>>> more;
    for (const auto& [name, member] : optional_bin_variables())
      if (find(name)) more.emplace_back(member, numbers(name, cells, false));
    for (std::size_t i = 0; i < cells; ++i) {
      StoredBin b;
      b.east = known(columns[0][i]), b.north = known(columns[1][i]), b.speed = known(columns[2][i]);
      b.from_deg = known(columns[3][i]), b.se_east = known(columns[4][i]), b.se_north = known(columns[5][i]);
      b.covariance = known(columns[6][i]);
      for (const auto& [member, values] : more) b.*member = known(values[i]);
      b.quality = static_cast<int>(known(columns[7][i]).value_or(9));
      b.samples = static_cast<std::int64_t>(std::clamp(known(columns[8][i]).value_or(0), 0.0, 1e9));
      b.reasons = reasons(known(columns[9][i]).value_or(0));
      if (b.has_wind())
        claim(
            std::hypot(*b.east, *b.north) < 200 && b.speed && std::abs(*b.speed - std::hypot(*b.east, *b.north)) < 0.01,
            "its wind_speed is not that of its components");
      p.records[i / levels].bins.push_back(b);
    }
  }

  /// Bits mean what the file says they mean: other versions may know other reasons.
  estimator::Reasons reasons(double flags) {
    estimator::Reasons known;
    if (!(flags > 0 && flags < 4294967296.0)) return known;
    const auto bits = static_cast<std::uint64_t>(flags);
    if (meanings_.empty()) {
      std::istringstream words(text("reason_names", 65536));
      for (std::string word; words >> word;) meanings_.push_back(word);
    }
    for (std::size_t bit = 0; bit < std::min<std::size_t>(meanings_.size(), 32); ++bit)
      for (int i = 0; (bits >> bit & 1) && i < static_cast<int>(estimator::Reason::count); ++i)
        if (estimator::name(static_cast<estimator::Reason>(i)) == meanings_[bit])
          known.add(static_cast<estimator::Reason>(i));
    return known;
  }

  const json& said_;
  std::string complaint_;
  std::vector<std::string> meanings_;
};

bool any_wind(const StoredProfile& p) {
  return std::any_of(p.records.begin(), p.records.end(), [](const StoredRecord& r) {
    return std::any_of(r.bins.begin(), r.bins.end(), [](const StoredBin& b) { return b.has_wind(); });
  });
}

constexpr const char* make_it = "give a profile.nc that `quadsonde run` or `quadsonde profile -o X.nc` wrote";

/// Before a library sees them.
ingest::Result<void> check_first_bytes(ingest::Bytes bytes, const ingest::Where& where) {
  const auto text = ingest::as_text(bytes);
  if (bytes.empty()) return fail(Kind::unsupported, "this file is empty, not a netCDF profile", where, make_it);
  if (text.starts_with("CDF\1") || text.starts_with("CDF\2") || text.starts_with("CDF\5"))
    return fail(Kind::unsupported, "this is a netCDF file of the classic format, not one of our profiles", where,
                make_it);
  if (!text.starts_with("\x89HDF\r\n\x1a\n"))
    return fail(Kind::unsupported, "this is not a netCDF-4 file", where, make_it);
  if (bytes.size() > most_bytes)
    return fail(Kind::limit, fmt::format("no profile has {} MB; {} are the most", bytes.size() >> 20, most_bytes >> 20),
                where, make_it);
  return {};
}

}  // namespace

ingest::Result<StoredProfile> read_profile_netcdf(ingest::Bytes bytes, const std::string& name) {
  const ingest::Where where{name, {}, {}, {}};
  if (auto looked = check_first_bytes(bytes, where); !looked) return fail(looked.error());
  const auto lock = lock_netcdf();
  const auto answer = isolated([&] { return decode_profile(bytes); });
  if (!answer) {
    auto problem = answer.error();
    problem.where = where;
    if (problem.hint.empty()) problem.hint = make_it;
    return fail(problem);
  }
  const auto said = json::parse(*answer, nullptr, false);
  if (!said.is_object()) return fail(Kind::damaged, "the library that decodes it fails on it", where, make_it);
  if (const auto no = said.find("not_ours"); no != said.end() && no->is_string())
    return fail(Kind::unsupported, "this netCDF is not one of our profiles: " + no->get<std::string>(), where, make_it);
  Checked checked(said);
  auto profile = checked.profile();
  if (!checked.complaint().empty())
    return fail(Kind::damaged, "this profile contradicts itself: " + checked.complaint(), where, make_it);
  if (!any_wind(profile))
    return fail(Kind::no_answer, "no bin of this profile has a wind, so there is nothing to keep", where,
                "see `quadsonde profile` for the reasons");
  return profile;
}

}  // namespace quadsonde::product
