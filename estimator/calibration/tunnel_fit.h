#pragma once
// The two sinusoids of one run.
//
// Standing still in a wind of speed U from chi, equation (1) of estimator/MODEL.md reads g s = c a_h - R b with
// a_h = -w = U (cos chi, sin chi). In heading axes, with s = (-tan theta, tan phi / cos theta) and
// b = g (tan trim_pitch, -tan trim_roll):
//
//   tan theta            = -A cos(chi - psi) + theta0
//   tan phi / cos theta  = +A sin(chi - psi) + phi0,        A = (delta + kappa U) U / g
//
// Wind from ahead (chi = psi) pushes the nose down. Linear in p = A cos chi, q = A sin chi and the two trims.
#include <Eigen/Core>

#include "estimator/calibration/tunnel.h"

namespace quadsonde::estimator {

struct SinusoidFit {
  Eigen::Vector4d parameters = Eigen::Vector4d::Zero();  ///< p, q, theta0, phi0
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< inflated for correlated residuals
  double noise = 0;                                      ///< robust sd of one reading (tangent)
  double rms = 0;                                        ///< of all residuals (tangent)
  double inflation = 1;                                  ///< how many samples in a row are worth one

  double amplitude() const { return parameters.head<2>().norm(); }
  /// Along a direction [rad]: A if the wind comes from there.
  double along(double chi) const { return parameters(0) * std::cos(chi) + parameters(1) * std::sin(chi); }
  double along_sd(double chi) const;
};

/// Predictions of (tan theta, tan phi / cos theta): 2 x 4, times the parameters.
Eigen::Matrix<double, 2, 4> sinusoid_rows(double heading);

/// Which of the two tilt axes are used.
enum class TiltAxes { both, pitch_only, roll_only };

/// Least squares with Huber's weights (1.345 sd), at least 10 samples.
/// @param calm  no wind: p and q are zero, and only the trims are fitted
/// @param trim  a trim known beforehand, as two more readings
SinusoidFit fit_sinusoids(const std::vector<TunnelSample>& samples, bool calm, const std::optional<TunnelTrim>& trim,
                          TiltAxes axes = TiltAxes::both);

/// Share of the scatter about its mean that a fit explains, 0 to 1 (below 0: worse than the mean).
double explained(const std::vector<TunnelSample>& samples, const SinusoidFit& fit, TiltAxes axes);

}  // namespace quadsonde::estimator
