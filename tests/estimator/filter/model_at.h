#pragma once
// Models, states and inputs at attitudes aligned with no axis, and the continuous equations of estimator/MODEL.md
// section 3 written down a second time.
#include <Eigen/Core>
#include <cmath>

#include "estimator/filter/wind_model.h"

namespace quadsonde::estimator {

template <class S = double>
WindModel<S> linear_model() {
  WindModel<S> m;
  m.drag = {S(0.257), S(0), S(0.03), S(0.002)};
  return m;
}
inline WindModel<double> quadratic_model() {
  WindModel<double> m;
  m.drag = {0.2, 0.02, 0.03, 0.002};
  return m;
}

inline StepInput<double> oblique_input(double v_down, double step = 0.1) {
  StepInput<double> in;
  in.slope = {0.13, -0.08};
  in.slope_rate = {-0.05, 0.11};
  in.lift = 9.6;
  in.v_down = v_down;
  in.heading = 0.71;
  in.step = step;
  return in;
}
inline State<double> oblique_state() {
  State<double> x;
  x << 1.3, -0.7, -2.1, 3.3, 0.4, -0.2, 0.15, -0.32;
  return x;
}

inline Eigen::Matrix2d turn(double psi) {
  return Eigen::Matrix2d{{std::cos(psi), -std::sin(psi)}, {std::sin(psi), std::cos(psi)}};
}

/// vdot of the state's v: what the discretisation has to reproduce. Nothing frozen, nothing linearised.
inline Eigen::Vector2d acceleration(const WindModel<double>& m, const State<double>& x, const StepInput<double>& in) {
  const Eigen::Vector2d a_h = x.segment<2>(i_v) - x.segment<2>(i_W) - x.segment<2>(i_u);
  const double airspeed = std::sqrt(a_h.squaredNorm() + in.v_down * in.v_down);
  const double c = ingest::drag_coefficient(m.drag, airspeed, -in.v_down);
  return in.slope * (in.lift - c * in.v_down) + turn(in.heading) * x.segment<2>(i_b) - c * a_h;
}

/// The same state with W such that nothing accelerates: a_h from g s = c (a_h + s v_d) by fixed-point steps; u is zero.
inline State<double> in_balance(const WindModel<double>& m, State<double> x, const StepInput<double>& in) {
  x.segment<2>(i_u).setZero();
  for (int i = 0; i < 200; ++i) x.segment<2>(i_W) -= acceleration(m, x, in) / 0.5;
  return x;
}

}  // namespace quadsonde::estimator
