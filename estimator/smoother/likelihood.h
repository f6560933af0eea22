#pragma once
// What a flight's own likelihood decides: the level of the turbulence and, where both legs are flown, the climb law.
#include "estimator/smoother/passes.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::estimator {

/// sigma_u that maximises the likelihood of the innovations at fixed T_L [m/s], between 0.03 and 4.
double most_likely_turbulence(const std::vector<Step>& steps, PassSettings settings);

struct ClimbLawEstimate {
  double value = 0, sd = 0;   ///< alpha [s/m]
};
/// alpha by maximum posterior (prior mean and sd given), sd from the curvature. Source: MODEL.md section 9.
ClimbLawEstimate most_likely_climb_law(const std::vector<Step>& steps, PassSettings settings, double prior,
                                       double prior_sd);

/// Whether ascent and descent were both flown long enough at common heights for alpha to be told from wind.
bool flies_up_and_down(const std::vector<Step>& steps);

}  // namespace quadsonde::estimator
