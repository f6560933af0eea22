#include "estimator/calibration/excitation.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace quadsonde::estimator {

double excitation_index(const std::vector<Step>& steps) {
  using C = std::complex<double>;
  C sum_v = 0, sum_e = 0, sum_ve = 0;
  double n = 0, sum_vv = 0;
  for (const auto& step : steps) {
    if (!step.sound) continue;
    const C v(step.v.x(), step.v.y()), e = std::polar(1.0, step.heading);
    sum_v += v, sum_e += e, sum_ve += v * std::conj(e), sum_vv += std::norm(v), n += 1;
  }
  if (n < 3) return 0;
  // Least squares of v = p + q e, by the normal equations with |e| = 1.
  const double determinant = n * n - std::norm(sum_e);
  C p = sum_v / n, q = 0;
  if (determinant > 1e-9 * n * n) {
    q = (n * sum_ve - sum_v * std::conj(sum_e)) / determinant;
    p = (sum_v - q * sum_e) / n;
  }
  const double explained = (p * std::conj(sum_v) + q * std::conj(sum_ve)).real();
  return std::sqrt(std::max(0.0, sum_vv - explained) / n);
}

}  // namespace quadsonde::estimator
