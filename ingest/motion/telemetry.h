#pragma once
// What the consistency check reads of a flight: tilt, heading and velocity as plain columns, cut into windows.
#include <Eigen/Core>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/motion/integrator.h"

namespace quadsonde::ingest {

/// Seconds since the first velocity sample. Attitude faster than 50 Hz and velocity faster than 10 Hz are averaged,
/// not decimated: the motion of interest is slower, and vibration must not alias into it.
struct Telemetry {
  std::vector<double> attitude_time;
  std::vector<Eigen::Vector2d> tilt;   ///< thrust slope, heading axes (forward, right)
  std::vector<double> heading;         ///< unwrapped [rad]
  std::vector<Eigen::Vector2d> slope;  ///< thrust slope, N and E
  double steep = 0;                    ///< part of the attitude samples tilted beyond 60 degrees

  std::vector<double> velocity_time;
  std::vector<Eigen::Vector2d> v;  ///< v_NB_N, N and E [m/s]
  std::vector<double> v_down;      ///< [m/s]
  std::vector<double> vdot_down;   ///< its slope over a second [m/s2]

  double attitude_interval = 0.1, velocity_interval = 0.1;  ///< medians [s]

  double duration() const { return velocity_time.empty() ? 0 : velocity_time.back(); }
};

Telemetry telemetry_of(const Flight& flight);

/// Slope of the down velocity: a straight line through the samples of a second around each.
std::vector<double> smoothed_slope(const std::vector<double>& time, const std::vector<double>& value);

/// Turns slopes and velocities by a heading, and back.
Eigen::Vector2d turned(const Eigen::Vector2d& in_heading_axes, double heading);
/// Linear interpolation; held beyond the ends. `time` is not empty.
double interpolated(const std::vector<double>& time, const std::vector<double>& value, double t);

/// One window: the velocity samples first to last, both included.
struct ShootingWindow {
  std::size_t first = 0, last = 0;
  std::size_t samples() const { return last - first + 1; }
};

/// Windows of about `length` seconds that no hole in velocity or attitude cuts, of equal length within each unbroken
/// stretch; stretches shorter than half a window are left out. At most `most`, evenly spread over the flight.
std::vector<ShootingWindow> shooting_windows(const Telemetry& telemetry, double length, std::size_t most);

/// The course over a window, in seconds since its first sample, the attitude read `latency` before the velocity.
MotionCourse course_of(const Telemetry& telemetry, const ShootingWindow& window, double latency, double gravity);

}  // namespace quadsonde::ingest
