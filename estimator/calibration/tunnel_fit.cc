#include "estimator/calibration/tunnel_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadsonde::estimator {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double least_noise = 1e-5;  // a log that was made without noise still has digits

bool uses(TiltAxes axes, int row) {
  return axes == TiltAxes::both || (axes == TiltAxes::pitch_only ? row == 0 : row == 1);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Residuals in rows of two; those of axes that are not used stay zero.
std::vector<Eigen::Vector2d> residuals_of(const std::vector<TunnelSample>& samples, const Eigen::Vector4d& parameters,
                                          TiltAxes axes) {
  std::vector<Eigen::Vector2d> all;
  all.reserve(samples.size());
  for (const auto& s : samples) {
    Eigen::Vector2d r = Eigen::Vector2d(s.pitch, s.roll) - sinusoid_rows(s.heading) * parameters;
    for (int row = 0; row < 2; ++row)
      if (!uses(axes, row)) r(row) = 0;
    all.push_back(r);
  }
  return all;
}

double robust_sd(const std::vector<Eigen::Vector2d>& residuals, TiltAxes axes) {
  std::vector<double> sizes;
  for (const auto& r : residuals)
    for (int row = 0; row < 2; ++row)
      if (uses(axes, row)) sizes.push_back(std::abs(r(row)));
  return std::max(least_noise, 1.4826 * median(std::move(sizes)));
}

/// 1 + 2 sum of the autocorrelation, up to its first negative value: Geyer's cut, plainly.
double correlation_inflation(const std::vector<Eigen::Vector2d>& residuals) {
  const std::size_t n = residuals.size();
  double power = 0;
  for (const auto& r : residuals) power += r.squaredNorm();
  if (n < 20 || power <= 0) return 1;
  double sum = 1;
  for (std::size_t lag = 1; lag < n / 4; ++lag) {
    double product = 0;
    for (std::size_t i = lag; i < n; ++i) product += residuals[i].dot(residuals[i - lag]);
    if (product <= 0) break;
    sum += 2 * product / power;
  }
  return sum;
}

/// What is known of the parameters before a sample is seen: calm air, a trim.
struct Prior {
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), information = Eigen::Vector4d::Zero();
};

Prior prior_of(bool calm, const std::optional<TunnelTrim>& trim, TiltAxes axes) {
  Prior prior;
  if (calm) prior.information.head<2>().setConstant(1e12);
  if (trim) {
    const double sd = std::max(trim->sd_deg, 1e-3) * degree;
    prior.mean.tail<2>() << std::tan(trim->pitch_deg * degree), std::tan(trim->roll_deg * degree);
    prior.information.tail<2>().setConstant(1 / (sd * sd));
  }
  // The trim of an axis that is not used.
  if (axes == TiltAxes::pitch_only) prior.information(3) = 1e12;
  if (axes == TiltAxes::roll_only) prior.information(2) = 1e12;
  return prior;
}

}  // namespace

double SinusoidFit::along_sd(double chi) const {
  const Eigen::Vector2d direction(std::cos(chi), std::sin(chi));
  return std::sqrt(std::max(0.0, direction.dot(covariance.topLeftCorner<2, 2>() * direction)));
}

Eigen::Matrix<double, 2, 4> sinusoid_rows(double psi) {
  const double c = std::cos(psi), s = std::sin(psi);
  Eigen::Matrix<double, 2, 4> rows;
  rows << -c, -s, 1, 0, -s, c, 0, 1;
  return rows;
}

SinusoidFit fit_sinusoids(const std::vector<TunnelSample>& samples, bool calm, const std::optional<TunnelTrim>& trim,
                          TiltAxes axes) {
  constexpr double huber = 1.345;
  const Prior prior = prior_of(calm, trim, axes);
  SinusoidFit fit;
  fit.parameters = prior.mean;
  double noise = 1e3;  // the first pass weighs all alike
  Eigen::Matrix4d normal;
  for (int pass = 0; pass < 50; ++pass) {
    const auto residuals = residuals_of(samples, fit.parameters, axes);
    if (pass > 0) noise = robust_sd(residuals, axes);
    normal = prior.information.asDiagonal();
    Eigen::Vector4d right = prior.information.cwiseProduct(prior.mean - fit.parameters);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto rows = sinusoid_rows(samples[i].heading);
      for (int row = 0; row < 2; ++row) {
        if (!uses(axes, row)) continue;
        const double size = std::abs(residuals[i](row));
        const double weight = (size > huber * noise ? huber * noise / size : 1.0) / (noise * noise);
        normal += weight * rows.row(row).transpose() * rows.row(row);
        right += weight * residuals[i](row) * rows.row(row).transpose();
      }
    }
    const Eigen::Vector4d move = normal.completeOrthogonalDecomposition().solve(right);
    fit.parameters += move;
    if (pass > 1 && move.norm() < 1e-10) break;
  }
  const auto residuals = residuals_of(samples, fit.parameters, axes);
  fit.noise = robust_sd(residuals, axes);
  fit.inflation = correlation_inflation(residuals);
  double squares = 0;
  for (const auto& r : residuals) squares += r.squaredNorm();
  const double readings = static_cast<double>(samples.size()) * (axes == TiltAxes::both ? 2 : 1);
  fit.rms = std::sqrt(squares / std::max(1.0, readings));
  fit.covariance = normal.completeOrthogonalDecomposition().pseudoInverse() * fit.inflation;
  return fit;
}

double explained(const std::vector<TunnelSample>& samples, const SinusoidFit& fit, TiltAxes axes) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& s : samples) mean += Eigen::Vector2d(s.pitch, s.roll) / static_cast<double>(samples.size());
  double total = 0, left = 0;
  const auto residuals = residuals_of(samples, fit.parameters, axes);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    left += residuals[i].squaredNorm();
    const Eigen::Vector2d off = Eigen::Vector2d(samples[i].pitch, samples[i].roll) - mean;
    for (int row = 0; row < 2; ++row)
      if (uses(axes, row)) total += off(row) * off(row);
  }
  return total > 0 ? 1 - left / total : 0;
}

}  // namespace quadsonde::estimator
