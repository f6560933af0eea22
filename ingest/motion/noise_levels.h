#pragma once
// How noisy velocity and tilt are, measured without any model of the motion.
#include <Eigen/Core>
#include <vector>

namespace quadsonde::ingest {

/// Noise of a column by its differences: whatever moves slowly drops out.
struct DifferenceNoise {
  double sd = 0;  ///< by sixth differences, robust (median)
  /// Variance by sixth over variance by second differences: 1 for white noise, .82 for a random walk, less for
  /// anything smooth. Empty columns give 0.
  double whiteness = 0;
  bool white() const { return sd > 0 && whiteness > 0.9 && whiteness < 1.15; }
};

/// @param time      [s]
/// @param value     one or two axes taken together
/// @param interval  the usual distance of samples [s]; differences over a hole (1.5 intervals) do not count
DifferenceNoise difference_noise(const std::vector<double>& time, const std::vector<Eigen::Vector2d>& value,
                                 double interval);

/// What stands between the equations of motion and the logged velocity.
struct NoiseLevels {
  double velocity_sd = 0.1;        ///< white, per sample and axis [m/s]
  double acceleration_psd = 1e-3;  ///< of tilt errors, g^2 sigma^2 dt for white ones [m2/s3]
  double turbulence_sd = 0.5;      ///< horizontal, per axis, Ornstein-Uhlenbeck [m/s]
  double turbulence_time = 10;     ///< [s]
};

}  // namespace quadsonde::ingest
