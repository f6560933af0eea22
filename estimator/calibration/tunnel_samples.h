#pragma once
// What of a flight stands still, and how it leans there.
#include <vector>

#include "estimator/calibration/tunnel.h"

namespace quadsonde::estimator {

struct SteadySamples {
  std::vector<TunnelSample> samples;
  std::size_t seen = 0;     ///< attitude blocks with a velocity, steady or not
  double median_speed = 0;  ///< over all of them [m/s]
};

/// Attitude in blocks of 0.1 s where velocity and acceleration (means and slopes over 2 s, or 5 samples if they are
/// longer) stay below the settings' limits and the tilt below 45 degrees.
SteadySamples steady_samples(const TunnelRun& run, const TunnelSettings& settings);

/// Degrees of heading that samples cover, in sectors of 10 degrees.
double turn_covered_deg(const std::vector<TunnelSample>& samples);

}  // namespace quadsonde::estimator
