#pragma once
// Inside the shooting: what its two solvers share.
#include <optional>

#include "ingest/motion/shooting.h"

namespace quadsonde::ingest {

/// g - vdot_d of a velocity that is logged `scale` times too large.
double true_lift(double logged_lift, double scale);
DragLaw<double> times_factor(DragLaw<double> law, double log_factor);

/// As closed_form, by the integrator; empty if it gave up.
std::optional<WindowPrediction> by_cvodes(MotionCourse course, const std::vector<double>& times,
                                          const WindowParameters& start, const ShootingPrior& prior,
                                          const Eigen::Vector2d& trim, double drag_log_factor, double velocity_scale);

}  // namespace quadsonde::ingest
