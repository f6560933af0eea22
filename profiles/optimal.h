#pragma once
// The mean wind as a function of height, estimated in one filter with everything else, instead of bin means.
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimator/smoother/passes.h"

namespace quadsonde::profiles {

struct NodeSettings {
  double lowest = 5;       ///< height of the first node [m]
  double spacing = 10;     ///< [m]
  std::size_t count = 1;
  double level_sd = 10;    ///< of the wind before any data, the same at all heights [m/s]
  double height_psd = 0.02;  ///< random walk with height [m2/s2 per metre]
};

struct NodeEstimate {
  Eigen::Matrix2Xd wind;      ///< a column per node: north, east [m/s]
  Eigen::MatrixXd covariance; ///< 2 count x 2 count: node by node, north, east; drag, latency and heading as known
  Eigen::MatrixXd kernel;     ///< averaging kernel A = I - C C_prior^-1, count x count, mean of both components
  /// Height over which a node is an average: (row sum)^2 / (row sum of squares) x spacing [m].
  double resolution(std::size_t node, double spacing) const;
};

/// w(z) piecewise linear between nodes, constant beyond the outer ones; turbulence, velocity and trim as in the
/// filter. The nodes are static states, so the filter's end is the exact posterior: change of the mean wind in time
/// within the flight is not in the model. The step of one node costs O(count^2).
/// @param heights  of each point of the series, in the datum of the nodes; steps without one are predicted over
/// Source: estimator/MODEL.md section 12; Rodgers (2000) for kernel and degrees of freedom.
NodeEstimate estimate_nodes(const estimator::SmootherTrace& trace, const std::vector<std::optional<double>>& heights,
                            const NodeSettings& settings);

}  // namespace quadsonde::profiles
