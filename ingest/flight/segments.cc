#include "ingest/flight/segments.h"

#include <cmath>
#include <functional>

namespace quadsonde::ingest {
namespace {

/// A height for every time, by whatever the log has; only differences count.
struct HeightTrack {
  std::vector<LogTime> time;
  std::vector<double> up;
};

HeightTrack height_track(const Flight& flight) {
  HeightTrack track;
  const auto take = [&](const auto& stream, auto up) {
    if (track.time.size() >= 2 || stream.size() < 2) return;
    track.time = stream.time;
    for (const auto& value : stream.value) track.up.push_back(up(value));
  };
  take(flight.height_ground, [](auto h) { return h.m; });
  take(flight.height_msl, [](auto h) { return h.m; });
  take(flight.height_ellipsoid, [](auto h) { return h.m; });
  take(flight.local_position, [](const Eigen::Vector3d& p) { return -p.z(); });
  return track;
}

/// Means over a second: height noise must not look like a take-off.
void calm_down(HeightTrack& track) {
  std::vector<double> mean(track.up.size());
  std::size_t begin = 0, end = 0;
  double sum = 0;
  for (std::size_t i = 0; i < track.up.size(); ++i) {
    for (; end < track.up.size() && track.time[end] <= track.time[i] + seconds(0.5); ++end) sum += track.up[end];
    for (; track.time[begin] < track.time[i] - seconds(0.5); ++begin) sum -= track.up[begin];
    mean[i] = sum / static_cast<double>(end - begin);
  }
  track.up = std::move(mean);
}

double value_at(const HeightTrack& track, LogTime t) {
  const auto after = static_cast<std::size_t>(std::upper_bound(track.time.begin(), track.time.end(), t) -
                                              track.time.begin());
  return track.up[after == 0 ? 0 : after - 1];
}

/// Lowest height: the smallest value that a hundredth of the samples stay below, so one spike does not dig a hole.
double lowest(const HeightTrack& track) {
  auto sorted = track.up;
  const auto rank = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 100);
  std::nth_element(sorted.begin(), rank, sorted.end());
  return *rank;
}

/// Times from which the log says that the motors are locked, and whether they are. Empty where it does not tell.
Stream<bool> disarmed_times(const Flight& flight) {
  Stream<bool> disarmed;
  for (std::size_t i = 0; i < flight.events.size(); ++i) {
    const auto what = flight.events.value[i].what;
    if (what == Event::What::armed || what == Event::What::disarmed)
      disarmed.push(flight.events.time[i], what == Event::What::disarmed);
  }
  return disarmed;
}

std::function<bool(std::size_t)> airborne_rule(const Flight& flight, const SegmentSettings& settings) {
  const auto& velocity = flight.velocity;
  auto track = height_track(flight);
  calm_down(track);
  const double ground = track.time.empty() ? 0 : lowest(track);
  return [&velocity, &flight, track, ground, settings, disarmed = disarmed_times(flight)](std::size_t i) {
    const LogTime t = velocity.time[i];
    // A receiver that settles on the ground shows metres of height and a metre per second of speed.
    if (const auto at = last_at_or_before(disarmed, t); at >= 0 && disarmed.value[static_cast<std::size_t>(at)])
      return false;
    if (!flight.landed.empty()) {
      const auto at = last_at_or_before(flight.landed, t);
      return !flight.landed.value[static_cast<std::size_t>(std::max<std::ptrdiff_t>(at, 0))];
    }
    if (velocity.value[i].head<2>().norm() > settings.speed_in_air) return true;
    return !track.time.empty() && value_at(track, t) > ground + settings.height_in_air;
  };
}

}  // namespace

std::vector<Segment> airborne_segments(const Flight& flight, const SegmentSettings& settings) {
  std::vector<Segment> segments;
  const auto& time = flight.velocity.time;
  if (time.empty()) return segments;
  const auto airborne = airborne_rule(flight, settings);
  // A stop close to the lowest height is no landing unless it lasts: vertical flights turn round there.
  const Duration bridge = seconds(settings.min_ground_time), gap = seconds(settings.max_gap);
  std::optional<Segment> open;
  LogTime last_in_air;
  const auto close = [&] {
    if (open && to_seconds(last_in_air - open->from) >= settings.min_duration) {
      open->to = last_in_air;
      segments.push_back(*open);
    }
    open.reset();
  };
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i > 0 && time[i] - time[i - 1] > gap) {
      if (open) open->ends_in_air = true;
      close();
    }
    if (airborne(i)) {
      if (!open) open = Segment{time[i], time[i], i == 0, false};
      last_in_air = time[i];
    } else if (open && time[i] - last_in_air > bridge) {
      close();
    }
  }
  if (open && time.back() - last_in_air <= Duration(0)) open->ends_in_air = true;
  close();
  return segments;
}

std::optional<MslHeight> takeoff_height(const Flight& flight, const Segment& segment) {
  const auto& heights = flight.height_msl;
  if (heights.empty()) return std::nullopt;
  if (!segment.starts_in_air) {
    const auto before = last_at_or_before(heights, segment.from - seconds(0.5));
    if (before >= 0) return heights.value[static_cast<std::size_t>(before)];
  }
  if (!segment.ends_in_air) {
    const auto at = last_at_or_before(heights, segment.to + seconds(2));
    if (at >= 0) return heights.value[static_cast<std::size_t>(at)];
  }
  return std::nullopt;
}

}  // namespace quadsonde::ingest
