#pragma once
// A calibration in a known wind as pictures and as words.
#include <string>

#include "estimator/calibration/tunnel.h"

namespace quadsonde::product {

/// SVG text, 900 wide: for each run pitch and roll against the heading, with the run's own sinusoids. At most some 240
/// points of each run are drawn, each one that was measured. Cannot fail.
std::string tunnel_tilt_svg(const estimator::TunnelCalibration& calibration);

/// SVG text, 900 by 480: the drag per mass and the drag coefficient against the airspeed; the law with its 95 % band,
/// and what each run shows by itself with the 95 % that its stated wind leaves open. Cannot fail.
std::string tunnel_drag_svg(const estimator::TunnelCalibration& calibration);

/// The answer for a terminal of 80 columns: the runs, the law with its uncertainty, the speeds left out, the ends of
/// all starts.
std::string tunnel_answer(const estimator::TunnelCalibration& calibration);
/// The same for programs: schema quadsonde.calibration/1.
std::string tunnel_json(const estimator::TunnelCalibration& calibration);

}  // namespace quadsonde::product
