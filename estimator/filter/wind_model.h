#pragma once
// One step of the wind model, discretised exactly. Fixed sizes, no allocation, Eigen only.
// Source: estimator/MODEL.md sections 3 to 5.
#include <Eigen/Core>
#include <cmath>

#include "ingest/motion/drag.h"

namespace quadsonde::estimator {

/// State x = [v(2), W(2), u(2), b(2)]: ground velocity [m/s], slow wind [m/s], turbulence [m/s] (all N, E), and the
/// trim [m/s2] in heading axes, to be added to the measured thrust acceleration. The wind is W + u.
template <class S>
using State = Eigen::Matrix<S, 8, 1>;
template <class S>
using StateMatrix = Eigen::Matrix<S, 8, 8>;
template <class S>
using Vector2 = Eigen::Matrix<S, 2, 1>;
template <class S>
using Matrix2 = Eigen::Matrix<S, 2, 2>;
enum StateIndex { i_v = 0, i_W = 2, i_u = 4, i_b = 6 };

/// Parameters that are not states; their errors are considered. The trim stands among them while the heading has not
/// turned enough to tell it from wind.
enum ConsiderIndex { c_linear, c_quadratic, c_latency, c_climb_linear, c_climb_quadratic, c_heading, c_trim_x, c_trim_y };
inline constexpr int consider_count = 8;
template <class S>
using Sensitivity = Eigen::Matrix<S, 8, consider_count>;

/// What the model needs to know beyond the drag law.
template <class S>
struct WindModel {
  ingest::DragLaw<S> drag;
  S turbulence_time = S(10);   ///< T_L [s]
  S turbulence_sd = S(0.5);    ///< sigma_u [m/s]
  S wind_time_psd = S(1e-3);   ///< q_t [m2/s3]
  S wind_height_psd = S(2e-3); ///< q_z [m2/s2 per metre]
  S trim_psd = S(1e-8);        ///< [m2/s5]
  S tilt_psd = S(0.000733);    ///< q_a of the attitude's noise [m2/s3]
  S vertical_sd = S(0.25), vertical_time = S(5);
  bool trim_is_state = true;   ///< else b stays at its value, and its error is considered
  /// Where the climb law is searched by likelihood, vertical wind is weighed by this law instead: thousands of
  /// innovations know the noise level well, and alpha would be bent to fit it (alpha = c / g makes the lever vanish).
  bool has_noise_law = false;
  ingest::DragLaw<S> noise_law;
};

/// Means over one step, attitude read at t - latency.
template <class S>
struct StepInput {
  Vector2<S> slope = Vector2<S>::Zero();       ///< s, mean over the step
  Vector2<S> slope_rate = Vector2<S>::Zero();  ///< its mean rate of change [1/s], for the latency's sensitivity
  S lift = S(9.80665);                         ///< g - vdot_d [m/s2]
  S v_down = S(0);                             ///< [m/s]
  S heading = S(0);                            ///< psi at mid-step [rad]
  S step = S(0.1);                             ///< h [s]
};

/// x- = f(x), P- = Phi P Phi' + Q, S- = Phi S + F.
template <class S>
struct Transition {
  State<S> x;
  StateMatrix<S> Phi, Q;
  Sensitivity<S> F;
  Vector2<S> a_in;  ///< s (g - vdot_d - c v_d) [m/s2]
};

namespace detail {

/// Per-axis coefficients of v+ = E v + (1-E) W + k_u u + k_a a, rate d.
template <class S>
struct AxisStep {
  S E, k_u, k_a;
};

template <class S>
AxisStep<S> axis_step(S d, S h, S T_L) {
  using std::abs, std::exp, std::expm1;
  const S E = exp(-d * h);
  const S k_a = d * h > S(1e-12) ? -expm1(-d * h) / d : h;
  const S gap = d - S(1) / T_L;
  // e - E = E (exp(gap h) - 1); near gap = 0 the quotient tends to h.
  const S quotient = abs(gap * h) > S(1e-12) ? E * expm1(gap * h) / gap : h * E;
  return {E, d * quotient, k_a};
}

/// Rates of the linearised drag along and across the airspeed, and the axes.
template <class S>
struct DragAxes {
  S along, across;      ///< [1/s]
  Vector2<S> direction; ///< unit, N and E
};

template <class S>
Matrix2<S> on_axes(const DragAxes<S>& axes, S along, S across) {
  const Matrix2<S> along_axis = axes.direction * axes.direction.transpose();
  return across * Matrix2<S>::Identity() + (along - across) * along_axis;
}

}  // namespace detail

/// Discretised white-noise driven part of the model over a step of h: integral of the responses' products, by
/// Gauss and Legendre's rule of four points. The kernels are exponentials with d h and h / T_L well below 1, so the
/// rule's error is below 1e-9 of Q for steps up to 1 s and 3e-8 at 2 s (against Van Loan's matrix exponential).
template <class S>
StateMatrix<S> process_noise(const WindModel<S>& model, const detail::DragAxes<S>& axes, const Matrix2<S>& R_psi, S q_a,
                             S q_W, S h) {
  using std::exp;
  constexpr double node[4] = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
  constexpr double weight[4] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};
  const S q_u = S(2) * model.turbulence_sd * model.turbulence_sd / model.turbulence_time;
  const S q_b = model.trim_is_state ? model.trim_psd : S(0);
  StateMatrix<S> Q = StateMatrix<S>::Zero();
  for (int i = 0; i < 4; ++i) {
    const S tau = S(node[i]) * h, w = S(weight[i]) * h;
    const auto along = detail::axis_step(axes.along, tau, model.turbulence_time);
    const auto across = detail::axis_step(axes.across, tau, model.turbulence_time);
    const S e = exp(-tau / model.turbulence_time);
    const Matrix2<S> from_a = detail::on_axes(axes, along.E, across.E);
    const Matrix2<S> from_W = Matrix2<S>::Identity() - from_a;
    const Matrix2<S> from_u = detail::on_axes(axes, along.k_u, across.k_u);
    const Matrix2<S> from_b = detail::on_axes(axes, along.k_a, across.k_a) * R_psi;
    Q.template block<2, 2>(i_v, i_v) += w * (q_a * from_a * from_a.transpose() + q_W * from_W * from_W.transpose() +
                                             q_u * from_u * from_u.transpose() + q_b * from_b * from_b.transpose());
    Q.template block<2, 2>(i_v, i_W) += w * q_W * from_W;
    Q.template block<2, 2>(i_v, i_u) += w * q_u * e * from_u;
    Q.template block<2, 2>(i_v, i_b) += w * q_b * from_b;
    Q.template block<2, 2>(i_u, i_u) += w * q_u * e * e * Matrix2<S>::Identity();
  }
  Q.template block<2, 2>(i_W, i_W) = q_W * h * Matrix2<S>::Identity();
  Q.template block<2, 2>(i_b, i_b) = q_b * h * Matrix2<S>::Identity();
  Q.template block<2, 2>(i_W, i_v) = Q.template block<2, 2>(i_v, i_W).transpose();
  Q.template block<2, 2>(i_u, i_v) = Q.template block<2, 2>(i_v, i_u).transpose();
  Q.template block<2, 2>(i_b, i_v) = Q.template block<2, 2>(i_v, i_b).transpose();
  return Q;
}

/// One step of the model from state x. The quadratic law is linearised at the predicted airspeed, along and across
/// which it decouples, so that each axis is discretised exactly; with kappa = 0 nothing is linearised.
template <class S>
Transition<S> propagate(const WindModel<S>& model, const State<S>& x, const StepInput<S>& in) {
  using std::cos, std::sin, std::sqrt;
  const S h = in.step;
  const Vector2<S> v = x.template segment<2>(i_v), W = x.template segment<2>(i_W), u = x.template segment<2>(i_u);
  const Vector2<S> b = x.template segment<2>(i_b);
  const Vector2<S> a_h = v - W - u;
  const S airspeed = sqrt(a_h.squaredNorm() + in.v_down * in.v_down);
  const S v_c = -in.v_down;
  const auto climb = climb_factor(model.drag, v_c);
  const S c = (model.drag.linear + model.drag.quadratic * airspeed) * climb.value;

  detail::DragAxes<S> axes{c, c, Vector2<S>(S(1), S(0))};
  const S size = a_h.norm();
  if (model.drag.quadratic != S(0) && size > S(1e-6)) {
    axes.direction = a_h / size;
    const S floored = airspeed > S(0.1) ? airspeed : S(0.1);
    axes.along = c + model.drag.quadratic * climb.value * size * size / floored;
  }
  const auto along = detail::axis_step(axes.along, h, model.turbulence_time);
  const auto across = detail::axis_step(axes.across, h, model.turbulence_time);
  const Matrix2<S> E = detail::on_axes(axes, along.E, across.E);
  const Matrix2<S> K_u = detail::on_axes(axes, along.k_u, across.k_u);
  const Matrix2<S> K_a = detail::on_axes(axes, along.k_a, across.k_a);
  Matrix2<S> R_psi;
  R_psi << cos(in.heading), -sin(in.heading), sin(in.heading), cos(in.heading);
  const S e = exp(-h / model.turbulence_time);

  Transition<S> t;
  t.a_in = in.slope * (in.lift - c * in.v_down);
  // Drag at the linearisation point that its slope does not account for: (slope - c) a_h, along the airspeed.
  const Vector2<S> offset = (axes.along - c) * a_h;
  t.x.template segment<2>(i_v) = E * v + W - E * W + K_u * u + K_a * (t.a_in + R_psi * b + offset);
  t.x.template segment<2>(i_W) = W;
  t.x.template segment<2>(i_u) = e * u;
  t.x.template segment<2>(i_b) = b;

  t.Phi.setIdentity();
  t.Phi.template block<2, 2>(i_v, i_v) = E;
  t.Phi.template block<2, 2>(i_v, i_W) = Matrix2<S>::Identity() - E;
  t.Phi.template block<2, 2>(i_v, i_u) = K_u;
  t.Phi.template block<2, 2>(i_v, i_b) = model.trim_is_state ? Matrix2<S>(K_a * R_psi) : Matrix2<S>(Matrix2<S>::Zero());
  t.Phi.template block<2, 2>(i_u, i_u) = e * Matrix2<S>::Identity();

  const S q_W = model.wind_time_psd + model.wind_height_psd * std::abs(in.v_down);
  // Vertical wind acts through the rotor plane's slope and through the climb law.
  const S in_law = climb.clipped ? S(0) : S(1);
  const ingest::DragLaw<S>& weighed = model.has_noise_law ? model.noise_law : model.drag;
  const S lever = c - in_law * in.lift * (weighed.climb_linear + S(2) * weighed.climb_quadratic * v_c);
  const S q_a = model.tilt_psd + S(2) * lever * lever * model.vertical_sd * model.vertical_sd *
                                     in.slope.squaredNorm() * model.vertical_time;
  t.Q = process_noise(model, axes, R_psi, q_a, q_W, h);

  // Sensitivities: what one unit of each parameter adds to vdot at the step, carried over it as a constant.
  const Vector2<S> dragged = a_h + in.slope * in.v_down;
  const Vector2<S> trim = R_psi * b;
  t.F.setZero();
  const auto add = [&](int column, const Vector2<S>& acceleration) {
    t.F.template block<2, 1>(i_v, column) = K_a * acceleration;
  };
  add(c_linear, -climb.value * dragged);
  add(c_quadratic, -climb.value * airspeed * dragged);
  add(c_latency, -in.slope_rate * (in.lift - c * in.v_down));
  add(c_climb_linear, -in_law * c * v_c * dragged);
  add(c_climb_quadratic, -in_law * c * v_c * v_c * dragged);
  // The true heading is the logged one plus the error: everything that came in body axes turns with it.
  const Vector2<S> turned = t.a_in + trim;
  add(c_heading, Vector2<S>(-turned.y(), turned.x()));
  if (!model.trim_is_state) t.F.template block<2, 2>(i_v, c_trim_x) = K_a * R_psi;
  return t;
}

}  // namespace quadsonde::estimator
