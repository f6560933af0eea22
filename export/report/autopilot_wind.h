#pragma once
// The wind that the autopilot itself estimated, beside ours. It is shown, and never an input of ours.
#include <Eigen/Core>
#include <optional>
#include <string>

#include "estimator/smoother/wind_series.h"
#include "export/csv/json.h"
#include "ingest/flight/flight.h"

namespace quadsonde::product {

/// Means over the instants of our series at which the autopilot's last word was at most 2 s old.
struct AutopilotComparison {
  std::string source;  ///< as the log calls it
  std::size_t instants = 0;
  Eigen::Vector2d theirs = Eigen::Vector2d::Zero(), ours = Eigen::Vector2d::Zero();  ///< v_NA_N, N and E [m/s]
  double difference_rms = 0;                                                         ///< of the vector [m/s]
};

/// Empty where the log holds no wind of the autopilot, or none at an instant of ours.
std::optional<AutopilotComparison> beside_autopilot(const ingest::Flight& flight, const estimator::WindSeries& ours);

/// The mean of all that the autopilot said; empty where it said nothing.
std::optional<Eigen::Vector2d> mean_autopilot_wind(const ingest::Flight& flight);

/// "The autopilot's own wind: 1.8 m/s from 73 deg (east-northeast); ours at the same instants ..."
std::string autopilot_sentence(const AutopilotComparison& comparison);

/// Components, speed and direction of both; null where there is nothing to compare.
Json json_autopilot(const std::optional<AutopilotComparison>& comparison);

}  // namespace quadsonde::product
