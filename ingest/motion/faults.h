#pragma once
// What can be wrong with a log, as maps of its telemetry: each can be undone and committed.
#include <string>
#include <vector>

#include "ingest/motion/telemetry.h"

namespace quadsonde::ingest {

enum class FaultClass {
  rotation,        ///< tilt turned against velocity: 180 sign, 90 axes, small: heading
  reflection,      ///< ENU for NED, axes exchanged, one axis flipped
  velocity_scale,  ///< knots, mph, cm/s
  tilt_scale,      ///< degrees for radians
  yaw_not_applied,
  latency,
  tilt_offset,
  attitude_unrelated,  ///< the tilt does not follow the acceleration, and no map makes it
  vertical_velocity,   ///< against the height
  velocity_against_position,
  frozen_stream,
  zeros_before_fix,
  unexplained  ///< misses by more than noise and turbulence allow, for no reason known here
};

/// "rotation", "velocity scale", ...
std::string name(FaultClass fault);
/// What usually lies behind a fault of this class.
std::vector<std::string> usual_causes(FaultClass fault);

/// How attitude and velocity of a log are read otherwise than they stand.
struct TelemetryMap {
  enum class Turn { once, never, twice };  ///< of the tilt by the heading
  enum class VelocityAxes { earth, heading_to_earth, earth_to_heading };

  Eigen::Matrix2d tilt = Eigen::Matrix2d::Identity();      ///< on (forward, right)
  Eigen::Matrix2d velocity = Eigen::Matrix2d::Identity();  ///< on (north, east)
  double heading_sign = 1, heading_offset = 0;             ///< [rad]
  bool no_heading = false;                                 ///< heading is zero
  Turn turn = Turn::once;
  VelocityAxes axes = VelocityAxes::earth;
  double tilt_scale = 1, heading_scale = 1;
  double velocity_scale = 1;  ///< logged velocity over true one; not applied to the columns
  double latency = 0;         ///< further age of the velocity [s]; not applied to the columns
};

Telemetry mapped(const Telemetry& telemetry, const TelemetryMap& map);

/// One possible fault.
struct FaultCandidate {
  FaultClass fault = FaultClass::unexplained;
  std::string id;        ///< "tilt-sign"
  std::string sentence;  ///< what is wrong, for people
  TelemetryMap undo;
  TelemetryMap commit;
};

/// The discrete ones. Turned, scaled and late readings have a size, which is fitted.
std::vector<FaultCandidate> discrete_faults();
/// Those that a report foretells beside them: latency 0.2 s, heading off by 10 degrees, knots for m/s, degrees for
/// radians.
std::vector<FaultCandidate> typical_faults();

FaultCandidate turned_by(double angle);
FaultCandidate scaled_by(double velocity_over_expected, bool velocity_confirmed_by_position);
FaultCandidate late_by(double seconds);

}  // namespace quadsonde::ingest
