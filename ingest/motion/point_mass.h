#pragma once
// A point mass in the wind under the controller of the gates: the minimum that the estimator's gates ask for.
// Source: design notes, section 10.
#include <Eigen/Core>

#include "ingest/flight/rotation.h"
#include "ingest/motion/drag.h"
#include "ingest/motion/path.h"

namespace quadsonde::ingest {

/// Position, velocity, thrust slope behind its command.
struct PointMass {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();  ///< NED
  Eigen::Vector3d vdot = Eigen::Vector3d::Zero();
  Eigen::Vector2d s = Eigen::Vector2d::Zero();
};

/// Position and velocity loops: 2.0 on velocity, 1.2 on position, an integral of 0.5; 7 m/s2 at most.
class PointMassController {
 public:
  /// @param integral  acceleration that it begins with: a vehicle that has been flying leans into its wind already
  PointMassController(const Eigen::Vector2d& integral, double step) : integral_(integral), step_(step) {}
  Eigen::Vector3d acceleration(const Wish& wish, const Eigen::Vector3d& p, const Eigen::Vector3d& v);
  void forget() { integral_.setZero(); }

 private:
  Eigen::Vector2d integral_;
  double step_;
};

/// One step by equation (1), the tilt 0.15 s behind its command, the vertical acceleration as wanted.
void advance(PointMass& body, const Eigen::Vector3d& wanted, const Eigen::Vector3d& v_NA_N, const DragLaw<double>& law,
             double step);

/// The attitude whose thrust has slope s.
EulerAngles attitude_of(const Eigen::Vector2d& s, double yaw);

}  // namespace quadsonde::ingest
