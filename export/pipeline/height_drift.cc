#include "export/pipeline/height_drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ingest/flight/local_frame.h"

namespace quadsonde::product {
namespace {

using ingest::Flight;
using ingest::LogTime;

constexpr double least_drift = 1;         // m
constexpr double same_place = 30;         // m
constexpr double ground_seconds = 5, air_seconds = 20;

struct Level {
  double mean = 0, sd = 0;
};

/// Of the heights between two times; empty with fewer than three.
template <class Stream>
std::optional<Level> level_of(const Stream& heights, LogTime from, LogTime to) {
  double sum = 0, squares = 0, n = 0;
  for (auto i = ingest::last_at_or_before(heights, from) + 1; i < static_cast<std::ptrdiff_t>(heights.size()); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (heights.time[k] > to) break;
    const double h = heights.value[k].m;
    sum += h, squares += h * h, n += 1;
  }
  if (n < 3) return std::nullopt;
  const double mean = sum / n;
  return Level{mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
}

std::optional<ingest::GeoPoint> place_at(const Flight& flight, LogTime t) {
  const auto i = ingest::last_at_or_before(flight.position, t);
  if (i < 0) return std::nullopt;
  return flight.position.value[static_cast<std::size_t>(i)];
}

std::optional<HeightDrift> significant(double metres, double scatter, LogTime from, LogTime to, const char* by) {
  if (std::abs(metres) < std::max(least_drift, 3 * scatter)) return std::nullopt;
  return HeightDrift{metres, from, to, by};
}

std::optional<HeightDrift> by_landing(const Flight& boot, const ingest::Segment& segment, bool& known) {
  if (segment.starts_in_air || segment.ends_in_air) return std::nullopt;
  const auto lift_off = segment.from - ingest::seconds(0.5), touch_down = segment.to + ingest::seconds(2);
  const auto from = place_at(boot, lift_off), to = place_at(boot, touch_down);
  if (!from || !to || ingest::distance_m(*from, *to) > same_place) return std::nullopt;
  const auto before = level_of(boot.height_msl, lift_off - ingest::seconds(ground_seconds), lift_off);
  const auto after = level_of(boot.height_msl, touch_down, touch_down + ingest::seconds(ground_seconds));
  if (!before || !after) return std::nullopt;
  known = true;
  return significant(after->mean - before->mean, std::hypot(before->sd, after->sd), segment.from, segment.to,
                     "the landing");
}

std::optional<HeightDrift> by_satellites(const Flight& boot, const ingest::Segment& segment) {
  if (boot.height_ellipsoid.empty() || ingest::to_seconds(segment.to - segment.from) < 3 * air_seconds)
    return std::nullopt;
  // A height above the sea that was made of the ellipsoid's shows no drift against it.
  if (boot.height_ellipsoid.source == boot.height_msl.source) return std::nullopt;
  const auto window = ingest::seconds(air_seconds);
  const auto used_first = level_of(boot.height_msl, segment.from, segment.from + window);
  const auto used_last = level_of(boot.height_msl, segment.to - window, segment.to);
  const auto seen_first = level_of(boot.height_ellipsoid, segment.from, segment.from + window);
  const auto seen_last = level_of(boot.height_ellipsoid, segment.to - window, segment.to);
  if (!used_first || !used_last || !seen_first || !seen_last) return std::nullopt;
  const double metres = (used_last->mean - seen_last->mean) - (used_first->mean - seen_first->mean);
  // A satellite height wanders by a metre or two by itself.
  constexpr double satellite_wander = 1.5;
  return significant(metres, satellite_wander, segment.from, segment.to, "the satellite height");
}

template <class Stream, class Make>
void shift(Stream& heights, const HeightDrift& drift, Make make) {
  const double span = ingest::to_seconds(drift.to - drift.from);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double part = std::clamp(ingest::to_seconds(heights.time[i] - drift.from) / span, 0.0, 1.0);
    heights.value[i] = make(heights.value[i].m - part * drift.metres);
  }
}

}  // namespace

std::optional<HeightDrift> find_height_drift(const Flight& boot, const ingest::Segment& segment) {
  if (boot.height_msl.empty()) return std::nullopt;
  bool known = false;
  auto drift = by_landing(boot, segment, known);
  return known ? drift : by_satellites(boot, segment);
}

void take_off_drift(Flight& flight, const HeightDrift& drift) {
  shift(flight.height_msl, drift, [](double m) { return ingest::MslHeight{m}; });
  shift(flight.height_ground, drift, [](double m) { return ingest::GroundHeight{m}; });
}

std::string drift_words(const HeightDrift& drift) {
  return fmt::format("height drift of {:+.1f} m by {}, taken off evenly in time", drift.metres, drift.by);
}

}  // namespace quadsonde::product
