#pragma once
// Only slow motion tells of drag: velocity and thrust slope averaged alike over windows, as steps for the filter.
// Source: estimator/MODEL.md section 15; design notes, section 12, "Own motion is not wind".
#include <map>
#include <utility>
#include <vector>

#include "estimator/smoother/steps.h"

namespace quadsonde::estimator {

struct SlowSettings {
  double window = 2.2;       ///< [s]: half the power of motion at 0.2 Hz, less of what is faster
  double most_climb = 1;     ///< a window that climbs or sinks faster is left out: there the drag is another [m/s]
  double velocity_sd = 0.1;  ///< where the log states none [m/s]
};

struct SlowSteps {
  std::vector<Step> steps;                    ///< one per window, at its middle
  std::vector<Eigen::Vector2d> acceleration;  ///< of the vehicle, mean over each window [m/s2]
  double attitude_interval = 0.1;
  std::size_t sound = 0;  ///< of them
};

/// A running mean is a linear filter, and the equation of motion is linear up to the bend of the quadratic term: so the
/// means obey it too, the mean velocity with the running mean of the thrust slope as its input. What moves faster than
/// the window drops out of both. A window with a gap, without attitude or climbing fast is not sound, and the filter
/// starts again behind it.
class SlowMotion {
 public:
  /// The flight is tidy, has attitude and velocity, and outlives this.
  SlowMotion(const ingest::Flight& flight, const SlowSettings& settings) : flight_(flight), settings_(settings) {}

  /// @param latency  the attitude is read this much earlier than the velocity [s]
  /// @param drag     weighs a step's input, as its effect decays [1/s]
  /// The answer stands until forget().
  const SlowSteps& steps(double latency, double drag);
  void forget() { made_.clear(), fast_.clear(); }
  const SlowSettings& settings() const { return settings_; }

 private:
  const ingest::Flight& flight_;
  SlowSettings settings_;
  std::map<double, Steps> fast_;                         ///< by latency
  std::map<std::pair<double, double>, SlowSteps> made_;  ///< by latency and drag
};

/// What stands in equation (1) as means over one window, for least squares without a filter.
struct Balance {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();         ///< s (g - vdot_d) [m/s2]
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();  ///< of the vehicle [m/s2]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();      ///< over ground [m/s]
  Eigen::Vector2d nose = Eigen::Vector2d::Zero();          ///< mean of (cos psi, sin psi)
};

/// One balance per window, each window sharing half with the next; those that SlowMotion would call unsound are left
/// out.
std::vector<Balance> force_balances(const ingest::Flight& flight, double latency, double window);

}  // namespace quadsonde::estimator
