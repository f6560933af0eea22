#pragma once
// Tail of the chi-square distribution, as far as tests of consistency need it.
#include <cmath>
#include <numbers>

namespace quadsonde::estimator {

/// Probability that a chi-square variable is above the value. Exact for 2 degrees of freedom, else Wilson and
/// Hilferty's cube root (1931), which is within 0.01 of the probability from 3 degrees on.
inline double chi_square_tail(double chi2, int degrees_of_freedom) {
  if (degrees_of_freedom <= 0) return 1;
  if (degrees_of_freedom == 2) return std::exp(-0.5 * chi2);
  const double n = degrees_of_freedom, spread = 2 / (9 * n);
  const double z = (std::cbrt(chi2 / n) - (1 - spread)) / std::sqrt(spread);
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

}  // namespace quadsonde::estimator
