// PX4's messages as its bridge publishes them in ROS 2. Frames as in a ULog: NED and FRD, quaternions w first and body
// to NED. Source: PX4-Autopilot msg/*.msg, versions 1.12 to 1.15; what they mean is told in ingest/ulog/topics_*.cc.
#include <cmath>
#include <map>

#include "ingest/mcap/foreign_rules.h"

namespace quadsonde::ingest::foreign {
namespace {

bool flag_at(const Json& m, const char* name, bool absent) {
  const auto value = number_at(m, name);
  return value ? *value != 0 : absent;
}

std::optional<double> finite_at(const Json& m, std::string_view name) {
  const auto value = number_at(m, name);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<Eigen::Vector3d> three_of(const Json& m, const char* a, const char* b, const char* c) {
  const auto x = finite_at(m, a), y = finite_at(m, b), z = finite_at(m, c);
  if (!x || !y || !z) return std::nullopt;
  return Eigen::Vector3d(*x, *y, *z);
}

std::optional<Eigen::Quaterniond> attitude_of(const Json& m) {
  const auto v = three_of(m, "q[1]", "q[2]", "q[3]");
  const auto w = finite_at(m, "q[0]");
  if (!v || !w) return std::nullopt;
  const Eigen::Quaterniond q(*w, v->x(), v->y(), v->z());
  return q.norm() > 0.5 ? std::optional(q) : std::nullopt;
}

/// The autopilot's timestamp [us], where the bridge keeps it on the clock of the log (UTC, by default); else arrival.
LogTime stamped(LogTime log_time, const Json& m) {
  constexpr double kClose = 10;  // [s]
  const auto us = number_at(m, "timestamp");
  if (!us || !(*us > 0 && *us < 9e15)) return log_time;
  const LogTime stated{static_cast<std::int64_t>(*us) * 1000};
  return std::abs(to_seconds(stated - log_time)) < kClose ? stated : log_time;
}

/// Either every sample of a velocity states its noise or none.
void push_velocity(LogTime t, const Eigen::Vector3d& v, std::optional<double> sd, VelocityStream& stream) {
  const bool known = sd && *sd > 0 && *sd < 1e3 && stream.sd.size() == stream.size();
  stream.push(t, v);
  if (known)
    stream.sd.push_back(*sd);
  else
    stream.sd.clear();
}

void vehicle_attitude(LogTime t, const Json& m, Part& part) {
  if (const auto q = attitude_of(m)) part.flight.attitude.push(t, *q);
}

void vehicle_local_position(LogTime t, const Json& m, Part& part) {
  auto& f = part.flight;
  if (flag_at(m, "xy_valid", true) && flag_at(m, "z_valid", true))
    if (const auto p = three_of(m, "x", "y", "z")) f.local_position.push(t, *p);
  if (!flag_at(m, "v_xy_valid", true) || !flag_at(m, "v_z_valid", true)) return;
  const auto v = three_of(m, "vx", "vy", "vz");
  if (!v) return;
  f.velocity.origin = VelocityOrigin::fused;
  push_velocity(t, *v, number_at(m, "evh"), f.velocity);
}

void vehicle_global_position(LogTime t, const Json& m, Part& part) {
  const auto lat = finite_at(m, "lat"), lon = finite_at(m, "lon"), h = finite_at(m, "alt");
  if (!flag_at(m, "lat_lon_valid", true) || !lat || !lon) return;
  part.flight.position.push(t, {*lat, *lon});
  if (h && flag_at(m, "alt_valid", true)) part.flight.height_msl.push(t, {*h});
}

/// Degrees and metres from 1.15 on, 1e-7 degrees and millimetres before.
std::optional<double> either(const Json& m, const char* new_name, const char* old_name, double scale) {
  if (const auto value = number_at(m, new_name)) return finite_at(m, new_name);
  const auto old = finite_at(m, old_name);
  return old ? std::optional(*old * scale) : std::nullopt;
}

/// s_variance_m_s is a standard deviation [m/s] despite its name.
void sensor_gps(LogTime t, const Json& m, Part& part) {
  auto& f = part.flight;
  if (number_at(m, "fix_type").value_or(0) < 3) return;
  const auto lat = either(m, "latitude_deg", "lat", 1e-7), lon = either(m, "longitude_deg", "lon", 1e-7);
  if (lat && lon) f.position.push(t, {*lat, *lon});
  if (const auto h = either(m, "altitude_msl_m", "alt", 1e-3)) f.height_msl.push(t, {*h});
  // Drivers that do not know it leave exactly zero.
  if (const auto h = either(m, "altitude_ellipsoid_m", "alt_ellipsoid", 1e-3); h && *h != 0)
    f.height_ellipsoid.push(t, {*h});
  const auto v = three_of(m, "vel_n_m_s", "vel_e_m_s", "vel_d_m_s");
  if (!v || !flag_at(m, "vel_ned_valid", true)) return;
  f.velocity.origin = VelocityOrigin::receiver;
  push_velocity(t, *v, number_at(m, "s_variance_m_s"), f.velocity);
}

/// pose_frame and velocity_frame: 1 NED; a velocity may stand in 3 BODY_FRD. A frame of unknown heading (2) says
/// nothing about north.
void vehicle_odometry(LogTime t, const Json& m, Part& part) {
  constexpr double kNed = 1, kBodyFrd = 3;
  auto& f = part.flight;
  const auto q = attitude_of(m);
  if (!q || number_at(m, "pose_frame").value_or(0) != kNed) return;
  f.attitude.push(t, *q);
  if (const auto p = three_of(m, "position[0]", "position[1]", "position[2]")) f.local_position.push(t, *p);
  const auto v = three_of(m, "velocity[0]", "velocity[1]", "velocity[2]");
  const auto frame = number_at(m, "velocity_frame").value_or(0);
  if (!v || (frame != kNed && frame != kBodyFrd)) return;
  f.velocity.origin = VelocityOrigin::fused;
  f.velocity.push(t, frame == kNed ? *v : Eigen::Vector3d(q->normalized() * *v));
}

void sensor_combined(LogTime t, const Json& m, Part& part) {
  if (const auto f = three_of(m, "accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"))
    part.flight.accelerometer.push(t, *f);
}

/// Its temperature is the board's and is not taken.
void vehicle_air_data(LogTime t, const Json& m, Part& part) {
  const auto pressure = finite_at(m, "baro_pressure_pa"), altitude = finite_at(m, "baro_alt_meter");
  if (pressure || altitude) part.flight.barometer.push(t, {pressure, altitude});
}

void vehicle_land_detected(LogTime t, const Json& m, Part& part) {
  if (const auto landed = number_at(m, "landed")) part.flight.landed.push(t, *landed != 0);
}

/// Zeros with zero variance are what the estimator publishes while it does not estimate the wind.
void wind(LogTime t, const Json& m, Part& part) {
  const auto north = finite_at(m, "windspeed_north"), east = finite_at(m, "windspeed_east");
  if (!north || !east) return;
  const double variance = (number_at(m, "variance_north").value_or(0) + number_at(m, "variance_east").value_or(0)) / 2;
  if (*north == 0 && *east == 0 && !(variance > 0)) return;
  const bool known = variance > 0 && std::isfinite(variance);
  part.flight.autopilot_wind.push(t, {{*north, *east}, known ? std::optional(std::sqrt(variance)) : std::nullopt});
}

void esc_status(LogTime t, const Json& m, Part& part) {
  const auto* escs = value_at(m, "esc");
  if (!escs || !escs->is_array()) return;
  const auto count = std::min(static_cast<double>(escs->size()), number_at(m, "esc_count").value_or(0));
  RotorSpeeds speeds;
  for (std::size_t i = 0; static_cast<double>(i) < count; ++i)
    speeds.push_back(static_cast<float>(number_at((*escs)[i], "esc_rpm").value_or(NAN)));
  if (!speeds.empty()) part.flight.rotors.push(t, std::move(speeds));
}

}  // namespace

Rule px4_rule(const std::string& plain_name) {
  static const std::map<std::string, void (*)(LogTime, const Json&, Part&)> rules = {
      {"px4_msgs/VehicleAttitude", vehicle_attitude},
      {"px4_msgs/VehicleLocalPosition", vehicle_local_position},
      {"px4_msgs/VehicleGlobalPosition", vehicle_global_position},
      {"px4_msgs/SensorGps", sensor_gps},
      {"px4_msgs/VehicleGpsPosition", sensor_gps},
      {"px4_msgs/VehicleOdometry", vehicle_odometry},
      {"px4_msgs/SensorCombined", sensor_combined},
      {"px4_msgs/VehicleAirData", vehicle_air_data},
      {"px4_msgs/VehicleLandDetected", vehicle_land_detected},
      {"px4_msgs/Wind", wind},
      {"px4_msgs/WindEstimate", wind},
      {"px4_msgs/EscStatus", esc_status}};
  const auto found = rules.find(plain_name);
  if (found == rules.end()) return {};
  return [take = found->second](LogTime t, const Json& m, Part& part) { take(stamped(t, m), m, part); };
}

}  // namespace quadsonde::ingest::foreign
