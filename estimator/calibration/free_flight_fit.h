#pragma once
// Maximum marginal likelihood of a drag law over flights in an unknown wind: the wind filter's innovations decide;
// wind, turbulence and trims are the filter's states. Source: estimator/MODEL.md section 15.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimator/calibration/slow_steps.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::estimator {

/// What the flights have in common: ln delta, kappa [1/m], latency [s], trim roll and pitch [deg].
enum FitParameter { f_drag, f_quadratic, f_latency, f_trim_roll, f_trim_pitch };
inline constexpr int fit_count = 5;
using FitVector = Eigen::Matrix<double, fit_count, 1>;
using FitMatrix = Eigen::Matrix<double, fit_count, fit_count>;

/// How the attitude may err: white per sample where the correlation time is 0.
struct TiltNoise {
  double sd_deg = 0.5, correlation_s = 0;
  std::string words() const;  ///< "0.5 deg white", "1 deg over 1 s"
};

struct FitFlight {
  SlowMotion* motion = nullptr;
  double density_ratio = 1;  ///< of the flight's air to that at which the law is stated
  bool turned = true;        ///< the nose turned enough to tell a trim from wind; else the trim is left at its prior
};

struct FitSettings {
  TiltNoise noise;
  FitVector prior = FitVector::Zero();
  FitMatrix prior_information = FitMatrix::Zero();
  ingest::DragLaw<double> climb;  ///< its climb terms hold; they are not fitted
  double density_exponent = 0.5;
  bool quadratic = false;       ///< kappa is free; else it stays at its prior
  double trim_between_deg = 0;  ///< by which each flight's trim may differ from the vehicle's (1 sigma)
};

struct FreeFit {
  FitVector at = FitVector::Zero();
  FitMatrix information = FitMatrix::Zero();  ///< of the flights alone
  FitMatrix covariance = FitMatrix::Zero();   ///< with the prior, kappa included even where it is held
  std::vector<double> turbulence_sd;          ///< of each flight, most likely [m/s]
  double log_likelihood = 0;                  ///< of all innovations
  int iterations = 0;
  bool converged = false;
};

/// Gauss and Newton from one start. Cannot fail; `converged` tells.
FreeFit fit_free_flights(const std::vector<FitFlight>& flights, const FitSettings& settings, const FitVector& start);

/// Residuals whitened by a filter that stands still, and their derivatives: what the search and the report of what can
/// be identified are made of. One pair of rows per accepted window of every flight.
struct Whitened {
  Eigen::VectorXd residual;
  Eigen::Matrix<double, Eigen::Dynamic, fit_count> jacobian;
  /// The same derivatives for the same motion in a constant wind: the tilt that the controller sets against gusts,
  /// which is correlated with the residuals, is not in them.
  Eigen::Matrix<double, Eigen::Dynamic, fit_count> instruments;
  FitMatrix information() const;  ///< of the parameters at which instruments and residuals are orthogonal
};
Whitened whiten(const std::vector<FitFlight>& flights, const FitSettings& settings, const FitVector& at,
                const std::vector<double>& turbulence_sd);

/// c [1/s] of level flight at an airspeed [m/s].
double fitted_drag(const FitVector& at, double airspeed);

}  // namespace quadsonde::estimator
