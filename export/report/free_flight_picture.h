#pragma once
// A calibration from free flights as a picture.
#include <string>

#include "estimator/calibration/free_flight.h"

namespace quadsonde::product {

/// SVG text, 900 by 480: the drag coefficient against the airspeed. The law with its 95 % band where it was flown, the
/// law and band of what was known before (a class, or the vehicle file that was updated), what least squares without a
/// law say, each assumption on the noise, and each flight by itself where there are several, all with 95 %. Where the
/// calibration was refused, what the flights seemed to say is drawn and called so. Cannot fail.
/// @param prior  what was known beforehand
std::string free_flight_drag_svg(const estimator::FreeFlightCalibration& calibration, const ingest::Vehicle& prior);

}  // namespace quadsonde::product
