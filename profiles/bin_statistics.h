#pragma once
// The mean wind over any set of samples, with the exact covariance that the smoother implies.
// Source: estimator/MODEL.md section 11.
#include <optional>
#include <vector>

#include "estimator/smoother/passes.h"
#include "profiles/profile.h"

namespace quadsonde::profiles {

/// Mean of the smoothed wind over samples, with its error in independent parts.
struct BinMean {
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  Eigen::Matrix2d noise = Eigen::Matrix2d::Zero();       ///< trim and calibration left out [m2/s2]
  Eigen::Matrix2d per_trim = Eigen::Matrix2d::Zero();    ///< d wind / d b
  Eigen::Matrix2d trim = Eigen::Matrix2d::Zero();        ///< covariance of b [m2/s4]
  Eigen::Matrix<double, 2, estimator::consider_count> per_parameter =
      Eigen::Matrix<double, 2, estimator::consider_count>::Zero();
  Eigen::Vector2d turbulence = Eigen::Vector2d::Zero();  ///< mean of u^2 + P_uu, N and E [m2/s2]
  double seconds = 0;                                    ///< time in the bin
  std::size_t samples = 0;
  double effective_samples = 0;
  Reasons reasons;                                       ///< held by a fifth of the samples or more
  double doubtful_share = 0, bad_share = 0;

  Eigen::Matrix2d trim_part() const { return per_trim * trim * per_trim.transpose(); }
};

/// @param members  indices of points of the series, rising, each with an estimate
BinMean bin_mean(const estimator::WindSeries& series, const std::vector<std::size_t>& members);

/// Yamartino (1984): spread of the direction of the members' winds, from the mean sine and cosine [deg].
std::optional<double> direction_spread(const estimator::WindSeries& series, const std::vector<std::size_t>& members);

/// What turbulence adds to the error when a mean over some seconds stands for the ensemble mean [m2/s2].
double sampling_variance(double sigma_u, double time_u, double seconds);

}  // namespace quadsonde::profiles
