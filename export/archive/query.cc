#include "export/archive/query.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "ingest/flight/local_frame.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Result;

tl::unexpected<ingest::Problem> wrong(const char* flag, const std::string& text, const char* expected) {
  return fail(Kind::usage, fmt::format("{} {}: expected {}", flag, text, expected), {},
              "see `quadsonde archive query --help`");
}

/// Numbers with commas between.
template <std::size_t count>
std::optional<std::array<double, count>> numbers(const std::string& text) {
  std::array<double, count> values{};
  const char *at = text.data(), *end = at + text.size();
  for (std::size_t i = 0; i < count; ++i) {
    while (at != end && *at == ' ') ++at;
    const auto [next, error] = std::from_chars(at, end, values[i]);
    if (error != std::errc() || !std::isfinite(values[i])) return std::nullopt;
    at = next;
    while (at != end && *at == ' ') ++at;
    if (i + 1 < count && (at == end || *at++ != ',')) return std::nullopt;
  }
  if (at != end) return std::nullopt;
  return values;
}

struct Near {
  ingest::GeoPoint place;
  double distance_m = 0;
};

class Conditions {
 public:
  void add(const std::string& sql, std::initializer_list<IndexValue> values) {
    condition_.sql += " AND " + sql;
    condition_.values.insert(condition_.values.end(), values);
  }
  /// Longitudes -180 to 180; west > east goes across the date line.
  void between(double west, double south, double east, double north) {
    add("lat_deg BETWEEN ? AND ?", {south, north});
    if (east - west >= 360) return;
    const double w = std::remainder(west, 360), e = std::remainder(east, 360);
    if (w <= e)
      add("lon_deg BETWEEN ? AND ?", {w, e});
    else
      add("(lon_deg >= ? OR lon_deg <= ?)", {w, e});
  }
  IndexCondition condition_;
};

Result<void> add_times(Conditions& all, const ArchiveQuery& q) {
  const auto seconds = [](const std::string& text) -> std::optional<double> {
    const auto utc = ingest::parse_iso8601(text.size() == 10 ? text + "T00:00:00Z" : text);
    if (!utc) return std::nullopt;
    return static_cast<double>(utc->ns) * 1e-9;
  };
  if (!q.from.empty()) {
    const auto from = seconds(q.from);
    if (!from) return wrong("--from", q.from, "a time as 2026-06-01T05:30:00Z");
    // No flight lasts a week: this lets the index by start answer.
    all.add("end_s >= ? AND start_s >= ?", {*from, *from - 7 * 86400.0});
  }
  if (!q.to.empty()) {
    const auto to = seconds(q.to);
    if (!to) return wrong("--to", q.to, "a time as 2026-06-01T05:30:00Z");
    all.add("start_s < ?", {*to});
  }
  return {};
}

Result<std::optional<Near>> add_places(Conditions& all, const ArchiveQuery& q) {
  if (!q.box.empty()) {
    const auto b = numbers<4>(q.box);
    const bool sound = b && (*b)[1] <= (*b)[3] && std::abs((*b)[1]) <= 90 && std::abs((*b)[3]) <= 90 &&
                       std::abs((*b)[0]) <= 360 && std::abs((*b)[2]) <= 360;
    if (!sound) return wrong("--box", q.box, "west,south,east,north in degrees, as 16.2,48.1,16.6,48.3");
    all.between((*b)[0], (*b)[1], (*b)[2], (*b)[3]);
  }
  if (q.near.empty()) return std::nullopt;
  const auto p = numbers<2>(q.near);
  if (!p || std::abs((*p)[0]) > 90 || std::abs((*p)[1]) > 360)
    return wrong("--near", q.near, "latitude,longitude in degrees, as 48.2,16.37");
  const Near near{{(*p)[0], std::remainder((*p)[1], 360)}, q.within_km * 1000};
  // A box that surely holds the circle: a degree of latitude is at least 110.5 km long. The distance itself follows.
  const double dlat = near.distance_m / 110500 + 1e-6;
  const double south = std::max(-90.0, near.place.lat_deg - dlat), north = std::min(90.0, near.place.lat_deg + dlat);
  const double widest = std::max(std::abs(south), std::abs(north)) * std::numbers::pi / 180;
  const double dlon = widest < 1.55 ? dlat / std::cos(widest) : 360;
  if (dlon >= 180)
    all.between(-180, south, 180, north);
  else
    all.between(near.place.lon_deg - dlon, south, near.place.lon_deg + dlon, north);
  return near;
}

Result<IndexCondition> conditions(const ArchiveQuery& q, std::optional<Near>& near) {
  Conditions all;
  if (!q.all_versions) all.add("superseded = 0", {});
  if (auto done = add_times(all, q); !done) return fail(done.error());
  auto place = add_places(all, q);
  if (!place) return fail(place.error());
  near = *place;
  // Above take-off where that is known; nothing matches where it is not.
  const std::string zero = q.datum == "msl" ? "" : " - surface_msl_m";
  if (q.min_height_m) all.add("top_msl_m" + zero + " >= ?", {*q.min_height_m});
  if (q.max_height_m) all.add("bottom_msl_m" + zero + " <= ?", {*q.max_height_m});
  if (q.min_speed_m_s) all.add("speed_max_m_s >= ?", {*q.min_speed_m_s});
  if (q.max_speed_m_s) all.add("speed_min_m_s <= ?", {*q.max_speed_m_s});
  if (!q.vehicle_id.empty()) all.add("vehicle = ?", {q.vehicle_id});
  if (!q.station_id.empty()) all.add("station = ?", {q.station_id});
  const auto least = archive_quality(q.least_quality);
  if (!least) return wrong("--least-quality", q.least_quality, "good, doubtful or bad");
  if (*least != ArchiveQuality::bad) all.add("quality <= ?", {static_cast<std::int64_t>(*least)});
  all.condition_.by_numbers = !all.condition_.values.empty();
  return all.condition_;
}

}  // namespace

Result<IndexCondition> condition_of(const ArchiveQuery& query) {
  std::optional<Near> near;
  return conditions(query, near);
}

Result<std::vector<ArchiveEntry>> query_index(ArchiveIndex& index, const ArchiveQuery& query) {
  std::optional<Near> near;
  const auto condition = conditions(query, near);
  if (!condition) return fail(condition.error());
  std::vector<ArchiveEntry> entries;
  auto done = index.each(*condition, [&](ArchiveEntry&& e) {
    if (!near || ingest::distance_m(near->place, {e.lat_deg, e.lon_deg}) <= near->distance_m)
      entries.push_back(std::move(e));
    return true;
  });
  if (!done) return fail(done.error());
  return entries;
}

}  // namespace quadsonde::product
