#pragma once
// Ascents, descents and what is neither, found from the height's course.
#include <optional>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "profiles/profile.h"

namespace quadsonde::profiles {

enum class Part : std::uint8_t { up, down, level };

struct LegSettings {
  double climb_rate = 0.2;     ///< slower is level [m/s]
  double smoothing = 4;        ///< the climb rate is averaged over so long [s]
  double longest_pause = 90;   ///< a stop between two parts of one direction belongs to them [s]
};

/// Climb rates of points that were told none, by central differences of their heights; 0 where a neighbour has no height.
void add_climb_rates(std::vector<estimator::WindPoint>& points, const std::vector<std::optional<double>>& heights);

/// One part for each point: climb rates averaged, wobbles smaller than least_extent [m] levelled out, pauses between
/// two climbs of one direction counted as theirs.
/// @param heights  per point; empty ones keep the part of the point before
std::vector<Part> find_parts(const std::vector<estimator::WindPoint>& points,
                             const std::vector<std::optional<double>>& heights, double least_extent,
                             const LegSettings& settings = {});

/// Parts as the user names them: "up 10-130, down 150-270" in seconds of the log's clock; the rest is level.
/// Kind::usage where the text cannot be read or an interval holds no point.
ingest::Result<std::vector<Part>> named_parts(const std::vector<estimator::WindPoint>& points, const std::string& text);

/// A flight without a leg is a profile of little: what it lacks and what would be one; empty where there is a leg.
std::optional<ingest::Problem> note_no_climb(const std::vector<Part>& parts,
                                             const std::vector<std::optional<double>>& heights, double bin_m);

/// What the vehicle did, one leg after the other. Level parts are told apart by the speed over ground where the
/// smoother's steps are there: hovering below 0.5 m/s, a transit if the way leads straight on, else a level leg.
std::vector<FoundLeg> found_legs(const estimator::WindSeries& series, const std::vector<Part>& parts,
                                 const std::vector<std::optional<double>>& heights);

}  // namespace quadsonde::profiles
