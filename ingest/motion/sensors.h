#pragma once
// From the true motion to what a log would hold: rates, noise, bias, latency, drop-outs.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/flight/local_frame.h"
#include "ingest/flight/rotation.h"
#include "ingest/motion/random.h"

namespace quadsonde::ingest {

/// Times without data, at random: exponential in their distance and in their length.
struct DropOuts {
  double per_hour = 0;
  double mean_length = 2;  ///< [s]
};

/// Rates [Hz] are divisors of 100. What is zero is not there.
struct SensorModel {
  double output_rate = 10;                                            ///< of every stream that names no rate of its own
  double attitude_rate = 0;                                           ///< 0 = as output_rate
  double velocity_rate = 0, position_rate = 0;                        ///< position and height; 0 = as output_rate
  double barometer_rate = 0, accelerometer_rate = 0, rotor_rate = 0;  ///< 0 = not logged
  bool landed_state = false;                                          ///< log whether the vehicle stands on the ground

  double tilt_sd_deg = 0.5, tilt_correlation = 0;     ///< per sample and white when the correlation time [s] is 0
  double tilt_wander_deg = 0, tilt_wander_time = 10;  ///< a second, correlated error beside it
  double heading_error_deg = 0;                       ///< constant
  double heading_wander_deg = 0, heading_wander_time = 30;
  double trim_roll_deg = 0.5, trim_pitch_deg = -0.3;  ///< what the log shows in a calm hover

  double velocity_sd = 0.1;                                 ///< white
  double velocity_wander = 0, velocity_wander_time = 10;    ///< correlated, per axis [m/s]
  Eigen::Vector3d velocity_bias = Eigen::Vector3d::Zero();  ///< NED [m/s]
  double latency = 0;                                       ///< the velocity is this old when it is logged [s]
  double position_sd = 0.5;
  double height_sd = 0.3;
  double height_wander = 0, height_wander_time = 60;  ///< of a satellite height [m]

  double barometer_sd = 0.1;                                     ///< [m]
  double barometer_drift_per_hour = 0;                           ///< [m/h]
  double barometer_walk = 0;                                     ///< random walk [m per root hour]
  double accelerometer_sd = 0;                                   ///< [m/s2]
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< in B [m/s2]
  double gyro_sd_deg_s = 0;  ///< what the rigid body's controller sees; never logged

  DropOuts receiver;  ///< no velocity, position, height: the vehicle has none either
  DropOuts log;       ///< nothing is logged, and the log says so; the vehicle flies on

  /// The point mass: its controller sees the noise of the velocity. The rigid body always flies on what it measures.
  bool controller_flies_on_measured = false;
};

/// The truth at one instant, whatever flies.
struct Motion {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();  ///< NED from the take-off point
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  ///< specific force: acceleration without gravity [m/s2]
  EulerAngles attitude;
  RotorSpeeds rotors_rpm;  ///< empty: not known
  bool on_ground = false;
};

/// What the vehicle itself gets to know at one instant.
struct Seen {
  bool velocity_is_new = false, position_is_new = false;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< as old as the latency
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< NED
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< in the axes of the measuring unit, which the trim tilts [m/s2]
};

/// Measures tick by tick. Every error beside those of the first gates has a random stream of its own, so that what a
/// scenario does not ask for changes nothing.
class Sensors {
 public:
  /// @param noise  shared with the turbulence, in the order of the first gates
  Sensors(const SensorModel& model, GeoPoint site, MslHeight site_height, double step, std::uint64_t seed,
          Gaussian& noise);

  /// Logs what is due at this tick. @return true where the velocity was due, logged or not.
  bool observe(int tick, const Motion& motion, Flight& flight);
  const Seen& seen() const { return seen_; }

  /// The attitude as the vehicle takes it to be, with the errors of the last attitude sample.
  EulerAngles measured(const EulerAngles& attitude) const;
  /// Turn rate in B with the gyro's noise [rad/s].
  Eigen::Vector3d measured_rate(const Eigen::Vector3d& omega_B);
  /// For the point mass's controller: the velocity with noise of its own.
  Eigen::Vector3d measured_velocity(const Eigen::Vector3d& v);

 private:
  int every(double rate) const;
  void observe_attitude(LogTime time, const Motion& motion, bool logged, Flight& flight);
  void observe_velocity(LogTime time, const Motion& motion, bool logged, Flight& flight);
  void observe_position(LogTime time, const Motion& motion, bool logged, Flight& flight);
  Eigen::Vector3d measured_force(const Motion& motion);
  void observe_others(int tick, LogTime time, const Motion& motion, Flight& flight);

  /// On and off at random times.
  struct Interruption {
    Interruption(DropOuts model, std::uint64_t seed);
    bool at(double time);  ///< times in order
    DropOuts model;
    Gaussian noise;
    double from, to;
  };

  SensorModel model_;
  double site_height_, step_;
  LocalFrame frame_;
  Gaussian& noise_;
  int attitude_every_, velocity_every_, position_every_;
  OrnsteinUhlenbeck roll_error_, pitch_error_;
  Gaussian tilt_noise_, heading_noise_, velocity_noise_, height_noise_, barometer_noise_, accelerometer_noise_,
      gyro_noise_;
  OrnsteinUhlenbeck roll_wander_, pitch_wander_, heading_wander_, north_wander_, east_wander_, down_wander_,
      height_wander_;
  Interruption receiver_, log_;
  std::optional<LogTime> silent_since_;
  EulerAngles attitude_error_;
  double barometer_error_ = 0;
  std::deque<Eigen::Vector3d> past_;
  Seen seen_;
};

}  // namespace quadsonde::ingest
