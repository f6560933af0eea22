#pragma once
#include <Eigen/Core>
#include <vector>

#include "ingest/flight/height.h"
#include "ingest/flight/time.h"

namespace quadsonde::ingest {

/// The wind that was really there, at the vehicle: only a simulator knows it.
struct TruthWind {
  LogTime time;
  GroundHeight height;
  Eigen::Vector3d v_NA_N = Eigen::Vector3d::Zero();  ///< velocity of the air over ground, NED [m/s]
};
using Truth = std::vector<TruthWind>;

}  // namespace quadsonde::ingest
