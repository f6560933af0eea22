#include "ingest/motion/rigid_body.h"

#include <cmath>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest {
namespace {

// p, v, quaternion (w, x, y, z), turn rate, rotor speeds.
using StateVector = Eigen::Matrix<double, 13 + most_rotors, 1>;

StateVector packed(const RigidState& s) {
  StateVector x;
  x << s.p, s.v, s.q_NB.w(), s.q_NB.vec(), s.omega_B, s.speed;
  return x;
}

RigidState unpacked(const StateVector& x) {
  RigidState s;
  s.p = x.segment<3>(0);
  s.v = x.segment<3>(3);
  s.q_NB = Eigen::Quaterniond(x(6), x(7), x(8), x(9)).normalized();
  s.omega_B = x.segment<3>(10);
  s.speed = x.tail<most_rotors>();
  return s;
}

StateVector derivative(const RigidVehicle& vehicle, const StateVector& x, const PerRotor& command,
                       const Eigen::Vector3d& wind, double rho) {
  const RigidState s = unpacked(x);
  const Eigen::Matrix3d R_NB = s.q_NB.toRotationMatrix();
  const auto loads = rigid_loads(vehicle, R_NB.transpose() * (s.v - wind), s.omega_B, s.speed, rho);
  const PerRotor speed_rate = (command - s.speed) / vehicle.motor_lag;
  double shaft = 0;  // a rotor that is sped up pushes the body the other way
  for (int i = 0; i < vehicle.rotors; ++i) shaft += RigidVehicle::spin(i) * vehicle.rotor.inertia * speed_rate(i);
  const Eigen::Vector3d moment = loads.moment_B - shaft * Eigen::Vector3d::UnitZ() -
                                 s.omega_B.cross(vehicle.inertia.cwiseProduct(s.omega_B).eval());
  const Eigen::Quaterniond turn = s.q_NB * Eigen::Quaterniond(0, s.omega_B.x(), s.omega_B.y(), s.omega_B.z());
  StateVector rate;
  rate << s.v, R_NB * loads.force_B / vehicle.mass + Eigen::Vector3d(0, 0, standard_gravity), 0.5 * turn.w(),
      0.5 * turn.vec(), moment.cwiseQuotient(vehicle.inertia), speed_rate;
  return rate;
}

/// Collective, roll, pitch and yaw as rotor speeds.
PerRotor mixed(const RigidVehicle& vehicle, double speed, const Eigen::Vector3d& split) {
  PerRotor speeds = PerRotor::Zero();
  for (int i = 0; i < vehicle.rotors; ++i) {
    const Eigen::Vector3d hub = vehicle.hub(i) / vehicle.arm;
    speeds(i) = speed * (1 - split.x() * hub.y() + split.y() * hub.x() - split.z() * RigidVehicle::spin(i));
  }
  return speeds;
}

/// roll, pitch, ln of the collective speed, three splits.
using TrimVector = Eigen::Matrix<double, 6, 1>;

RigidState at(const RigidVehicle& vehicle, const Eigen::Vector3d& v_AB_N, double heading, const TrimVector& x) {
  RigidState s;
  s.v = v_AB_N;
  s.q_NB = q_NB_from_euler({x(0), x(1), heading});
  s.speed = mixed(vehicle, std::exp(x(2)), x.tail<3>());
  return s;
}

/// Unbalanced force over weight and moment over weight times arm.
TrimVector imbalance(const RigidVehicle& vehicle, const RigidState& s, double rho) {
  const auto loads = rigid_loads(vehicle, s.q_NB.inverse() * s.v, s.omega_B, s.speed, rho);
  const double weight = vehicle.mass * standard_gravity;
  TrimVector f;
  f << (s.q_NB * loads.force_B + Eigen::Vector3d(0, 0, weight)) / weight, loads.moment_B / (weight * vehicle.arm);
  return f;
}

/// Ideal rotors at weight: where Newton starts.
double first_speed(const RigidVehicle& vehicle, double rho) {
  const auto load = rotor_load(vehicle.rotor, 1000, Eigen::Vector3d::Zero(), rho, 1);
  return 1000 * std::sqrt(vehicle.mass * standard_gravity / (vehicle.rotors * std::max(load.thrust, 1e-9)));
}

}  // namespace

Eigen::Vector3d RigidVehicle::hub(int i) const {
  const double angle = std::numbers::pi / rotors * (1 + 2 * i);
  return {arm * std::cos(angle), arm * std::sin(angle), -rotor_height};
}

RigidLoads rigid_loads(const RigidVehicle& vehicle, const Eigen::Vector3d& air_B, const Eigen::Vector3d& omega_B,
                       const PerRotor& speed, double rho) {
  RigidLoads loads;
  for (int i = 0; i < vehicle.rotors; ++i) {
    const Eigen::Vector3d hub = vehicle.hub(i), air = air_B + omega_B.cross(hub);
    const int spin = RigidVehicle::spin(i);
    const RotorLoad rotor = rotor_load(vehicle.rotor, std::max(speed(i), 1.0), air, rho, spin);
    const Eigen::Vector3d through = air - rotor.induced * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d force = rotor.force - 0.5 * rho * vehicle.wash_area * through.norm() * through;
    loads.force_B += force;
    loads.moment_B += hub.cross(force) - spin * rotor.torque * Eigen::Vector3d::UnitZ() -
                      omega_B.cross(Eigen::Vector3d(0, 0, spin * vehicle.rotor.inertia * speed(i)));
    loads.thrust += rotor.thrust;
    loads.induced += rotor.induced / vehicle.rotors;
    loads.inflow += (rotor.induced - air.z()) / vehicle.rotors;
  }
  loads.force_B -= 0.5 * rho * air_B.norm() * vehicle.body_area.cwiseProduct(air_B);
  return loads;
}

void advance(const RigidVehicle& vehicle, RigidState& state, const PerRotor& command, const Eigen::Vector3d& v_NA_N,
             double rho, double step) {
  const StateVector x = packed(state);
  const StateVector k1 = derivative(vehicle, x, command, v_NA_N, rho);
  const StateVector k2 = derivative(vehicle, x + step / 2 * k1, command, v_NA_N, rho);
  const StateVector k3 = derivative(vehicle, x + step / 2 * k2, command, v_NA_N, rho);
  const StateVector k4 = derivative(vehicle, x + step * k3, command, v_NA_N, rho);
  state = unpacked(x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4));
}

Eigen::Vector3d specific_force_N(const RigidVehicle& vehicle, const RigidState& s, const Eigen::Vector3d& v_NA_N,
                                 double rho) {
  const auto loads = rigid_loads(vehicle, s.q_NB.inverse() * (s.v - v_NA_N), s.omega_B, s.speed, rho);
  return s.q_NB * loads.force_B / vehicle.mass;
}

std::optional<RigidTrim> trim(const RigidVehicle& vehicle, const Eigen::Vector3d& v_AB_N, double heading, double rho) {
  TrimVector x = TrimVector::Zero();
  x(2) = std::log(first_speed(vehicle, rho));
  bool balanced = false;
  for (int i = 0; i < 50 && !balanced; ++i) {
    const TrimVector f = imbalance(vehicle, at(vehicle, v_AB_N, heading, x), rho);
    if (!f.allFinite()) return std::nullopt;
    balanced = f.norm() < 1e-11;
    Eigen::Matrix<double, 6, 6> J;
    for (int j = 0; j < 6; ++j) {
      constexpr double h = 1e-5;
      TrimVector up = x, down = x;
      up(j) += h, down(j) -= h;
      J.col(j) = (imbalance(vehicle, at(vehicle, v_AB_N, heading, up), rho) -
                  imbalance(vehicle, at(vehicle, v_AB_N, heading, down), rho)) /
                 (2 * h);
    }
    TrimVector move = -J.partialPivLu().solve(f);
    // No more than 0.2 rad or a fifth of the speed at once: the tilt of fast flight is far from the start.
    if (const double size = move.lpNorm<Eigen::Infinity>(); size > 0.2) move *= 0.2 / size;
    x += move;
  }
  RigidTrim out{at(vehicle, v_AB_N, heading, x), {}};
  const auto speeds = out.state.speed.head(vehicle.rotors).array();
  if (!balanced || (speeds < vehicle.least_speed).any() || (speeds > vehicle.most_speed).any()) return std::nullopt;
  out.loads = rigid_loads(vehicle, out.state.q_NB.inverse() * v_AB_N, out.state.omega_B, out.state.speed, rho);
  return out;
}

}  // namespace quadsonde::ingest
