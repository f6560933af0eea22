#pragma once
// A calibration from free flights as words.
#include <string>

#include "estimator/calibration/free_flight.h"

namespace quadsonde::product {

/// The answer for a terminal of 80 columns: the flights, the drag with its interval or the reason why not, what the
/// flights determine, and what to fly next.
std::string free_flight_answer(const estimator::FreeFlightCalibration& calibration, const std::string& updates = "");
/// The same for programs: schema quadsonde.calibration/1.
std::string free_flight_json(const estimator::FreeFlightCalibration& calibration);

}  // namespace quadsonde::product
