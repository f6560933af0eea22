#pragma once
// What of a log contradicts itself without any drag law: velocity against position and height, values that stand still.
#include <optional>

#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

/// Change of position = map * integral of the logged velocity, over stretches of some seconds.
struct VelocityAgainstPosition {
  Eigen::Matrix2d map = Eigen::Matrix2d::Identity();  ///< 1 where the two agree
  double sd = 0;                                      ///< of its elements
};
/// Empty without both, where the velocity was made of the position, or where the flight moves too little to tell.
std::optional<VelocityAgainstPosition> velocity_against_position(const Flight& flight);

/// Change of height = - slope * integral of the logged down velocity.
struct VerticalAgainstHeight {
  double slope = 1, sd = 0;
  double travel = 0;  ///< rms of the change within a stretch [m]
};
std::optional<VerticalAgainstHeight> vertical_against_height(const Flight& flight);

/// A stretch in which a stream repeats one value that it leaves by a leap, or never leaves: a coarse step of the
/// values that a still vehicle repeats is not meant.
struct FrozenStretch {
  std::string stream;
  double from = 0, to = 0;  ///< [s] since the first velocity sample
};
std::vector<FrozenStretch> frozen_stretches(const Flight& flight, double longer_than);

/// Seconds of exact zeros that the velocity begins with, the vehicle's attitude moving or not. 0 if none.
double leading_zeros(const Flight& flight);

}  // namespace quadsonde::ingest
