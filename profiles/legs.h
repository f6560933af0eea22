#pragma once
// Ascents, descents and what is neither, found from the height's course.
#include <optional>
#include <vector>

#include "estimator/smoother/wind_series.h"

namespace quadsonde::profiles {

enum class Part : std::uint8_t { up, down, level };

struct LegSettings {
  double climb_rate = 0.2;     ///< slower is level [m/s]
  double smoothing = 4;        ///< the climb rate is averaged over so long [s]
  double longest_pause = 90;   ///< a stop between two parts of one direction belongs to them [s]
};

/// One part for each point: climb rates averaged, wobbles smaller than least_extent [m] levelled out, pauses between
/// two climbs of one direction counted as theirs.
/// @param heights  per point; empty ones keep the part of the point before
std::vector<Part> find_parts(const std::vector<estimator::WindPoint>& points,
                             const std::vector<std::optional<double>>& heights, double least_extent,
                             const LegSettings& settings = {});

}  // namespace quadsonde::profiles
