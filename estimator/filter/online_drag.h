#pragma once
// Drag and latency learned in flight: a factor on the drag law and the latency, estimated from the filter's own
// innovations while the vehicle's motion tells of them, and else not touched. Fixed sizes, no allocation.
// Source: estimator/MODEL.md section 16.
#include <algorithm>
#include <cmath>

#include "estimator/filter/excitation.h"
#include "estimator/filter/wind_filter.h"

namespace quadsonde::estimator {

template <class S>
using ParameterVector = Eigen::Matrix<S, consider_count, 1>;
template <class S>
using ParameterMatrix = Eigen::Matrix<S, consider_count, consider_count>;

/// What is known of the considered parameters beside the filter that carries their sensitivities. Inside, the place of
/// delta holds ln of a factor common to delta and kappa, that of kappa what kappa is off beside that factor. Of all
/// parameters only this factor and the latency move; the others keep their means, with every correlation (Schmidt).
template <class S>
class DragKnowledge {
 public:
  /// @param law  at which the covariance is stated   @param covariance  in the order of ConsiderIndex
  /// @param least_sd  of ln factor once it has moved: no flight is believed beyond this
  DragKnowledge(const ingest::DragLaw<S>& law, const ParameterMatrix<S>& covariance, S least_sd)
      : prior_(covariance), least_sd_(least_sd) {
    const ParameterMatrix<S> T = to_factor(law);
    C_ = T * covariance * T.transpose();
    first_variance_ = C_(c_linear, c_linear);
  }

  /// Learns from the innovation that the filter is about to take in.
  /// @param filter  between predict() and update()   @param variance  of the velocity v [m2/s2]
  /// @param gate    chi-square(2) beyond which nothing is learned
  /// @return whether anything was learned; mean() has moved then
  bool learn(const WindFilter<S>& filter, const Vector2<S>& v, S variance, S gate, S step, bool allowed) {
    constexpr S instrument_time = S(4);
    const auto& law = filter.model().drag;
    Eigen::Matrix<S, 2, consider_count> M = filter.sensitivity().template topRows<2>();
    M.col(c_linear) = law.linear * M.col(c_linear) + law.quadratic * M.col(c_quadratic);
    const S forget = step / instrument_time;
    slow_ += (forget < S(1) ? forget : S(1)) * (M.col(c_linear) - slow_);
    if (!allowed) return false;
    const Vector2<S> innovation = v - filter.state().template segment<2>(i_v) - M * mean_;
    const Matrix2<S> R = filter.covariance().template topLeftCorner<2, 2>() + variance * Matrix2<S>::Identity();
    const Matrix2<S> V = R + M * C_ * M.transpose();
    const S determinant = V(0, 0) * V(1, 1) - V(0, 1) * V(1, 0);
    if (!(determinant > S(0))) return false;
    Matrix2<S> inverse;
    inverse << V(1, 1), -V(0, 1), -V(1, 0), V(0, 0);
    inverse /= determinant;
    if (!(innovation.dot(inverse * innovation) <= gate)) return false;
    Eigen::Matrix<S, consider_count, 2> K = Eigen::Matrix<S, consider_count, 2>::Zero();
    K.row(c_latency) = C_.row(c_latency) * M.transpose() * inverse;
    // The factor follows the latency as far as they are correlated; the rest of it is weighed by the instrument.
    const S of_latency = C_(c_latency, c_latency) > S(0) ? C_(c_linear, c_latency) / C_(c_latency, c_latency) : S(0);
    const S rest = C_(c_linear, c_linear) - of_latency * C_(c_linear, c_latency);
    K.row(c_linear) = rest * slow_.transpose() * inverse + of_latency * K.row(c_latency);
    keep_from_growing(M, V, K);
    mean_ += K * innovation;
    const ParameterMatrix<S> left = ParameterMatrix<S>::Identity() - K * M;
    C_ = (left * C_ * left.transpose() + K * R * K.transpose()).eval();
    C_ = (S(0.5) * (C_ + C_.transpose())).eval();
    learned_ = true;
    return true;
  }

  /// The estimate against the law and the latency that the filter runs with: ln factor and latency [s]; else zero.
  const ParameterVector<S>& mean() const { return mean_; }
  void set_mean(S ln_factor, S latency) { mean_(c_linear) = ln_factor, mean_(c_latency) = latency; }

  bool learned() const { return learned_; }
  S ln_factor_variance() const {
    const S formal = C_(c_linear, c_linear);
    return learned_ ? std::max(formal, std::min(formal + least_sd_ * least_sd_, first_variance_)) : first_variance_;
  }
  S latency_variance() const { return C_(c_latency, c_latency); }

  /// In the order and units of ConsiderIndex, at the law as it is now. Nothing learned: as it was given, bit for bit.
  ParameterMatrix<S> covariance(const ingest::DragLaw<S>& law) const {
    if (!learned_) return prior_;
    ParameterMatrix<S> C = C_;
    C(c_linear, c_linear) = ln_factor_variance();
    ParameterMatrix<S> back = ParameterMatrix<S>::Identity();
    back(c_linear, c_linear) = law.linear;
    back(c_quadratic, c_linear) = law.quadratic;
    return back * C * back.transpose();
  }

  /// A trim that becomes a state takes its uncertainty with it.
  void forget_trim() {
    C_.template middleRows<2>(c_trim_x).setZero();
    C_.template middleCols<2>(c_trim_x).setZero();
  }
  /// The filter has moved to the estimate (WindFilter::adopt).
  void adopted() { mean_.setZero(); }

 private:
  /// The instrument's gain is not the best one: where it is large it may overshoot, and a variance that grows makes the
  /// next gain larger still. Then the part of it is taken that leaves the least variance.
  void keep_from_growing(const Eigen::Matrix<S, 2, consider_count>& M, const Matrix2<S>& V,
                         Eigen::Matrix<S, consider_count, 2>& K) const {
    const Vector2<S> gain = K.row(c_linear).transpose();
    const S gained = gain.dot(M * C_.col(c_linear)), spent = gain.dot(V * gain);
    const S growth = spent - S(2) * gained, variance = C_(c_linear, c_linear);
    if (growth <= S(0.02) * variance && variance + growth <= first_variance_) return;
    K.row(c_linear) *= gained > S(0) ? gained / spent : S(0);
  }
  static ParameterMatrix<S> to_factor(const ingest::DragLaw<S>& law) {
    ParameterMatrix<S> T = ParameterMatrix<S>::Identity();
    if (!(law.linear > S(0))) return T;
    T(c_linear, c_linear) = S(1) / law.linear;
    T(c_quadratic, c_linear) = -law.quadratic / law.linear;
    return T;
  }

  ParameterMatrix<S> prior_, C_;
  Vector2<S> slow_ = Vector2<S>::Zero();
  ParameterVector<S> mean_ = ParameterVector<S>::Zero();
  S least_sd_, first_variance_ = S(0);
  bool learned_ = false;
};

}  // namespace quadsonde::estimator
