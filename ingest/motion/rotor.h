#pragma once
// One rotor: blade elements for thrust, torque and in-plane force, momentum for the air drawn through it, and the tilt
// of the thrust by flapping.
#include <Eigen/Core>

namespace quadsonde::ingest {

/// A rotor with rectangular blades of linear twist; rigid but for a share of the free flapping.
///
/// The defaults are a three-bladed five-inch propeller. Where they come from: diameter of the published vehicle
/// (0.13 m); chord 14 mm and 22 degrees at the 75 % radius as such propellers measure (5 x 4.5 in: the geometric pitch
/// there is atan(4.5 / (2 pi 0.75 2.5)) = 21 degrees); lift slope 5 per rad and profile drag 0.03 are those of thin
/// cambered blades at Reynolds numbers of 1e5; induced factor 1.15 of helicopters, Leishman (2006), section 2.5.
/// Stiff blades follow only a part of the free flapping; that part is not known for the published vehicle and is set,
/// with the area in the wash (rigid_body.h), so that the whole vehicle's drag is the published one.
struct RotorModel {
  double diameter = 0.13;  ///< [m]
  int blades = 3;
  double chord = 0.014;   ///< [m]
  double pitch = 0.30;    ///< at 75 % of the radius [rad], from the zero-lift direction
  double twist = -0.25;   ///< per radius [rad]
  double lift_slope = 5;  ///< per rad
  double profile_drag = 0.03;
  double induced_factor = 1.15;  ///< induced velocity over that of momentum theory
  double flapping_share = 0.5;   ///< of the tilt of a freely hinged blade
  double coning = 0.02;          ///< [rad]
  double inertia = 6e-6;         ///< of rotor and motor bell about the shaft [kg m2]

  double radius() const { return diameter / 2; }
  double area() const;
  double solidity() const;
};

/// What a rotor does to its hub.
struct RotorLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< in B, shaft along -z [N]
  double torque = 0;                                ///< that the motor must give [N m], positive
  double thrust = 0;                                ///< along the shaft [N]
  double induced = 0;                               ///< velocity that the rotor adds to the air, downward [m/s]
};

/// Thrust by blade elements, C_T = (sigma a / 2) (pitch (1 + 3/2 mu^2) / 3 - twist mu^2 / 8 - lambda / 2), with the
/// inflow lambda = lambda_c + v_i by Glauert's momentum theory, v_i = k C_T / (2 sqrt(mu^2 + lambda^2)): thrust falls
/// as the rotor climbs through the air. In descent momentum theory fails: v_i is scaled by the ratio of Leishman's fit
/// to measured induced velocities (2006, equation 2.97, 0 to -2 hover velocities) to that of momentum theory, faded out
/// with forward speed; unsteadiness of the vortex ring and the windmill state are left out.
/// In the plane, against the motion: H = (sigma pi rho R^3 / 4) Omega V (C_d0 + a lambda mean pitch), so proportional
/// to rotor speed and airspeed, and thrust times share of a1 = mu (8/3 pitch - 2 lambda) / (1 - mu^2 / 2). Across:
/// thrust times share of b1 = (4/3 mu coning + K lambda_i) / (1 + mu^2 / 2), K of Coleman, toward the advancing blade.
/// Source: Leishman, Principles of Helicopter Aerodynamics (2006), 2.14, 3.5, 4.5; Bramwell's Helicopter Dynamics
/// (2001), chapter 3. Angles of attack are taken as small, inflow as uniform over the disc.
/// @param omega  [rad/s], above 0
/// @param air_B  velocity of the hub through the air, in B [m/s]
/// @param rho    air density [kg/m3]
/// @param spin   +1: clockwise from above, -1: the other way
RotorLoad rotor_load(const RotorModel& rotor, double omega, const Eigen::Vector3d& air_B, double rho, int spin);

/// Leishman's fit over momentum theory: v_i at a climb of x hover velocities. 1 for x >= 0; held below -2.
double descent_factor(double x);

}  // namespace quadsonde::ingest
