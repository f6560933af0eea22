#pragma once
// Drag by least squares without the filter and without a drag law given beforehand: what the calibration must agree
// with. Source: design notes, section 5, "Referee without drag law".
#include <optional>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/motion/drag.h"

namespace quadsonde::estimator {

struct Referee {
  double drag = 0, drag_sd = 0;       ///< c at that airspeed and the air density of the law [1/s]
  double latency = 0;                 ///< at which the residual is least [s]
  double airspeed = 0;                ///< mean weighed by its square [m/s]
  double residual_rms = 0;            ///< of the force balance [m/s2]
  std::vector<Eigen::Vector2d> wind;  ///< of each flight, N and E [m/s]
  std::size_t windows = 0;
};

struct RefereeFlight {
  const ingest::Flight* flight = nullptr;
  double drag_scale = 1;  ///< of the flight's drag to that of the law, by the air density
  bool turned = true;     ///< else its trim is left at zero
};

/// Means over 3 s: s (g - vdot_d) - vdot = f(|a|) a - R(psi) b, a = v - w, with f a straight line, and for each flight
/// a constant wind and a trim. The tilt is regressed on the velocity, never the other way round: errors in the velocity
/// would shrink the drag. The latency is that of the least residual. Empty with less than ten windows or no minimum.
/// @param latency  [s] about which, by a tenth of a second, the least residual is looked for; empty: from -0.3 to 0.7
std::optional<Referee> judge_without_law(const std::vector<RefereeFlight>& flights,
                                         std::optional<double> latency = std::nullopt);

}  // namespace quadsonde::estimator
