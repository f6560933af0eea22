#pragma once
// Frames: N north-east-down at the take-off point, B body forward-right-down, A the air, E Earth-fixed.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace quadsonde::ingest {

/// Roll, pitch, yaw [rad], rotation order yaw, pitch, roll (Tait-Bryan z-y'-x''), right-handed about FRD axes.
struct EulerAngles {
  double roll = 0, pitch = 0, yaw = 0;
};

/// Body to NED.
Eigen::Quaterniond q_NB_from_euler(const EulerAngles& angles);
EulerAngles euler_from_q_NB(const Eigen::Quaterniond& q_NB);
/// Heading of the body x axis, clockwise from north [rad], -pi < psi <= pi.
double heading(const Eigen::Quaterniond& q_NB);
/// Wraps an angle [rad] to -pi < a <= pi.
double wrap_angle(double a);

}  // namespace quadsonde::ingest
