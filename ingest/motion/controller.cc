#include "ingest/motion/controller.h"

#include <algorithm>
#include <cmath>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest {
namespace {

/// The attitude that has the thrust (against `down`, a unit vector) and the heading.
Eigen::Quaterniond attitude_towards(const Eigen::Vector3d& down, double heading) {
  const Eigen::Vector3d side = down.cross(Eigen::Vector3d(std::cos(heading), std::sin(heading), 0)).normalized();
  Eigen::Matrix3d R_NB;
  R_NB << side.cross(down), side, down;
  return Eigen::Quaterniond(R_NB);
}

Eigen::Vector2d within(Eigen::Vector2d v, double limit) {
  if (const double size = v.norm(); size > limit) v *= limit / size;
  return v;
}

}  // namespace

RigidController::RigidController(const RigidVehicle& vehicle, const RigidTrim& hover, double outer_step,
                                 double inner_step, const ControllerGains& gains)
    : vehicle_(vehicle), gains_(gains), outer_step_(outer_step), inner_step_(inner_step) {
  const double speed2 = hover.state.speed.squaredNorm();
  thrust_per_speed2_ = vehicle.mass * standard_gravity / speed2;
  const RotorLoad load =
      rotor_load(vehicle.rotor, hover.state.speed(0), Eigen::Vector3d::Zero(), sea_level_air_density, 1);
  torque_per_speed2_ = load.torque / (hover.state.speed(0) * hover.state.speed(0));
  thrust_ = vehicle.mass * standard_gravity;
}

void RigidController::settle(const RigidTrim& trim, double heading) {
  const Eigen::Vector3d thrust_N = trim.state.q_NB * Eigen::Vector3d(0, 0, -1);
  acceleration_integral_.head<2>() = -thrust_N.head<2>() / thrust_N.z() * standard_gravity;
  thrust_ = thrust_per_speed2_ * trim.state.speed.squaredNorm();
  // Lift as asked for is thrust in calm air: what a moving rotor gives more or less is the integral's.
  acceleration_integral_.z() = standard_gravity + thrust_ * thrust_N.z() / vehicle_.mass;
  wanted_ = trim.state.q_NB;
  last_heading_ = heading;
  has_heading_ = true;
  moment_integral_.setZero();
}

void RigidController::forget() {
  acceleration_integral_.setZero();
  moment_integral_.setZero();
}

void RigidController::steer(const Wish& wish, const Eigen::Vector3d& p, const Eigen::Vector3d& v, double tilt_cosine) {
  const Eigen::Vector3d off = wish.position - p;
  Eigen::Vector3d aim = wish.velocity;
  aim.head<2>() += within(gains_.position * off.head<2>(), gains_.most_position_speed);
  aim.z() += std::clamp(gains_.height * off.z(), -gains_.most_position_speed, gains_.most_position_speed);
  const Eigen::Vector3d error = aim - v;
  const Eigen::Vector3d gain(gains_.velocity, gains_.velocity, gains_.climb);
  const Eigen::Vector3d asked = gain.cwiseProduct(error) + acceleration_integral_;
  Eigen::Vector3d a = asked;
  a.head<2>() = within(asked.head<2>(), gains_.most_horizontal);
  a.z() = std::clamp(asked.z(), -gains_.most_vertical, gains_.most_vertical);
  // While an axis is at its limit its integral waits.
  if (a.head<2>() == asked.head<2>())
    acceleration_integral_.head<2>() += gains_.velocity_integral * error.head<2>() * outer_step_;
  if (a.z() == asked.z()) acceleration_integral_.z() += gains_.climb_integral * error.z() * outer_step_;

  // Lean as in level flight whatever the vertical acceleration: the tilt then does not follow every correction of
  // height.
  wanted_ = attitude_towards(Eigen::Vector3d(-a.x(), -a.y(), standard_gravity).normalized(), wish.heading);
  thrust_ = vehicle_.mass * (standard_gravity - a.z()) / std::max(tilt_cosine, 0.6);
  const double turn = has_heading_ ? wrap_angle(wish.heading - last_heading_) / outer_step_ : 0;
  heading_rate_ = std::clamp(turn, -gains_.most_yaw_rate, gains_.most_yaw_rate);
  last_heading_ = wish.heading;
  has_heading_ = true;
}

PerRotor RigidController::motors(const Eigen::Quaterniond& q_NB, const Eigen::Vector3d& rate) {
  Eigen::Quaterniond off = q_NB.inverse() * wanted_;
  if (off.w() < 0) off.coeffs() *= -1;
  Eigen::Vector3d aim = 2 * Eigen::Vector3d(gains_.tilt, gains_.tilt, gains_.yaw).cwiseProduct(off.vec());
  aim += heading_rate_ * (q_NB.inverse() * Eigen::Vector3d::UnitZ());
  aim.x() = std::clamp(aim.x(), -gains_.most_rate, gains_.most_rate);
  aim.y() = std::clamp(aim.y(), -gains_.most_rate, gains_.most_rate);
  aim.z() = std::clamp(aim.z(), -gains_.most_yaw_rate, gains_.most_yaw_rate);
  const Eigen::Vector3d error = aim - rate;
  moment_integral_ += gains_.rate_integral * error * inner_step_;
  moment_integral_ = moment_integral_.cwiseMax(-5).cwiseMin(5);  // [rad/s2]
  const Eigen::Vector3d gain(gains_.rate, gains_.rate, gains_.yaw_rate);
  const Eigen::Vector3d moment = vehicle_.inertia.cwiseProduct(gain.cwiseProduct(error) + moment_integral_) +
                                 rate.cross(vehicle_.inertia.cwiseProduct(rate).eval());
  return allot(thrust_, moment);
}

/// Thrust and tilting moments first; yaw gets what room is left at every rotor.
PerRotor RigidController::allot(double thrust, const Eigen::Vector3d& moment) const {
  const int n = vehicle_.rotors;
  const double low = vehicle_.least_speed * vehicle_.least_speed, high = vehicle_.most_speed * vehicle_.most_speed;
  // Rotors stand evenly on a circle: the sums of x^2 and of y^2 are both n arm^2 / 2.
  const double per_moment = 2 / (n * vehicle_.arm * vehicle_.arm * thrust_per_speed2_);
  const double yaw = moment.z() / (n * torque_per_speed2_);
  PerRotor speed2 = PerRotor::Zero();
  double room = 1;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d hub = vehicle_.hub(i);
    speed2(i) = std::clamp(
        thrust / (n * thrust_per_speed2_) + per_moment * (moment.y() * hub.x() - moment.x() * hub.y()), low, high);
    const double wanted = -RigidVehicle::spin(i) * yaw;
    if (wanted > 0) room = std::min(room, (high - speed2(i)) / wanted);
    if (wanted < 0) room = std::min(room, (low - speed2(i)) / wanted);
  }
  PerRotor speed = PerRotor::Zero();
  for (int i = 0; i < n; ++i)
    speed(i) = std::sqrt(std::clamp(speed2(i) - RigidVehicle::spin(i) * yaw * std::max(room, 0.0), low, high));
  return speed;
}

}  // namespace quadsonde::ingest
