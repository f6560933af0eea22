#pragma once
// Gusts at the vehicle: Ornstein-Uhlenbeck in time, or the Dryden form carried past it by its airspeed.
#include <Eigen/Core>
#include <memory>

#include "ingest/motion/random.h"
#include "ingest/motion/wind_field.h"

namespace quadsonde::ingest {

/// Length scales [m] and intensities [m/s] of low-altitude turbulence.
struct DrydenScales {
  double length_u = 0, length_w = 0;  ///< along and across the wind alike; vertical
  double sigma_u = 0, sigma_w = 0;
};

/// MIL-F-8785C, 3.7.3.4.2: in feet L_w = h, L_u = L_v = h / (0.177 + 0.000823 h)^1.2; sigma_w = 0.1 W20,
/// sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4. Good from 10 to 1000 ft: held at these beyond.
/// (MIL-HDBK-1797 halves L_v and L_w and writes 2 L in their forms: the same spectra.)
/// @param height      above ground [m]
/// @param wind_at_6m  mean wind at 20 ft [m/s]
DrydenScales dryden_scales(double height, double wind_at_6m);

/// Longitudinal gust of unit variance: white noise through 1 / (1 + T s), T = L / V.
class DrydenLongitudinal {
 public:
  explicit DrydenLongitudinal(Gaussian& noise) : noise_(noise), value_(noise()) {}
  /// @param step_over_T  V h / L of this step: exact at any
  double next(double step_over_T);

 private:
  Gaussian& noise_;
  double value_;
};

/// Lateral or vertical gust of unit variance: white noise through (1 + sqrt(3) T s) / (1 + T s)^2, exact at its step.
/// Autocorrelation exp(-t/T) (1 - t/(2T)).
class DrydenTransversal {
 public:
  explicit DrydenTransversal(Gaussian& noise);
  double next(double step_over_T);

 private:
  Gaussian& noise_;
  double first_, second_;
};

/// What is added to the mean wind, step by step.
class Gusts {
 public:
  virtual ~Gusts() = default;
  /// @param height    above take-off [m]
  /// @param mean      wind there, N and E [m/s]
  /// @param airspeed  of the vehicle [m/s]
  /// @return NED [m/s]
  virtual Eigen::Vector3d next(double height, const Eigen::Vector2d& mean, double airspeed) = 0;
};

/// Of the field's kind. Dryden's longitudinal axis lies along the mean wind (north in calm), and what passes the
/// vehicle is frozen turbulence at its airspeed, at least 0.5 m/s. Gusts are the same over the whole vehicle: their
/// gradients, which would roll it, are left out; a quadrotor is small against the scales.
/// @param step  [s]
std::unique_ptr<Gusts> make_gusts(const WindField& field, double step, Gaussian& noise);

}  // namespace quadsonde::ingest
