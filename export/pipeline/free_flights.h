#pragma once
// Calibration from free flights, from logs to VEHICLE.toml.
#include <filesystem>
#include <optional>
#include <vector>

#include "estimator/calibration/free_flight.h"
#include "export/pipeline/control.h"
#include "export/pipeline/settings.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

struct FreeFlightsRequest {
  std::vector<std::filesystem::path> logs;
  std::optional<std::filesystem::path> output;  ///< VEHICLE.toml; none: nothing is written
  InputSettings input;
  FlightChoice flight;  ///< by itself all flights of each log
  DragSettings drag;    ///< auto: from nothing; a file: it is updated. The mass is that while calibrating
  bool overwrite = false;
};

struct FreeFlightsResult {
  estimator::FreeFlightCalibration calibration;  ///< with logs, creation time and version in its vehicle
  std::string updates;                           ///< the vehicle file that was updated; may be empty
  ingest::Vehicle prior;                         ///< what was known before
  std::vector<ingest::Problem> problems;         ///< of the logs, then the calibration's notes
  std::vector<std::filesystem::path> files;      ///< written; empty where the calibration was refused
};

/// Do flights of one vehicle seem to be of several? Each flight's own drag against the mean of all, with its own sd and
/// 10 % of variation between flights (7 to 15 % were recorded of one vehicle from day to day); below a probability of
/// 1 in 1000 the sentence, without full stop, says who differs from whom. Empty with fewer than two drags.
std::optional<std::string> different_drags(const std::vector<estimator::FreeFlightRun>& runs);

/// Beside VEHICLE.toml goes VEHICLE_drag.svg. The whole job: each log is read and checked first. Kind::inconsistent for a log whose telemetry contradicts itself
/// (a latency, which the calibration finds, and a wrong trim aside), Kind::usage for logs of different vehicles; else
/// it fails as the readers do, and when an output is there already (unless overwrite), cannot be written, or the work
/// is stopped. Flights that cannot tell the drag are no failure: `refused` of the calibration says why.
ingest::Result<FreeFlightsResult> run_free_flights(const FreeFlightsRequest& request, const Control& control = {});

}  // namespace quadsonde::product
