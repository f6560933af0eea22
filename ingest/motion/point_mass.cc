#include "ingest/motion/point_mass.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace quadsonde::ingest {

Eigen::Vector3d PointMassController::acceleration(const Wish& wish, const Eigen::Vector3d& p,
                                                  const Eigen::Vector3d& v) {
  const Eigen::Vector3d aim = wish.velocity + 1.2 * (wish.position - p);
  const Eigen::Vector3d error = aim - v;
  integral_ += 0.5 * error.head<2>() * step_;
  Eigen::Vector3d a = 2.0 * error;
  a.head<2>() += integral_;
  constexpr double limit = 7;  // [m/s2]
  if (const double size = a.head<2>().norm(); size > limit) a.head<2>() *= limit / size;
  a.z() = std::clamp(a.z(), -3.0, 3.0);
  return a;
}

void advance(PointMass& body, const Eigen::Vector3d& wanted, const Eigen::Vector3d& v_NA_N, const DragLaw<double>& law,
             double step) {
  constexpr double tilt_lag = 0.15;  // [s]
  body.s += (wanted.head<2>() / standard_gravity - body.s) * (step / tilt_lag);
  const Eigen::Vector3d air = body.v - v_NA_N;
  const Eigen::Vector2d acc =
      horizontal_acceleration<double>(law, body.s, standard_gravity - wanted.z(), air, Eigen::Vector2d::Zero());
  body.vdot = {acc.x(), acc.y(), wanted.z()};
  body.p += body.v * step + 0.5 * body.vdot * step * step;
  body.v += body.vdot * step;
}

EulerAngles attitude_of(const Eigen::Vector2d& s, double yaw) {
  // n is along (-s, 1); in heading axes n = (sin theta cos phi, -sin phi, cos theta cos phi).
  const Eigen::Vector2d ahead = Eigen::Rotation2Dd(-yaw) * s;
  const Eigen::Vector3d n = Eigen::Vector3d(-ahead.x(), -ahead.y(), 1).normalized();
  return {std::asin(-n.y()), std::atan2(n.x(), n.z()), yaw};
}

}  // namespace quadsonde::ingest
