#pragma once
// The common fit of all runs, by Ceres.
#include <Eigen/Core>
#include <vector>

#include "estimator/calibration/tunnel.h"

namespace quadsonde::estimator {

/// What the common fit needs of a run.
struct ProblemRun {
  const std::vector<TunnelSample>* samples = nullptr;
  double wind_speed = 0, wind_speed_sd = 0.1;    ///< stated [m/s]
  double chi = 0;                                ///< stated direction it comes from [rad]
  double noise = 0.01, inflation = 1;            ///< of one tilt reading
  double linear_scale = 1, quadratic_scale = 1;  ///< of the law by the run's air density
};

struct CommonState {
  double linear = 0.25, quadratic = 0;
  Eigen::Vector2d trim = Eigen::Vector2d::Zero();  ///< theta0, phi0 (tangents)
  double offset = 0;                               ///< of all stated directions [rad]
  std::vector<double> wind;                        ///< per run [m/s]
};

struct CommonFit {
  CommonState state;
  double cost = 0;
  int iterations = 0;
  bool converged = false;
};

/// Least squares over every sample, robust (Cauchy at 2 sigma), with linear >= 0, quadratic >= 0 and each run's wind
/// held by its stated sd. Correlated samples count as their effective number.
/// @param quadratic  false: the quadratic term is held at zero
CommonFit solve_common(const std::vector<ProblemRun>& runs, const std::optional<TunnelTrim>& trim, bool quadratic,
                       const CommonState& start);

/// Whitened Jacobian's singular values and the covariance at a solution. Order: linear, quadratic, theta0, phi0,
/// offset, then the winds.
struct CommonUncertainty {
  int rank = 0;                     ///< singular values above 0.05: better than a twentieth of the prior
  Eigen::VectorXd singular_values;  ///< columns scaled by prior sds (drag's 0.07 1/s and 0.004 1/m, trims 3 deg, ...)
  Eigen::VectorXd weakest;          ///< of the first five, in prior sds: the direction least known, winds marginalised
  std::optional<Eigen::MatrixXd> covariance;  ///< DENSE_SVD; empty without full rank
};
CommonUncertainty uncertainty_of(const std::vector<ProblemRun>& runs, const std::optional<TunnelTrim>& trim,
                                 const CommonState& at, bool quadratic = true);

/// Residuals of one sample, over noise: what Ceres differentiates; here for the check of its derivatives.
/// @param parameters  linear, quadratic, theta0, phi0, offset, wind
/// @param jacobian    2 x 6
Eigen::Vector2d tilt_residual(const ProblemRun& run, const TunnelSample& sample,
                              const Eigen::Matrix<double, 6, 1>& parameters, Eigen::Matrix<double, 2, 6>* jacobian);

}  // namespace quadsonde::estimator
