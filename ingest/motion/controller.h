#pragma once
// The rigid body's controller: position, velocity, attitude, turn rate, motors, each around the next. The heading is
// free of the track.
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "ingest/motion/path.h"
#include "ingest/motion/rigid_body.h"

namespace quadsonde::ingest {

/// Gains in the manner of a common autopilot. Position 0.95 and 1.0 1/s, velocity 1.8 and 4.0 1/s, its integral 0.4 and
/// 2.0 1/s2 (horizontal, vertical): PX4's defaults MPC_XY_P, MPC_Z_P, MPC_XY_VEL_P_ACC, MPC_Z_VEL_P_ACC and, for the
/// integrals, MPC_XY_VEL_I_ACC and MPC_Z_VEL_I_ACC. Attitude 6.5 (2.8 about the yaw axis) 1/s: MC_ROLL_P, MC_YAW_P.
/// Turn rate 20 (6 about the yaw axis) 1/s with an integral: some 55 degrees of phase in hand behind a motor lag of
/// 40 ms. Limits: horizontal acceleration 7 m/s2 (tilt 35 degrees), vertical 4 m/s2, turn rates 220 and 120 deg/s, rotor
/// speeds.
struct ControllerGains {
  double position = 0.95, height = 1.0;
  double velocity = 1.8, climb = 4.0, velocity_integral = 0.4, climb_integral = 2.0;
  double tilt = 6.5, yaw = 2.8;
  double rate = 20, yaw_rate = 6, rate_integral = 10;
  double most_horizontal = 7, most_vertical = 4;  ///< [m/s2]
  double most_position_speed = 5;                 ///< that the position loop may ask for [m/s]
  double most_rate = 3.8, most_yaw_rate = 2.1;    ///< [rad/s]
};

class RigidController {
 public:
  /// @param hover  trim in calm air, which tells thrust and torque per rotor speed
  RigidController(const RigidVehicle& vehicle, const RigidTrim& hover, double outer_step, double inner_step,
                  const ControllerGains& gains = {});

  /// Begins with what steady flight at this trim needs.
  void settle(const RigidTrim& trim, double heading);
  /// Begins anew: level, without any memory of a wind.
  void forget();

  /// Position and velocity loops; to be called at the outer step.
  /// @param p, v  as the navigation has them, NED      @param tilt_cosine  of the measured attitude
  void steer(const Wish& wish, const Eigen::Vector3d& p, const Eigen::Vector3d& v, double tilt_cosine);
  /// Attitude and rate loops; at the inner step. @return rotor speeds to aim at [rad/s]
  PerRotor motors(const Eigen::Quaterniond& q_NB_measured, const Eigen::Vector3d& rate_measured);

 private:
  PerRotor allot(double thrust, const Eigen::Vector3d& moment) const;

  RigidVehicle vehicle_;
  ControllerGains gains_;
  double outer_step_, inner_step_;
  double thrust_per_speed2_, torque_per_speed2_;
  Eigen::Vector3d acceleration_integral_ = Eigen::Vector3d::Zero(), moment_integral_ = Eigen::Vector3d::Zero();
  double thrust_ = 0;  // [N]
  Eigen::Quaterniond wanted_ = Eigen::Quaterniond::Identity();
  double last_heading_ = 0, heading_rate_ = 0;
  bool has_heading_ = false;
};

}  // namespace quadsonde::ingest
