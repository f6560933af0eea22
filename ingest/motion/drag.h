#pragma once
// The in-plane drag law, once for the filters, the calibration, the integrator and the simulator.
// Headers and Eigen only: it flies on board too.
// Source: design notes, equation (1) and the climb law; derivation in estimator/MODEL.md, sections 1 and 2.
#include <Eigen/Core>
#include <cmath>

namespace quadsonde::ingest {

inline constexpr double standard_gravity = 9.80665;       ///< [m/s2]
inline constexpr double sea_level_air_density = 1.225;    ///< [kg/m3], ISO 2533

/// Specific (per mass) drag in the rotor plane: acceleration = -c a_h with
/// c = (linear + quadratic |a|) exp(climb_linear v_c + climb_quadratic v_c^2),
/// a the airspeed vector, |a| with its vertical part, v_c the climb rate through the air, up positive.
template <class Scalar>
struct DragLaw {
  Scalar linear = Scalar(0);           ///< delta [1/s]
  Scalar quadratic = Scalar(0);        ///< kappa [1/m]
  Scalar climb_linear = Scalar(0);     ///< alpha [s/m]
  Scalar climb_quadratic = Scalar(0);  ///< g2 [s2/m2]
};

/// What the climb does to the drag.
template <class Scalar>
struct ClimbFactor {
  Scalar value = Scalar(1);
  bool clipped = false;  ///< the exponent met its bounds; its derivatives are zero there
};

/// The exponent is kept within ln 0.3 to ln 1.3: beyond that no recorded flight has been seen.
/// @param v_c  climb rate through the air [m/s], up positive
template <class Scalar>
ClimbFactor<Scalar> climb_factor(const DragLaw<Scalar>& law, Scalar v_c) {
  using std::exp;
  const Scalar exponent = law.climb_linear * v_c + law.climb_quadratic * v_c * v_c;
  const Scalar low(-1.2039728043259361), high(0.26236426446749106);
  if (exponent < low) return {Scalar(0.3), true};
  if (exponent > high) return {Scalar(1.3), true};
  return {exp(exponent), false};
}

/// c [1/s] at an airspeed [m/s] and a climb rate through the air [m/s].
template <class Scalar>
Scalar drag_coefficient(const DragLaw<Scalar>& law, Scalar airspeed, Scalar v_c) {
  return (law.linear + law.quadratic * airspeed) * climb_factor(law, v_c).value;
}

/// Slope of the thrust vector s = -n_h / n_d, from the body down axis n in N. s_N > 0: the thrust pulls north.
/// The caller has made sure that n_d > 0 (tilt below 90 degrees).
template <class Scalar>
Eigen::Matrix<Scalar, 2, 1> thrust_slope(const Eigen::Matrix<Scalar, 3, 1>& n_N) {
  return -n_N.template head<2>() / n_N.z();
}

/// Equation (1): horizontal acceleration [m/s2] of a point mass whose thrust stands normal to the rotor plane.
/// @param s      thrust slope, N and E
/// @param lift   g - vdot_d [m/s2]
/// @param a_N    airspeed vector v - w, NED [m/s]
/// @param b_NE   trim, already turned into N and E [m/s2]
template <class Scalar>
Eigen::Matrix<Scalar, 2, 1> horizontal_acceleration(const DragLaw<Scalar>& law, const Eigen::Matrix<Scalar, 2, 1>& s,
                                                    Scalar lift, const Eigen::Matrix<Scalar, 3, 1>& a_N,
                                                    const Eigen::Matrix<Scalar, 2, 1>& b_NE) {
  const Scalar c = drag_coefficient(law, Scalar(a_N.norm()), Scalar(-a_N.z()));
  return s * (lift - c * a_N.z()) - c * a_N.template head<2>() + b_NE;
}

/// The law at another air density and mass: rotor (H-force) drag at the thrust of weight is proportional to
/// sqrt(rho m) per airspeed, so per mass to (rho/rho0)^exponent (m0/m)^exponent with exponent 0.5; body drag to
/// (rho/rho0)(m0/m).
/// @param density_ratio  rho / rho0      @param mass_ratio  m / m0
template <class Scalar>
DragLaw<Scalar> scaled(DragLaw<Scalar> law, Scalar density_ratio, Scalar mass_ratio, Scalar density_exponent) {
  using std::pow, std::sqrt;
  law.linear *= pow(density_ratio, density_exponent) / sqrt(mass_ratio);
  law.quadratic *= density_ratio / mass_ratio;
  return law;
}

}  // namespace quadsonde::ingest
