#pragma once
#include <Eigen/Core>

#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

/// NED axes at a point, on the WGS84 ellipsoid. Source: GeographicLib::LocalCartesian (round trip 2e-10 m).
class LocalFrame {
 public:
  LocalFrame(GeoPoint origin, double height_m);
  Eigen::Vector3d to_ned(GeoPoint point, double height_m) const;
  /// @return point, and height [m] in the datum of the constructor's height (exact for ellipsoid heights).
  std::pair<GeoPoint, double> from_ned(const Eigen::Vector3d& p_NB_N) const;

 private:
  GeoPoint origin_;
  double height_;
};

/// Length of the shortest way over the ellipsoid [m]. Source: GeographicLib::Geodesic (15 nm).
double distance_m(GeoPoint a, GeoPoint b);

/// Velocity where a log has none: centred differences of the position (and of the best height) over a window
/// [s], stated as VelocityOrigin::differentiated. Repeated positions (a receiver slower than the log) count once.
/// Empty if there are fewer than three positions.
VelocityStream differentiate_position(const Flight& flight, double window_s = 0.6);

}  // namespace quadsonde::ingest
