#include "ingest/motion/noise_levels.h"

#include <algorithm>
#include <cmath>

namespace quadsonde::ingest {
namespace {

/// Robust variance of the white noise that would give these differences.
double variance_by_differences(const std::vector<double>& time, const std::vector<Eigen::Vector2d>& value,
                               double interval, int order) {
  std::vector<double> sizes, weights(static_cast<std::size_t>(order) + 1, 1.0);
  double sum = 1, w = 1;
  for (int k = 1; k <= order; ++k) {
    w = -w * (order - k + 1) / k;
    weights[static_cast<std::size_t>(k)] = w;
    sum += w * w;
  }
  const auto n = static_cast<std::size_t>(order);
  std::size_t since_hole = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    since_hole = time[i] - time[i - 1] < 1.5 * interval ? since_hole + 1 : 0;
    if (since_hole < n) continue;
    Eigen::Vector2d d = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k <= n; ++k) d += weights[k] * value[i - k];
    sizes.push_back(std::abs(d.x()));
    sizes.push_back(std::abs(d.y()));
  }
  if (sizes.size() < 40) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return std::pow(1.4826 * *middle, 2) / sum;
}

}  // namespace

DifferenceNoise difference_noise(const std::vector<double>& time, const std::vector<Eigen::Vector2d>& value,
                                 double interval) {
  DifferenceNoise noise;
  const double second = variance_by_differences(time, value, interval, 2);
  const double sixth = variance_by_differences(time, value, interval, 6);
  noise.sd = std::sqrt(sixth);
  noise.whiteness = second > 0 ? sixth / second : 0;
  return noise;
}

}  // namespace quadsonde::ingest
