#pragma once
// Multiple shooting: over each window the equations of motion run freely from a fitted start in a fitted constant
// wind, and what they miss of the logged velocity is weighed against what noise and turbulence may do.
// Source: design notes, section 6.
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "ingest/motion/noise_levels.h"
#include "ingest/motion/telemetry.h"

namespace quadsonde::ingest {

/// What is assumed of the vehicle; sd 0 = certain.
struct ShootingPrior {
  DragLaw<double> drag;
  double drag_log_sd = 0.35;                       ///< of one factor on the whole law
  Eigen::Vector2d trim = Eigen::Vector2d::Zero();  ///< b, heading axes [m/s2]
  Eigen::Vector2d trim_sd = Eigen::Vector2d::Constant(0.51);
  double gravity = standard_gravity;
};

/// A reading of the telemetry: as it stands, or with one fault undone.
struct LogReading {
  std::shared_ptr<const Telemetry> telemetry;
  double velocity_scale = 1;  ///< logged velocity = scale * true one; the fit stays in logged units
  double latency = 0;         ///< the velocity is this much older than the attitude of the same time [s]
};

/// One window's prediction: velocities and their derivatives, all north first, then all east.
struct WindowPrediction {
  Eigen::VectorXd v;         ///< 2 n
  Eigen::MatrixXd jacobian;  ///< 2 n x (7 + gains): v0 n, e; wind n, e; trim x, y; ln of the drag factor; gains
};

/// A linear map of the tilt whose share in the motion may be asked for.
struct GainMap {
  Eigen::Matrix2d map;
  bool heading_axes = false;  ///< else N and E
};

struct WindowParameters {
  Eigen::Vector2d v0, wind;
};

/// Parameters of a flight and what they leave.
struct ShootingFit {
  std::vector<WindowParameters> windows;
  Eigen::Vector2d trim = Eigen::Vector2d::Zero();
  double drag_log_factor = 0;
  double chi2 = 0;
  double dof = 1;
  double log_det = 0;                ///< of all noise covariances
  std::vector<double> window_ratio;  ///< chi2 per degree of freedom
  std::vector<Eigen::VectorXd> residual;
  std::vector<Eigen::MatrixXd> jacobian;
  Eigen::VectorXd gain;  ///< of each GainMap, beside what the equations have
  Eigen::MatrixXd gain_covariance;
  double ratio() const { return chi2 / dof; }
  /// -2 ln likelihood, with the size of the noise left open.
  double badness() const { return dof * std::log(std::max(chi2, 1e-12) / dof) + log_det; }
};

/// Covariances of the velocity that unit turbulence and unit acceleration noise make, by the pattern of times.
class NoiseShapes {
 public:
  NoiseShapes(double drag, double turbulence_time) : drag_(drag), time_(turbulence_time) {}
  struct Shape {
    Eigen::MatrixXd turbulence, acceleration;
  };
  /// @param ticks  times of samples in units of `interval`
  const Shape& at(const std::vector<int>& ticks, double interval);

 private:
  double drag_, time_;
  std::map<std::vector<int>, Shape> shapes_;
};

class Shooting {
 public:
  enum class Solver { closed_form, cvodes };
  Shooting(std::vector<ShootingWindow> windows, const ShootingPrior& prior, double turbulence_time);

  /// Gauss-Newton over all windows; trim and drag factor are common to them.
  /// @param start  a fit of the same windows to begin with; two rounds are enough then
  /// @return empty if the integrator gave up
  std::optional<ShootingFit> fit(const LogReading& reading, const NoiseLevels& noise,
                                 Solver solver = Solver::closed_form, const std::vector<GainMap>& gains = {},
                                 const ShootingFit* start = nullptr);

  /// Noise levels of highest restricted likelihood for the residuals of a fit. `all`: velocity and acceleration noise
  /// too, else the turbulence alone.
  NoiseLevels likeliest_noise(const LogReading& reading, const ShootingFit& fit, NoiseLevels start, bool all);

  const std::vector<ShootingWindow>& windows() const { return windows_; }
  const ShootingPrior& prior() const { return prior_; }

 private:
  double minus_two_log_likelihood(const LogReading& reading, const ShootingFit& fit, const NoiseLevels& noise);

  std::vector<ShootingWindow> windows_;
  ShootingPrior prior_;
  NoiseShapes shapes_;
};

/// The closed-form solution, step by step, with the drag coefficient frozen within each; exact for the linear law.
WindowPrediction closed_form(const MotionCourse& course, const std::vector<double>& times,
                             const WindowParameters& start, const ShootingPrior& prior, const Eigen::Vector2d& trim,
                             double drag_log_factor, double velocity_scale, const std::vector<GainMap>& gains = {});

}  // namespace quadsonde::ingest
