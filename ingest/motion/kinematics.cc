#include "ingest/motion/kinematics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "ingest/flight/local_frame.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double stretch = 10;  // [s]: long against a receiver's noise, short against its wander

struct Track {
  std::vector<LogTime> time;
  std::vector<Eigen::Vector3d> p;
};

/// Integral of the velocity at its own times; holes begin a new stretch.
struct Travelled {
  std::vector<LogTime> time;
  std::vector<Eigen::Vector3d> way;
  std::vector<int> piece;
};

Travelled travelled(const VelocityStream& velocity) {
  Travelled out;
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  int piece = 0;
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (i > 0) {
      const double dt = to_seconds(velocity.time[i] - velocity.time[i - 1]);
      if (dt > 1) ++piece;
      way += 0.5 * dt * (velocity.value[i] + velocity.value[i - 1]);
    }
    out.time.push_back(velocity.time[i]);
    out.way.push_back(way);
    out.piece.push_back(piece);
  }
  return out;
}

std::optional<std::pair<Eigen::Vector3d, int>> way_at(const Travelled& t, LogTime at) {
  const auto k = static_cast<std::size_t>(std::upper_bound(t.time.begin(), t.time.end(), at) - t.time.begin());
  if (k == 0 || k >= t.time.size() || t.piece[k] != t.piece[k - 1]) return std::nullopt;
  const double part = to_seconds(at - t.time[k - 1]) / to_seconds(t.time[k] - t.time[k - 1]);
  return std::pair{Eigen::Vector3d(t.way[k - 1] + part * (t.way[k] - t.way[k - 1])), t.piece[k]};
}

Track horizontal_track(const Flight& flight) {
  Track track;
  if (!flight.local_position.empty() && flight.local_position.size() >= flight.position.size())
    return {flight.local_position.time, flight.local_position.value};
  if (flight.position.empty()) return track;
  const LocalFrame frame(flight.position.value.front(), 0);
  for (std::size_t i = 0; i < flight.position.size(); ++i) {
    const auto& point = flight.position.value[i];
    // A receiver slower than the log repeats itself.
    if (i > 0 && point.lat_deg == flight.position.value[i - 1].lat_deg &&
        point.lon_deg == flight.position.value[i - 1].lon_deg)
      continue;
    track.time.push_back(flight.position.time[i]);
    track.p.push_back(frame.to_ned(point, 0));
  }
  return track;
}

template <class H>
Track height_track(const Stream<H>& stream) {
  Track track;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    if (i > 0 && stream.value[i].m == stream.value[i - 1].m) continue;
    track.time.push_back(stream.time[i]);
    track.p.emplace_back(0, 0, -stream.value[i].m);
  }
  return track;
}

/// Positions and ways of one stretch, their means taken off.
struct Pairs {
  std::vector<Eigen::Vector3d> p, way;
  void centre() {
    Eigen::Vector3d mp = Eigen::Vector3d::Zero(), mw = mp;
    for (std::size_t i = 0; i < p.size(); ++i) mp += p[i], mw += way[i];
    for (auto& x : p) x -= mp / static_cast<double>(p.size());
    for (auto& x : way) x -= mw / static_cast<double>(way.size());
  }
};

std::vector<Pairs> stretches(const Track& track, const VelocityStream& velocity) {
  const auto ways = travelled(velocity);
  std::vector<Pairs> all;
  Pairs current;
  LogTime begin{};
  int piece = -1;
  const auto close = [&] {
    if (current.p.size() >= 5) current.centre(), all.push_back(std::move(current));
    current = {};
  };
  for (std::size_t i = 0; i < track.time.size(); ++i) {
    const auto way = way_at(ways, track.time[i]);
    if (!way || way->second != piece || to_seconds(track.time[i] - begin) > stretch) {
      close();
      if (!way) continue;
      begin = track.time[i], piece = way->second;
    }
    current.p.push_back(track.p[i]);
    current.way.push_back(way->first);
  }
  close();
  return all;
}

/// Most of the stretches' change is this [m].
double travel_rms(const std::vector<Pairs>& all, bool vertical) {
  double sum = 0, n = 0;
  for (const auto& pairs : all)
    for (const auto& w : pairs.way) sum += vertical ? w.z() * w.z() : w.head<2>().squaredNorm(), n += 1;
  return n > 0 ? std::sqrt(sum / n) : 0;
}

double track_rms(const std::vector<Pairs>& all) {
  double sum = 0, n = 0;
  for (const auto& pairs : all)
    for (const auto& p : pairs.p) sum += p.z() * p.z(), n += 1;
  return n > 0 ? std::sqrt(sum / n) : 0;
}

double distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm(); }
double distance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.coeffs() == b.coeffs() ? 0 : 2 * std::acos(std::min(1.0, std::abs(a.dot(b))));
}

/// The step that a stream's values are rounded to, or its usual change if they are not.
template <class T>
double usual_step(const Stream<T>& stream) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stream.size(); ++i)
    if (const double d = distance(stream.value[i], stream.value[i - 1]); d > 0) steps.push_back(d);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// @param leap  how far a value that was stuck is behind when it moves again
template <class T>
void find_frozen(const Stream<T>& stream, const char* label, LogTime origin, double longer_than, double leap,
                 std::vector<FrozenStretch>& out) {
  const double step = usual_step(stream);
  std::size_t first = 0;
  for (std::size_t i = 1; i <= stream.size(); ++i) {
    if (i < stream.size() && distance(stream.value[i], stream.value[first]) == 0) continue;
    const double from = to_seconds(stream.time[first] - origin), to = to_seconds(stream.time[i - 1] - origin);
    const bool ends = i == stream.size();
    const bool leaps = !ends && distance(stream.value[i], stream.value[first]) > std::max(leap, 5 * step);
    const bool never_moves_again = ends && to - from > 5 * longer_than && step < leap / 5;
    if (i - first > 3 && to - from > longer_than && (leaps || never_moves_again)) out.push_back({label, from, to});
    first = i;
  }
}

}  // namespace

std::optional<VelocityAgainstPosition> velocity_against_position(const Flight& flight) {
  if (flight.velocity.origin == VelocityOrigin::differentiated || flight.velocity.size() < 20) return std::nullopt;
  const auto all = stretches(horizontal_track(flight), flight.velocity);
  Matrix2d ww = Matrix2d::Zero(), pw = Matrix2d::Zero();
  for (const auto& pairs : all)
    for (std::size_t i = 0; i < pairs.p.size(); ++i) {
      const Vector2d w = pairs.way[i].head<2>(), p = pairs.p[i].head<2>();
      ww += w * w.transpose();
      pw += p * w.transpose();
    }
  if (all.size() < 2 || travel_rms(all, false) < 1 || ww.determinant() <= 1e-9 * ww.squaredNorm()) return std::nullopt;
  VelocityAgainstPosition out;
  out.map = pw * ww.inverse();
  double left = 0, n = 0;
  for (const auto& pairs : all)
    for (std::size_t i = 0; i < pairs.p.size(); ++i)
      left += (pairs.p[i].head<2>() - out.map * pairs.way[i].head<2>()).squaredNorm(), n += 1;
  // Errors of a position wander: four independent ones in a stretch.
  const double thinned = n / (4 * static_cast<double>(all.size()));
  const double weakest = ww.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
  out.sd = std::sqrt(left / n / 2 * std::max(1.0, thinned) / weakest);
  return out;
}

std::optional<VerticalAgainstHeight> vertical_against_height(const Flight& flight) {
  if (flight.velocity.origin == VelocityOrigin::differentiated || flight.velocity.size() < 20) return std::nullopt;
  Track track = height_track(flight.height_ground);
  if (track.time.size() < 20) track = height_track(flight.height_msl);
  if (track.time.size() < 20) track = height_track(flight.height_ellipsoid);
  if (track.time.size() < 20) track = {flight.local_position.time, flight.local_position.value};
  const auto all = stretches(track, flight.velocity);
  double ww = 0, pw = 0;
  for (const auto& pairs : all)
    for (std::size_t i = 0; i < pairs.p.size(); ++i)
      ww += pairs.way[i].z() * pairs.way[i].z(), pw += pairs.p[i].z() * pairs.way[i].z();
  VerticalAgainstHeight out;
  out.travel = travel_rms(all, true);
  // Both must move: a height that stands still while the velocity climbs is for the slope to tell.
  if (all.size() < 2 || ww <= 0 || std::max(out.travel, track_rms(all)) < 1 || out.travel < 0.3) return std::nullopt;
  out.slope = pw / ww;
  double left = 0, n = 0;
  for (const auto& pairs : all)
    for (std::size_t i = 0; i < pairs.p.size(); ++i)
      left += std::pow(pairs.p[i].z() - out.slope * pairs.way[i].z(), 2), n += 1;
  out.sd = std::sqrt(left / n * std::max(1.0, n / (4 * static_cast<double>(all.size()))) / ww);
  return out;
}

std::vector<FrozenStretch> frozen_stretches(const Flight& flight, double longer_than) {
  std::vector<FrozenStretch> all;
  if (flight.velocity.empty()) return all;
  find_frozen(flight.velocity, "velocity", flight.velocity.time.front(), longer_than, 0.3, all);
  find_frozen(flight.attitude, "attitude", flight.velocity.time.front(), longer_than, 0.02, all);
  return all;
}

double leading_zeros(const Flight& flight) {
  std::size_t i = 0;
  while (i < flight.velocity.size() && flight.velocity.value[i].isZero(0)) ++i;
  return i < 2 ? 0 : to_seconds(flight.velocity.time[i - 1] - flight.velocity.time.front());
}

}  // namespace quadsonde::ingest
