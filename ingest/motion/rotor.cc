#include "ingest/motion/rotor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadsonde::ingest {
namespace {

/// Non-dimensional: C_T over inflow, linear.
struct ThrustLine {
  double at_rest = 0, slope = 0;  // C_T = at_rest - slope lambda
  double operator()(double lambda) const { return at_rest - slope * lambda; }
};

ThrustLine thrust_line(const RotorModel& r, double mu) {
  const double half = r.solidity() * r.lift_slope / 2;
  return {half * (r.pitch * (1 + 1.5 * mu * mu) / 3 - r.twist * mu * mu / 8), half / 2};
}

/// Hover: lambda^2 = k C_T / 2, a quadratic.
double hover_inflow(const RotorModel& r) {
  const ThrustLine line = thrust_line(r, 0);
  const double b = r.induced_factor * line.slope / 2, c = r.induced_factor * line.at_rest / 2;
  return (-b + std::sqrt(b * b + 4 * c)) / 2;
}

/// Zero of lambda - lambda_c - k C_T / (2 sqrt(mu^2 + lambda^2)), which rises with lambda: Newton inside a bracket.
double solve_inflow(const ThrustLine& line, double k, double mu, double lambda_c, double start) {
  double low = 0, high = std::max(1.0, 2 * std::abs(lambda_c)), lambda = std::clamp(start, 1e-6, high);
  for (int i = 0; i < 60; ++i) {
    const double root = std::sqrt(mu * mu + lambda * lambda);
    const double c_t = line(lambda);
    const double g = lambda - lambda_c - k * c_t / (2 * root);
    (g > 0 ? high : low) = lambda;
    const double slope = 1 + k * line.slope / (2 * root) + k * c_t * lambda / (2 * root * root * root);
    double next = lambda - g / slope;
    if (!(next > low && next < high)) next = (low + high) / 2;
    const bool near = std::abs(next - lambda) < 1e-13;
    lambda = next;
    if (near) break;
  }
  return lambda;
}

}  // namespace

double RotorModel::area() const { return std::numbers::pi * radius() * radius(); }
double RotorModel::solidity() const { return blades * chord / (std::numbers::pi * radius()); }

double descent_factor(double x) {
  if (x >= 0) return 1;
  x = std::max(x, -2.0);
  const double measured = 1 + x * (-1.125 + x * (-1.372 + x * (-1.718 - 0.655 * x)));
  return measured / (-x / 2 + std::sqrt(x * x / 4 + 1));
}

RotorLoad rotor_load(const RotorModel& r, double omega, const Eigen::Vector3d& air_B, double rho, int spin) {
  const double tip = omega * r.radius(), V = air_B.head<2>().norm();
  const double mu = V / tip, lambda_c = -air_B.z() / tip;
  const double hover = hover_inflow(r);
  const double faded = 1 + (descent_factor(lambda_c / hover) - 1) * std::exp(-std::pow(mu / hover, 2));
  const ThrustLine line = thrust_line(r, mu);
  const double lambda = solve_inflow(line, r.induced_factor * faded, mu, lambda_c, std::max(hover, hover + lambda_c));
  const double c_t = line(lambda), lambda_i = lambda - lambda_c;

  RotorLoad load;
  load.thrust = rho * r.area() * tip * tip * c_t;
  load.induced = lambda_i * tip;
  const double c_q = lambda * c_t + r.solidity() * r.profile_drag / 8 * (1 + 4.65 * mu * mu);
  load.torque = rho * r.area() * r.radius() * tip * tip * std::max(c_q, 0.0);
  load.force.z() = -load.thrust;
  if (V < 1e-9) return load;

  const double mean_pitch = r.pitch - r.twist / 4;
  const double H = r.solidity() * std::numbers::pi * rho * std::pow(r.radius(), 3) / 4 * omega * V *
                   (r.profile_drag + r.lift_slope * lambda * mean_pitch);
  const double a1 = mu * (8.0 / 3 * r.pitch - 2 * lambda) / (1 - mu * mu / 2);
  const double skew = std::atan2(mu, lambda);
  const double b1 = (4.0 / 3 * mu * r.coning + std::tan(skew / 2) * lambda_i) / (1 + mu * mu / 2);
  const Eigen::Vector3d ahead(air_B.x() / V, air_B.y() / V, 0);
  // Seen from above a clockwise rotor's blade advances on the left of the way.
  const Eigen::Vector3d advancing = spin * ahead.cross(Eigen::Vector3d::UnitZ());
  load.force += -(H + r.flapping_share * a1 * load.thrust) * ahead + r.flapping_share * b1 * load.thrust * advancing;
  return load;
}

}  // namespace quadsonde::ingest
