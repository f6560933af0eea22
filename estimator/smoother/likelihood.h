#pragma once
// What a flight's own likelihood decides: the level of the turbulence and, where both legs are flown, the climb law.
#include "estimator/smoother/passes.h"

namespace quadsonde::estimator {

/// sigma_u that maximises the likelihood of the innovations at fixed T_L [m/s], between 0.03 and 4.
double most_likely_turbulence(const std::vector<Step>& steps, PassSettings settings);

/// Scale of the velocity's variance that maximises the likelihood, 1 to 100: for a velocity whose noise nobody states.
double most_likely_velocity_scale(const std::vector<Step>& steps, PassSettings settings);

/// alpha [s/m] and g2 [s2/m2] with their covariance.
struct ClimbLaw {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

/// What a flight can tell of the climb law. Source: MODEL.md section 9.
enum class ClimbEvidence {
  none,
  both_legs,    ///< ascent and descent over common heights: alpha
  with_pauses   ///< and stops between them: g2 too; without stops a free even part is spurious
};
ClimbEvidence climb_evidence(const std::vector<Step>& steps);

/// The climb law of maximum posterior, covariance from the curvature.
ClimbLaw most_likely_climb_law(const std::vector<Step>& steps, PassSettings settings, const ClimbLaw& prior,
                               ClimbEvidence evidence);

}  // namespace quadsonde::estimator
