// The drag law that a rigid body shows to somebody who knows only that of a point mass.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ingest/motion/rigid_body.h"

namespace quadsonde::ingest {
namespace {

/// Mean of effective_drag() over the directions that the air may come from.
std::optional<double> mean_drag(const RigidVehicle& vehicle, double airspeed, double climb, double rho) {
  constexpr int directions = 8;
  double sum = 0;
  for (int i = 0; i < directions; ++i) {
    const auto c = effective_drag(vehicle, airspeed, climb, rho, 2 * std::numbers::pi * (i + 0.25) / directions);
    if (!c) return std::nullopt;
    sum += *c;
  }
  return sum / directions;
}

/// Root mean square of c - law over level flight at 1 to 10 m/s from all quarters [1/s].
double misfit(const RigidVehicle& vehicle, const DragLaw<double>& law, double rho) {
  double sum = 0;
  int count = 0;
  for (int airspeed = 1; airspeed <= 10; ++airspeed)
    for (int quarter = 0; quarter < 4; ++quarter)
      if (const auto c = effective_drag(vehicle, airspeed, 0, rho, std::numbers::pi / 4 * quarter)) {
        sum += std::pow(*c - drag_coefficient(law, static_cast<double>(airspeed), 0.0), 2);
        ++count;
      }
  return std::sqrt(sum / std::max(count, 1));
}

}  // namespace

std::optional<double> effective_drag(const RigidVehicle& vehicle, double airspeed, double climb, double rho,
                                     double from_ahead) {
  const auto steady = trim(vehicle, {airspeed, 0, -climb}, -from_ahead, rho);
  if (!steady) return std::nullopt;
  const Eigen::Vector2d air = (steady->state.q_NB.inverse() * steady->state.v).head<2>();
  return -steady->loads.force_B.head<2>().dot(air) / (vehicle.mass * air.squaredNorm());
}

std::optional<DragLaw<double>> equivalent_drag(const RigidVehicle& vehicle, double rho, double fastest) {
  constexpr int count = 20;
  Eigen::Matrix<double, count, 2> A;
  Eigen::Matrix<double, count, 1> c;
  for (int i = 0; i < count; ++i) {
    const double airspeed = 0.5 + (fastest - 0.5) * i / (count - 1);
    const auto seen = mean_drag(vehicle, airspeed, 0, rho);
    if (!seen) return std::nullopt;
    A.row(i) << 1, airspeed;
    c(i) = *seen;
  }
  const Eigen::Vector2d level = A.colPivHouseholderQr().solve(c);
  DragLaw<double> law{level.x(), level.y(), 0, 0};
  constexpr int climbs = 17;
  constexpr double airspeed = 4;
  Eigen::Matrix<double, climbs, 2> B;
  Eigen::Matrix<double, climbs, 1> change;
  const auto still = mean_drag(vehicle, airspeed, 0, rho);
  for (int i = 0; i < climbs; ++i) {
    const double climb = -3 + 0.5 * i;
    const auto seen = mean_drag(vehicle, airspeed, climb, rho);
    if (!seen || !still) return std::nullopt;
    // The law's own |a| holds the climb too.
    const double plain = drag_coefficient(law, std::hypot(airspeed, climb), 0.0) / drag_coefficient(law, airspeed, 0.0);
    B.row(i) << climb, climb * climb;
    change(i) = std::log(*seen / *still / plain);
  }
  const Eigen::Vector2d climb = B.colPivHouseholderQr().solve(change);
  law.climb_linear = climb.x();
  law.climb_quadratic = climb.y();
  return law;
}

Result<Vehicle> equivalent_vehicle(const RigidVehicle& rigid, double rho) {
  const auto law = equivalent_drag(rigid, rho);
  if (!law)
    return fail(Kind::usage, "this rigid body cannot hover, or cannot fly at 10 m/s", {},
                "give it less mass, or rotors that lift more: see max_rotor_rpm, rotor_diameter_m and pitch_deg");
  Vehicle v;
  v.id = "rigid-body";
  v.name = rigid.name;
  v.mass_kg = rigid.mass;
  v.rotors = rigid.rotors;
  v.rotor_diameter_m = rigid.rotor.diameter;
  v.drag = *law;
  v.between_flights_rel_sd = 0;
  v.air_density_kg_m3 = rho;
  v.airspeed_range_m_s = {0, 10};
  v.tilt_correlation_s = 0;
  v.method = "given";
  v.covariance(p_linear, p_linear) = std::pow(misfit(rigid, *law, rho), 2);
  v.covariance(p_trim_roll, p_trim_roll) = v.covariance(p_trim_pitch, p_trim_pitch) = 9;
  return v;
}

}  // namespace quadsonde::ingest
