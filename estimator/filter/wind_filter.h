#pragma once
// The causal wind filter: fixed-size, no heap, no exceptions, float or double; the offline estimate runs this very
// class forward and smooths behind it. Source: estimator/MODEL.md sections 4 to 7.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "estimator/filter/wind_model.h"

namespace quadsonde::estimator {

template <class S>
struct FilterLimits {
  S gate_nis = S(18.4);     ///< chi-square(2), p 1e-4
  S start_wind_sd = S(20);  ///< W0 [m/s]; its mean is irrelevant
  S start_velocity_sd = S(1);
  S jump_threshold = S(25); ///< of J, chi-square(2) when calm
  S jump_variance = S(9);   ///< added to W where a jump is found [m2/s2]
  S jump_age = S(0.5);      ///< how long before its detection a jump happened [s]
};

enum class Outcome : unsigned char { updated, rejected, predicted };

template <class S>
struct Innovation {
  Vector2<S> value = Vector2<S>::Zero();
  Matrix2<S> covariance = Matrix2<S>::Identity();
  Vector2<S> whitened = Vector2<S>::Zero();
  S nis = S(0);
  S log_likelihood = S(0);  ///< without the constant
};

/// A step of the wind some time ago: W is opened by the variance, and v by what the step did to it since.
template <class S>
struct Jump {
  S variance = S(0);  ///< [m2/s2]; 0 = none
  S age = S(0);       ///< [s]
};

template <class S>
class WindFilter {
 public:
  WindFilter(const WindModel<S>& model, const FilterLimits<S>& limits) : model_(model), limits_(limits) {}

  /// @param v  first ground velocity, N and E [m/s]     @param trim  prior mean of b [m/s2]
  /// @param trim_covariance  of b [m2/s4]; used while the trim is a state, kept for a later thaw
  void start(const Vector2<S>& v, const Vector2<S>& trim, const Matrix2<S>& trim_covariance) {
    trim_covariance_ = trim_covariance;
    x_.setZero();
    x_.template segment<2>(i_v) = v;
    x_.template segment<2>(i_b) = trim;
    P_.setZero();
    set_diffuse(P_);
    if (model_.trim_is_state) P_.template block<2, 2>(i_b, i_b) = trim_covariance;
    S_.setZero();
  }

  /// v, W and u from diffuse, b kept: after a gap. Written as a step, so that a smoother passes b across the break.
  Transition<S> restart(const Vector2<S>& v) {
    Transition<S> t;
    t.Phi.setZero();
    t.Phi.template block<2, 2>(i_b, i_b).setIdentity();
    t.Q.setZero();
    set_diffuse(t.Q);
    t.F.setZero();
    t.a_in.setZero();
    t.x = x_;
    t.x.template segment<2>(i_v) = v;
    t.x.template segment<2>(i_u).setZero();
    apply(t);
    return t;
  }

  /// One step with a velocity. @param variance of each component [m2/s2]
  Outcome step(const StepInput<S>& in, const Vector2<S>& v, S variance, const Jump<S>& jump = {}) {
    predict(in, jump);
    return update(v, variance);
  }

  /// One step without a velocity.
  void predict(const StepInput<S>& in, const Jump<S>& jump = {}) {
    transition_ = propagate(model_, x_, in);
    if (jump.variance > S(0)) open(jump);
    apply(transition_);
  }

  Outcome update(const Vector2<S>& v, S variance) {
    Innovation<S>& nu = innovation_;
    nu.value = v - x_.template segment<2>(i_v);
    nu.covariance = P_.template block<2, 2>(i_v, i_v) + variance * Matrix2<S>::Identity();
    // Cholesky of a 2x2 by hand: l11, l21, l22.
    const S l11 = std::sqrt(nu.covariance(0, 0)), l21 = nu.covariance(1, 0) / l11;
    const S l22 = std::sqrt(nu.covariance(1, 1) - l21 * l21);
    nu.whitened.x() = nu.value.x() / l11;
    nu.whitened.y() = (nu.value.y() - l21 * nu.whitened.x()) / l22;
    nu.nis = nu.whitened.squaredNorm();
    // A rejected sample counts as if it stood at the gate: otherwise rejecting would pay.
    const bool accepted = nu.nis <= limits_.gate_nis;
    nu.log_likelihood = S(-0.5) * (accepted ? nu.nis : limits_.gate_nis) - std::log(l11 * l22);
    if (!accepted) return Outcome::rejected;
    const Eigen::Matrix<S, 8, 2> PH = P_.template leftCols<2>();
    const Eigen::Matrix<S, 8, 2> K = PH * inverse(nu.covariance);
    x_ += K * nu.value;
    // Joseph form: (I - KH) P (I - KH)' + K R K', H picking the first two states.
    P_.noalias() -= K * PH.transpose();
    const Eigen::Matrix<S, 8, 2> MH = P_.template leftCols<2>();
    P_.noalias() -= MH * K.transpose();
    P_.noalias() += variance * (K * K.transpose());
    P_ = (S(0.5) * (P_ + P_.transpose())).eval();
    const Eigen::Matrix<S, 2, consider_count> HS = S_.template topRows<2>();
    S_.noalias() -= K * HS;
    return Outcome::updated;
  }

  /// From here on the trim is estimated: what was considered becomes state, with the correlation it had all along.
  void thaw_trim() {
    if (model_.trim_is_state) return;
    model_.trim_is_state = true;
    const Eigen::Matrix<S, 8, 2> S_b = S_.template middleCols<2>(c_trim_x);
    Eigen::Matrix<S, 8, 2> L = S_b;
    L.template block<2, 2>(i_b, 0).setIdentity();
    P_ += L * trim_covariance_ * L.transpose();
    S_.template middleCols<2>(c_trim_x).setZero();
  }

  /// Goes over to another drag and latency: what the state has run with the old ones is made good by its
  /// sensitivities. The caller reads the attitude at the new latency from here on.
  /// @param ln_factor  on delta and kappa    @param latency  added to it [s]
  void adopt(S ln_factor, S latency) {
    const S factor = std::exp(ln_factor);
    auto& law = model_.drag;
    x_ += S_.col(c_linear) * ((factor - S(1)) * law.linear) + S_.col(c_quadratic) * ((factor - S(1)) * law.quadratic) +
          S_.col(c_latency) * latency;
    law.linear *= factor;
    law.quadratic *= factor;
  }

  void set_turbulence_sd(S sd) { model_.turbulence_sd = sd; }

  const State<S>& state() const { return x_; }
  const StateMatrix<S>& covariance() const { return P_; }
  const Sensitivity<S>& sensitivity() const { return S_; }
  const Innovation<S>& innovation() const { return innovation_; }
  const Transition<S>& transition() const { return transition_; }
  const WindModel<S>& model() const { return model_; }

  Vector2<S> wind() const { return x_.template segment<2>(i_W) + x_.template segment<2>(i_u); }

 private:
  static Matrix2<S> inverse(const Matrix2<S>& m) {
    Matrix2<S> adjugate;
    adjugate << m(1, 1), -m(0, 1), -m(1, 0), m(0, 0);
    return adjugate / (m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0));
  }
  void set_diffuse(StateMatrix<S>& P) const {
    const auto fill = [&](int at, S sd) { P(at, at) = P(at + 1, at + 1) = sd * sd; };
    fill(i_v, limits_.start_velocity_sd);
    fill(i_W, limits_.start_wind_sd);
    fill(i_u, model_.turbulence_sd);
  }
  void open(const Jump<S>& jump) {
    // v has followed the new wind for `age`: dv = (1 - exp(-delta age)) dW.
    const S share = S(1) - std::exp(-model_.drag.linear * jump.age);
    for (int i = 0; i < 2; ++i) {
      transition_.Q(i_W + i, i_W + i) += jump.variance;
      transition_.Q(i_v + i, i_v + i) += share * share * jump.variance;
      transition_.Q(i_v + i, i_W + i) += share * jump.variance;
      transition_.Q(i_W + i, i_v + i) += share * jump.variance;
    }
  }
  void apply(const Transition<S>& t) {
    x_ = t.x;
    P_ = (t.Phi * P_ * t.Phi.transpose() + t.Q).eval();
    S_ = (t.Phi * S_ + t.F).eval();
  }

  WindModel<S> model_;
  FilterLimits<S> limits_;
  State<S> x_ = State<S>::Zero();
  StateMatrix<S> P_ = StateMatrix<S>::Zero();
  Sensitivity<S> S_ = Sensitivity<S>::Zero();
  Matrix2<S> trim_covariance_ = Matrix2<S>::Zero();
  Innovation<S> innovation_;
  Transition<S> transition_;
};

/// Watches whitened innovations for a step of the wind: J = |sum of the last 5|^2 / 5.
template <class S>
class JumpTest {
 public:
  explicit JumpTest(S threshold) : threshold_(threshold) {}
  /// @param time [s]    @return whether the wind jumped
  bool add(const Vector2<S>& whitened, double time) {
    ring_[count_ % 5] = whitened;
    ++count_;
    if (count_ < 5 || time < quiet_until_) return false;
    Vector2<S> sum = Vector2<S>::Zero();
    for (const auto& z : ring_) sum += z;
    if (!(sum.squaredNorm() / S(5) > threshold_)) return false;
    clear();
    quiet_until_ = time + 2;
    return true;
  }
  void clear() { count_ = 0; }

 private:
  S threshold_;
  Vector2<S> ring_[5] = {Vector2<S>::Zero(), Vector2<S>::Zero(), Vector2<S>::Zero(), Vector2<S>::Zero(),
                         Vector2<S>::Zero()};
  unsigned count_ = 0;
  double quiet_until_ = -1e300;
};

}  // namespace quadsonde::estimator
