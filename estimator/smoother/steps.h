#pragma once
// A flight's measurements, laid on the filter's steps: one step per velocity sample.
#include <vector>

#include "estimator/filter/wind_model.h"
#include "estimator/smoother/wind_series.h"
#include "ingest/flight/flight.h"

namespace quadsonde::estimator {

struct Step {
  ingest::LogTime time;           ///< of the velocity sample
  double seconds = 0;             ///< since the first step
  StepInput<double> input;        ///< over the interval that ends here
  Eigen::Vector2d v = Eigen::Vector2d::Zero();  ///< measured, N and E [m/s]
  double variance = 0.01;         ///< of each component [m2/s2]
  double heading = 0;             ///< at the end [rad]
  double tilt = 0;                ///< at the end [rad]
  bool sound = false;             ///< the input is whole: attitude throughout, no gap, tilt below 45 degrees
  Reason fault = Reason::converging;  ///< why not sound
  bool gap_before = false;        ///< the filter must restart here
};

struct StepSettings {
  double latency = 0;             ///< the attitude is read this much earlier [s]
  double drag = 0.25;             ///< weighs the attitude within a step, as its effect decays [1/s]
  double max_gap = 2;             ///< [s]
  double velocity_sd = 0.1;       ///< where the log states none [m/s]
  bool causal = false;            ///< vertical acceleration from the past second only (half a second late)
  double gravity = 9.80665;
};

struct Steps {
  std::vector<Step> steps;
  double attitude_interval = 0.1; ///< median [s]
  double velocity_interval = 0.1; ///< median [s]
};

/// Lays out the steps. The flight is tidy and has attitude and velocity.
/// The mean of the thrust slope over a step is the integral of its piecewise linear course: a faster attitude is
/// averaged, never decimated; a slower one interpolated.
Steps make_steps(const ingest::Flight& flight, const StepSettings& settings);

}  // namespace quadsonde::estimator
