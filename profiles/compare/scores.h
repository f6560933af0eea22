#pragma once
// How well one wind agrees with another, over pairs of them. Errors are ours minus the reference's.
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace quadsonde::profiles {

/// A wind of ours beside somebody else's, for one time and height.
struct Pair {
  Eigen::Vector2d ours = Eigen::Vector2d::Zero();  ///< v_NA_N, N and E [m/s]
  double speed_low = 0, speed_high = 0;            ///< of the reference [m/s]; equal where it gives one value
  std::optional<Eigen::Vector2d> reference;        ///< N and E, at the middle of its speeds; empty: no direction
  std::optional<Eigen::Matrix2d> covariance;       ///< of the error to be expected [m2/s2]; empty: not told
};
/// Against one known vector.
Pair pair_of(const Eigen::Vector2d& ours, const Eigen::Vector2d& reference,
             std::optional<Eigen::Matrix2d> covariance = std::nullopt);

/// What the errors of one quantity are: bias = mean(d), sd with n - 1, rmse^2 = mean(d^2).
struct ErrorStatistics {
  std::size_t n = 0;
  double bias = 0, rmse = 0;
  std::optional<double> sd;                 ///< from two pairs on
  std::optional<double> effective_samples;  ///< n (1 - r) / (1 + r), r: lag-1 autocorrelation within 0 and .99
  std::optional<double> bias_half95;  ///< 95 % interval of the bias is bias -+ this; from two effective samples on
};

/// Where the reference gives a range of speeds, a speed of ours inside it has no error and one outside the distance to
/// the nearer end; the vector error is taken from the reference's direction with the speed of its range that is
/// nearest to ours. The measures of honesty (inside68, inside95, normalised_error) take the middle of the range
/// instead, since the covariance to be expected contains its width.
struct Scores {
  std::size_t n = 0;                         ///< pairs with a speed: all
  ErrorStatistics east, north;               ///< [m/s]; fewer than n where a reference had no direction
  ErrorStatistics speed;                     ///< [m/s]
  double rmsve = 0;                          ///< root mean square vector error [m/s], over the pairs of `east`
  ErrorStatistics direction;                 ///< [deg], circular; where both speeds reach the threshold
  std::size_t n_slow = 0;                    ///< pairs left out of it because one of the speeds is below the threshold
  std::size_t n_no_direction = 0;            ///< pairs left out of it because the reference has none
  std::size_t n_in_range = 0;                ///< speeds inside a reference's range, where it has one
  std::size_t n_range = 0;                   ///< references with a range
  std::optional<double> inside68, inside95;  ///< share of components within 1 and 1.96 expected sd
  std::optional<double> normalised_error;    ///< mean of e' C^-1 e / 2: 1 when the covariance is right
};

/// Collects pairs in the order of time or height.
class Scorer {
 public:
  /// @param direction_above  both speeds have to reach it for the direction to count [m/s]
  explicit Scorer(double direction_above = 2) : direction_above_(direction_above) {}

  /// @return whether both components lie within 1.96 expected sd; true where no covariance is told
  bool add(const Pair& pair);
  /// Source: MET.md section 5; Student's t for the interval, with the effective samples.
  Scores scores() const;

 private:
  void add_direction(const Pair& pair);
  bool add_interval(const Eigen::Vector2d& e, const Eigen::Matrix2d& covariance);

  double direction_above_;
  std::vector<double> east_, north_, speed_, direction_;
  std::size_t slow_ = 0, no_direction_ = 0, in_range_ = 0, ranges_ = 0;
  std::size_t intervals_ = 0, inside68_ = 0, inside95_ = 0;
  double normalised_ = 0;
};

/// Difference of two directions, -180 < d <= 180 [deg].
double turn_between(double from_deg, double to_deg);
/// Speed of ours minus the nearest speed of a range.
double speed_error(const Pair& pair);
/// 97.5 % quantile of Student's t: never too small, at most .6 % too large from 2 degrees of freedom on, 8 % below;
/// that of 1 below 1. Source: tabulated quantiles, linear in 1/degrees.
double t_quantile(double degrees_of_freedom);
ErrorStatistics error_statistics(const std::vector<double>& errors);

}  // namespace quadsonde::profiles
