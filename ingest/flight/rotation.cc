#include "ingest/flight/rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadsonde::ingest {

Eigen::Quaterniond q_NB_from_euler(const EulerAngles& angles) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return Eigen::Quaterniond(AngleAxisd(angles.yaw, Vector3d::UnitZ()) * AngleAxisd(angles.pitch, Vector3d::UnitY()) *
                            AngleAxisd(angles.roll, Vector3d::UnitX()));
}

EulerAngles euler_from_q_NB(const Eigen::Quaterniond& q) {
  const double sin_pitch = std::clamp(2 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0);
  return {std::atan2(2 * (q.w() * q.x() + q.y() * q.z()), 1 - 2 * (q.x() * q.x() + q.y() * q.y())),
          std::asin(sin_pitch), heading(q)};
}

double heading(const Eigen::Quaterniond& q) {
  return std::atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
}

double wrap_angle(double a) {
  const double turn = 2 * std::numbers::pi;
  a = std::remainder(a, turn);
  return a <= -std::numbers::pi ? a + turn : a;
}

}  // namespace quadsonde::ingest
