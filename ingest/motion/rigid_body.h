#pragma once
// A multirotor as a rigid body with six degrees of freedom: rotors behind lagging motors, drag of the body and of what
// stands in the rotors' wash. Richer than the estimator's model, so that a test against it is no test against itself.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "ingest/motion/rotor.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::ingest {

inline constexpr int most_rotors = 8;
/// One value per rotor; those beyond the vehicle's number are zero.
using PerRotor = Eigen::Matrix<double, most_rotors, 1>;

/// The vehicle. Defaults: the published quadrotor, 0.896 kg, as a five-inch class airframe.
///
/// Where they come from: mass and rotor diameter are published. Arm 0.12 m (rotors 0.17 m apart along each side) and
/// inertia follow from that class: four motors of 35 g at the arms' ends and the rest in a box of 0.14 x 0.08 x 0.06 m.
/// Motor lag 40 ms as measured on small brushless motors. Body: 0.2 x 0.07 m seen from ahead and from the side, drag
/// coefficient near 1; twice that from above. The area in the wash is arms, motors and the part of the frame below the
/// discs; it makes the rotors carry a tenth more than the weight. It and the rotors' share of flapping are not known
/// for the published vehicle: they are set so that effective_drag() at 3 to 4 m/s is near the published 0.257 1/s. A
/// bare stiff rotor gives a quarter of that by theory; 0.54 and 0.39 1/s were found on a vehicle of that class
/// (Faessler, Franchi, Scaramuzza 2018), so the blades bend and the frame counts.
struct RigidVehicle {
  std::string name = "a rigid body like the published quadrotor";
  double mass = 0.896;                              ///< [kg]
  Eigen::Vector3d inertia{0.0040, 0.0045, 0.0075};  ///< about x, y, z of B [kg m2]
  int rotors = 4;                                   ///< 4, 6 or 8; in a circle, none straight ahead, spins alternate
  double arm = 0.12;                                ///< [m]
  double rotor_height = 0.02;                       ///< of the discs above the centre of mass [m]
  RotorModel rotor;
  double motor_lag = 0.04;                        ///< first order, of the speed [s]
  double least_speed = 300, most_speed = 2600;    ///< of a rotor [rad/s]
  Eigen::Vector3d body_area{0.014, 0.016, 0.03};  ///< drag coefficient times area, along x, y, z of B [m2]
  double wash_area = 0.0045;                      ///< the same, in the wash of each rotor [m2]

  Eigen::Vector3d hub(int rotor_index) const;  ///< in B, from the centre of mass [m]
  static int spin(int rotor_index) { return rotor_index % 2 == 0 ? 1 : -1; }
};

struct RigidState {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();  ///< NED [m], [m/s]
  Eigen::Quaterniond q_NB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< turn rate of B in N [rad/s]
  PerRotor speed = PerRotor::Zero();                  ///< of the rotors [rad/s]
};

/// What air and rotors do to the body, weight not among it.
struct RigidLoads {
  Eigen::Vector3d force_B = Eigen::Vector3d::Zero(), moment_B = Eigen::Vector3d::Zero();  ///< [N], [N m]
  double thrust = 0;   ///< of all rotors along the shafts [N]
  double inflow = 0;   ///< mean velocity of the air through the discs, downward [m/s]
  double induced = 0;  ///< the part of it that the rotors draw [m/s]
};

/// Rotors; F = -rho/2 area |u| u of what stands in each wash, u its velocity through the wash; F_i = -rho/2 area_i |a|
/// a_i of the body; reaction and gyroscopic moments of the rotors.
/// @param air_B  velocity of the centre of mass through the air, in B [m/s]
RigidLoads rigid_loads(const RigidVehicle& vehicle, const Eigen::Vector3d& air_B, const Eigen::Vector3d& omega_B,
                       const PerRotor& speed, double rho);

/// One step of the equations of motion by Runge and Kutta's fourth order, wind and commands held.
/// @param command  speeds that the motors aim at [rad/s]
/// @param v_NA_N   wind [m/s]
/// @param step     [s]; 2 ms keeps a 40 ms motor and a 6 rad/s attitude far inside the scheme's stability
void advance(const RigidVehicle& vehicle, RigidState& state, const PerRotor& command, const Eigen::Vector3d& v_NA_N,
             double rho, double step);

/// Specific force in N: acceleration without gravity [m/s2].
Eigen::Vector3d specific_force_N(const RigidVehicle& vehicle, const RigidState& state, const Eigen::Vector3d& v_NA_N,
                                 double rho);

/// Steady flight.
struct RigidTrim {
  RigidState state;  ///< at p = 0; v is the velocity through the air
  RigidLoads loads;
};

/// The attitude and rotor speeds at which nothing accelerates.
/// @param v_AB_N   velocity through the air [m/s], NED
/// @param heading  [rad]
/// @return empty if the vehicle cannot fly so: no balance, or a rotor beyond its limits
std::optional<RigidTrim> trim(const RigidVehicle& vehicle, const Eigen::Vector3d& v_AB_N, double heading, double rho);

/// In-plane drag per mass and in-plane airspeed c [1/s] of equation (1), as a wind tunnel would find it: specific force
/// in the rotor plane against the airspeed there, in trim.
/// @param airspeed      horizontal [m/s], above 0
/// @param climb         through the air [m/s], up positive
/// @param rho           air density [kg/m3]
/// @param from_ahead    where the air comes from, clockwise from the nose [rad]
/// @return empty as trim()
std::optional<double> effective_drag(const RigidVehicle& vehicle, double airspeed, double climb = 0,
                                     double rho = sea_level_air_density, double from_ahead = 0);

/// The law of drag.h closest to effective_drag() over all directions: linear and quadratic by least squares of c at
/// 0.5 m/s to `fastest` in level flight, the climb law from -3 to +5 m/s at 4 m/s. Empty if a trim is.
/// With the defaults it meets c within 5 % from any direction, 0.5 to 10 m/s; the two terms alone mean little.
std::optional<DragLaw<double>> equivalent_drag(const RigidVehicle& vehicle, double rho, double fastest = 10);

/// What an ideal calibration would write of this vehicle: equivalent_drag(), uncertain only by what a law of two terms
/// misses of it (root mean square over airspeeds and directions), trim not known.
/// Kind::usage if it cannot hover or fly at 10 m/s.
Result<Vehicle> equivalent_vehicle(const RigidVehicle& vehicle, double rho);

}  // namespace quadsonde::ingest
