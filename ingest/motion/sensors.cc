#include "ingest/motion/sensors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ingest/motion/drag.h"

namespace quadsonde::ingest {
namespace {

constexpr double degree = std::numbers::pi / 180;

enum Purpose : std::uint64_t {
  tilt,
  heading_error,
  velocity,
  height,
  barometer,
  accelerometer,
  gyro,
  receiver,
  log_file
};

/// Three normal numbers; the first drawn is the last axis.
Eigen::Vector3d normal(Gaussian& noise) {
  Eigen::Vector3d v;
  for (const int axis : {2, 1, 0}) v(axis) = noise();
  return v;
}

/// ISO 2533, troposphere.
double standard_pressure(double height_msl) { return 101325 * std::pow(1 - 2.25577e-5 * height_msl, 5.25588); }

}  // namespace

Sensors::Interruption::Interruption(DropOuts dropouts, std::uint64_t seed)
    : model(dropouts), noise(seed), from(0), to(0) {
  from = to = model.per_hour > 0 ? -std::log(noise.uniform()) * 3600 / model.per_hour : 1e300;
  if (model.per_hour > 0) to = from - std::log(noise.uniform()) * model.mean_length;
}

bool Sensors::Interruption::at(double time) {
  while (time >= to) {
    from = to - std::log(noise.uniform()) * 3600 / model.per_hour;
    to = from - std::log(noise.uniform()) * model.mean_length;
  }
  return time >= from;
}

Sensors::Sensors(const SensorModel& model, GeoPoint site, MslHeight site_height, double step, std::uint64_t seed,
                 Gaussian& noise)
    : model_(model),
      site_height_(site_height.m),
      step_(step),
      frame_(site, site_height.m),
      noise_(noise),
      attitude_every_(every(model.attitude_rate)),
      velocity_every_(every(model.velocity_rate)),
      position_every_(every(model.position_rate)),
      roll_error_(model.tilt_sd_deg, model.tilt_correlation, attitude_every_ * step, noise),
      pitch_error_(model.tilt_sd_deg, model.tilt_correlation, attitude_every_ * step, noise),
      tilt_noise_(seed_for(seed, tilt)),
      heading_noise_(seed_for(seed, heading_error)),
      velocity_noise_(seed_for(seed, velocity)),
      height_noise_(seed_for(seed, height)),
      barometer_noise_(seed_for(seed, barometer)),
      accelerometer_noise_(seed_for(seed, accelerometer)),
      gyro_noise_(seed_for(seed, gyro)),
      roll_wander_(model.tilt_wander_deg, model.tilt_wander_time, attitude_every_ * step, tilt_noise_),
      pitch_wander_(model.tilt_wander_deg, model.tilt_wander_time, attitude_every_ * step, tilt_noise_),
      heading_wander_(model.heading_wander_deg, model.heading_wander_time, attitude_every_ * step, heading_noise_),
      north_wander_(model.velocity_wander, model.velocity_wander_time, velocity_every_ * step, velocity_noise_),
      east_wander_(model.velocity_wander, model.velocity_wander_time, velocity_every_ * step, velocity_noise_),
      down_wander_(model.velocity_wander, model.velocity_wander_time, velocity_every_ * step, velocity_noise_),
      height_wander_(model.height_wander, model.height_wander_time, position_every_ * step, height_noise_),
      receiver_(model.receiver, seed_for(seed, receiver)),
      log_(model.log, seed_for(seed, log_file)) {}

int Sensors::every(double rate) const {
  return std::max(1, static_cast<int>(std::lround(1 / ((rate > 0 ? rate : model_.output_rate) * step_))));
}

bool Sensors::observe(int tick, const Motion& motion, Flight& flight) {
  past_.push_back(motion.v);
  const auto behind = static_cast<std::size_t>(std::lround(model_.latency / step_));
  while (past_.size() > behind + 1) past_.pop_front();
  const LogTime time{static_cast<std::int64_t>(tick) * static_cast<std::int64_t>(std::lround(step_ * 1e9))};
  const bool silent = log_.at(tick * step_), blind = receiver_.at(tick * step_);
  if (silent && !silent_since_) silent_since_ = time;
  if (!silent && silent_since_) {
    flight.gaps.push_back({*silent_since_, time});
    silent_since_.reset();
  }
  seen_.velocity_is_new = seen_.position_is_new = false;
  seen_.force = measured_force(motion);
  if (tick % attitude_every_ == 0) observe_attitude(time, motion, !silent, flight);
  const bool due = tick % velocity_every_ == 0;
  if (due) observe_velocity(time, motion, !silent && !blind, flight);
  if (tick % position_every_ == 0) observe_position(time, motion, !silent && !blind, flight);
  if (blind) seen_.velocity_is_new = seen_.position_is_new = false;
  if (!silent) observe_others(tick, time, motion, flight);
  return due;
}

EulerAngles Sensors::measured(const EulerAngles& attitude) const {
  return {attitude.roll + attitude_error_.roll, attitude.pitch + attitude_error_.pitch,
          attitude.yaw + attitude_error_.yaw};
}

void Sensors::observe_attitude(LogTime time, const Motion& motion, bool logged, Flight& flight) {
  attitude_error_.roll = (model_.trim_roll_deg + roll_error_.next()) * degree;
  attitude_error_.pitch = (model_.trim_pitch_deg + pitch_error_.next()) * degree;
  attitude_error_.yaw = model_.heading_error_deg * degree;
  if (model_.tilt_wander_deg > 0) {
    attitude_error_.roll += roll_wander_.next() * degree;
    attitude_error_.pitch += pitch_wander_.next() * degree;
  }
  if (model_.heading_wander_deg > 0) attitude_error_.yaw += heading_wander_.next() * degree;
  if (logged) flight.attitude.push(time, q_NB_from_euler(measured(motion.attitude)));
}

void Sensors::observe_velocity(LogTime time, const Motion&, bool logged, Flight& flight) {
  Eigen::Vector3d v = past_.front() + model_.velocity_sd * normal(noise_);
  if (model_.velocity_wander > 0) {
    v.x() += north_wander_.next();
    v.y() += east_wander_.next();
    v.z() += down_wander_.next();
  }
  v += model_.velocity_bias;
  seen_.velocity = v;
  seen_.velocity_is_new = true;
  if (!logged) return;
  flight.velocity.push(time, v);
  flight.velocity.sd.push_back(model_.velocity_sd);
}

void Sensors::observe_position(LogTime time, const Motion& motion, bool logged, Flight& flight) {
  Eigen::Vector3d p = motion.p;
  for (const int axis : {1, 0}) p(axis) += model_.position_sd * noise_();
  double height = site_height_ - motion.p.z() + model_.height_sd * noise_();
  if (model_.height_wander > 0) height += height_wander_.next();
  seen_.position = {p.x(), p.y(), site_height_ - height};
  seen_.position_is_new = true;
  if (!logged) return;
  flight.position.push(time, frame_.from_ned(p).first);
  flight.height_msl.push(time, MslHeight{height});
}

void Sensors::observe_others(int tick, LogTime time, const Motion& motion, Flight& flight) {
  const auto due = [&](double rate) { return rate > 0 && tick % every(rate) == 0; };
  if (due(model_.barometer_rate)) {
    const double interval = every(model_.barometer_rate) * step_;
    barometer_error_ += model_.barometer_walk * std::sqrt(interval / 3600) * barometer_noise_();
    const double height = site_height_ - motion.p.z() + barometer_error_ +
                          model_.barometer_drift_per_hour * to_seconds(time - LogTime{}) / 3600 +
                          model_.barometer_sd * barometer_noise_();
    flight.barometer.push(time, {standard_pressure(height), height});
  }
  if (due(model_.accelerometer_rate)) flight.accelerometer.push(time, seen_.force);
  if (due(model_.rotor_rate) && !motion.rotors_rpm.empty()) flight.rotors.push(time, motion.rotors_rpm);
  if (model_.landed_state && (flight.landed.empty() || flight.landed.value.back() != motion.on_ground))
    flight.landed.push(time, motion.on_ground);
}

Eigen::Vector3d Sensors::measured_force(const Motion& motion) {
  // The measuring unit stands on the body as the trim says; the rotor plane is the body's.
  const auto q_NU = q_NB_from_euler({motion.attitude.roll + model_.trim_roll_deg * degree,
                                     motion.attitude.pitch + model_.trim_pitch_deg * degree, motion.attitude.yaw});
  Eigen::Vector3d force = q_NU.inverse() * motion.force_N + model_.accelerometer_bias;
  if (model_.accelerometer_sd > 0) force += model_.accelerometer_sd * normal(accelerometer_noise_);
  return force;
}

Eigen::Vector3d Sensors::measured_rate(const Eigen::Vector3d& omega_B) {
  if (model_.gyro_sd_deg_s <= 0) return omega_B;
  return omega_B + model_.gyro_sd_deg_s * degree * normal(gyro_noise_);
}

Eigen::Vector3d Sensors::measured_velocity(const Eigen::Vector3d& v) { return v + model_.velocity_sd * normal(noise_); }

}  // namespace quadsonde::ingest
