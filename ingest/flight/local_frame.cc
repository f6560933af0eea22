#include "ingest/flight/local_frame.h"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include <cmath>
#include <vector>

namespace quadsonde::ingest {

LocalFrame::LocalFrame(GeoPoint origin, double height_m) : origin_(origin), height_(height_m) {}

Eigen::Vector3d LocalFrame::to_ned(GeoPoint point, double height_m) const {
  const GeographicLib::LocalCartesian frame(origin_.lat_deg, origin_.lon_deg, height_);
  double east = 0, north = 0, up = 0;
  frame.Forward(point.lat_deg, point.lon_deg, height_m, east, north, up);
  return {north, east, -up};
}

std::pair<GeoPoint, double> LocalFrame::from_ned(const Eigen::Vector3d& p) const {
  const GeographicLib::LocalCartesian frame(origin_.lat_deg, origin_.lon_deg, height_);
  GeoPoint point;
  double height = 0;
  frame.Reverse(p.y(), p.x(), -p.z(), point.lat_deg, point.lon_deg, height);
  return {point, height};
}

double distance_m(GeoPoint a, GeoPoint b) {
  double length = 0;
  GeographicLib::Geodesic::WGS84().Inverse(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg, length);
  return length;
}

namespace {

struct HeightColumn {
  const std::vector<LogTime>* time = nullptr;
  std::vector<double> up;
};

/// The finest height there is; any datum will do, since only differences are used.
HeightColumn best_height(const Flight& flight) {
  HeightColumn best;
  const auto consider = [&](const auto& stream) {
    if (best.time && stream.size() <= best.time->size()) return;
    best.time = &stream.time;
    best.up.clear();
    for (const auto& h : stream.value) best.up.push_back(h.m);
  };
  consider(flight.height_ellipsoid);
  consider(flight.height_msl);
  consider(flight.height_ground);
  if (best.time && best.time->empty()) best.time = nullptr;
  return best;
}

double interpolate(const HeightColumn& column, LogTime t) {
  const auto& time = *column.time;
  const auto after = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
  if (after == 0) return column.up.front();
  if (after == time.size()) return column.up.back();
  const double span = to_seconds(time[after] - time[after - 1]);
  const double part = span > 0 ? to_seconds(t - time[after - 1]) / span : 0;
  return column.up[after - 1] + part * (column.up[after] - column.up[after - 1]);
}

struct PlacedColumn {
  std::vector<LogTime> time;
  std::vector<Eigen::Vector3d> p_NB_N;
};

PlacedColumn placed(const Flight& flight) {
  PlacedColumn column;
  if (!flight.local_position.empty() && flight.local_position.size() >= flight.position.size())
    return {flight.local_position.time, flight.local_position.value};
  if (flight.position.empty()) return column;
  const auto height = best_height(flight);
  const double height0 = height.time ? height.up.front() : 0;
  const LocalFrame frame(flight.position.value.front(), height0);
  const GeoPoint* before = nullptr;
  for (std::size_t i = 0; i < flight.position.size(); ++i) {
    const auto& point = flight.position.value[i];
    if (before && before->lat_deg == point.lat_deg && before->lon_deg == point.lon_deg && i + 1 < flight.position.size())
      continue;
    before = &point;
    const LogTime t = flight.position.time[i];
    column.time.push_back(t);
    column.p_NB_N.push_back(frame.to_ned(point, height.time ? interpolate(height, t) : height0));
  }
  return column;
}

/// Slope of a straight line through the points within half a window of point i.
std::optional<Eigen::Vector3d> slope(const PlacedColumn& column, std::size_t i, double half_window) {
  double n = 0, st = 0, stt = 0;
  Eigen::Vector3d sp = Eigen::Vector3d::Zero(), stp = Eigen::Vector3d::Zero();
  const auto add = [&](std::size_t k) {
    const double t = to_seconds(column.time[k] - column.time[i]);
    if (std::abs(t) > half_window) return false;
    const Eigen::Vector3d p = column.p_NB_N[k] - column.p_NB_N[i];
    n += 1, st += t, stt += t * t, sp += p, stp += t * p;
    return true;
  };
  for (std::size_t k = i + 1; k-- > 0;)
    if (!add(k)) break;
  for (std::size_t k = i + 1; k < column.time.size(); ++k)
    if (!add(k)) break;
  const double spread = stt - st * st / std::max(n, 1.0);
  if (n < 3 || spread <= 0) return std::nullopt;
  return Eigen::Vector3d((stp - sp * (st / n)) / spread);
}

}  // namespace

VelocityStream differentiate_position(const Flight& flight, double window_s) {
  VelocityStream velocity;
  velocity.origin = VelocityOrigin::differentiated;
  velocity.source = "slope of the position";
  const auto column = placed(flight);
  if (column.time.size() < 3) return velocity;
  const double typical =
      to_seconds(column.time.back() - column.time.front()) / static_cast<double>(column.time.size() - 1);
  const double half_window = std::max(window_s / 2, 1.5 * typical);
  for (std::size_t i = 0; i < column.time.size(); ++i)
    if (const auto v = slope(column, i, half_window)) velocity.push(column.time[i], *v);
  return velocity;
}

}  // namespace quadsonde::ingest
