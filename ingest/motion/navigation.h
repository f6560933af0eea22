#pragma once
// What the rigid body's autopilot makes of its sensors: an inertial solution, held by the satellite receiver.
#include <Eigen/Core>
#include <deque>

#include "ingest/motion/sensors.h"

namespace quadsonde::ingest {

/// Integrates specific force turned by the measured attitude, and pulls velocity and position to what the receiver says
/// with fixed gains: time constant 0.5 s, or three receiver samples if that is more. A late velocity is compared with
/// the solution of its own instant. Errors of the attitude so enter as accelerations, as they do on board.
class Navigation {
 public:
  /// @param latency  of the receiver's velocity [s]   @param interval  between its samples [s]   @param step  [s]
  Navigation(const Eigen::Vector3d& p, const Eigen::Vector3d& v, double latency, double interval, double step);

  /// @param attitude  as measured
  void update(const Seen& seen, const EulerAngles& attitude);
  /// Starts again at rest: on the ground.
  void rest(const Eigen::Vector3d& p);
  const Eigen::Vector3d& position() const { return p_; }
  const Eigen::Vector3d& velocity() const { return v_; }

 private:
  Eigen::Vector3d p_, v_;
  double step_, gain_;
  std::size_t behind_;
  std::deque<Eigen::Vector3d> past_;  // velocities, the newest last
};

}  // namespace quadsonde::ingest
