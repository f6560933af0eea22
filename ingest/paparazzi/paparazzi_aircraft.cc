#include "ingest/paparazzi/paparazzi_aircraft.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "ingest/flight/rate.h"
#include "ingest/flight/rotation.h"

namespace quadsonde::ingest::paparazzi {
namespace {

constexpr double rad = std::numbers::pi / 180;
constexpr int least_fix = 3;
constexpr double most_speed = 100, most_height = 2e4;
constexpr std::int64_t second_ns = 1'000'000'000, week_ms = 604'800'000;
// A telemetry stream tells the fix every few seconds at least.
constexpr double fix_holds_s = 5;
// Before Paparazzi existed (2003) a clock was never set.
constexpr std::int64_t least_time_of_day_ns = 1'041'379'200 * second_ns;

double to_number(std::string_view text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool all = error == std::errc() && end == text.data() + text.size();
  return all ? value : std::numeric_limits<double>::quiet_NaN();
}

bool within(double value, double bound) { return std::abs(value) <= bound; }
bool within(const Eigen::Vector3d& v, double bound) { return v.allFinite() && v.cwiseAbs().maxCoeff() <= bound; }

bool is_place(double lat, double lon) { return within(lat, 90) && within(lon, 180) && !(lat == 0 && lon == 0); }

/// Axes of E to axes of N at a point: R_NE.
Eigen::Matrix3d ned_from_ecef(double lat_deg, double lon_deg) {
  const double sp = std::sin(lat_deg * rad), cp = std::cos(lat_deg * rad);
  const double sl = std::sin(lon_deg * rad), cl = std::cos(lon_deg * rad);
  Eigen::Matrix3d R_NE;
  R_NE << -sp * cl, -sp * sl, cp, -sl, cl, 0, -cp * cl, -cp * sl, -sp;
  return R_NE;
}

}  // namespace

bool Aircraft::has_data() const {
  return !attitude_.empty() || !quaternion_.empty() || !euler_.empty() || !fp_attitude_.empty() ||
         !flight_.position.empty() || !ins_velocity_.empty() || !gps_velocity_.empty() || !flight_.barometer.empty();
}

void Aircraft::take(const Binding& row, const std::vector<std::string_view>& values, LogTime t) {
  for (std::size_t i = 0; i < most_values; ++i)
    value_[i] = row.index[i] < 0 ? std::numeric_limits<double>::quiet_NaN()
                                 : to_number(values[static_cast<std::size_t>(row.index[i])]) * row.factor[i];
  switch (row.row) {
    case Row::gps_int:
      return take_gps(row, t);
    case Row::gps:
    case Row::gps_lla:
      return take_week_gps(row, t);
    case Row::rotorcraft_fp:
    case Row::ins:
    case Row::ins_ref:
      return take_estimates(row, t);
    case Row::attitude:
    case Row::quaternion:
    case Row::euler:
      return take_attitude(row, t);
    case Row::acceleration:
    case Row::air_data:
    case Row::wind:
      return take_sensors(row, t);
    case Row::status:
      return take_status(row, t);
    case Row::version:
      if (row.index[0] >= 0) version_ = values[static_cast<std::size_t>(row.index[0])];
      return;
    case Row::rotorcraft_mark:
      rotorcraft_ = true;
      return;
    case Row::fixed_wing_mark:
      fixed_wing_ = true;
      return;
    case Row::none:
      return;
  }
}

void Aircraft::take_gps(const Binding&, LogTime t) {
  const bool fix = value_[0] >= least_fix;
  has_fix_.push(t, fix);
  if (!fix || !is_place(value_[1], value_[2])) return;
  const GeoPoint point{value_[1], value_[2]};
  flight_.position.push(t, point);
  if (within(value_[3], most_height)) flight_.height_ellipsoid.push(t, {value_[3]});
  if (within(value_[4], most_height)) flight_.height_msl.push(t, {value_[4]});
  const Eigen::Vector3d v_NB_E(value_[5], value_[6], value_[7]);
  if (!within(v_NB_E, most_speed)) return;
  gps_int_velocity_.push(t, ned_from_ecef(point.lat_deg, point.lon_deg) * v_NB_E);
  gps_int_velocity_.sd.push_back(value_[8] > 0 && value_[8] < 50 ? value_[8]
                                                                 : std::numeric_limits<double>::quiet_NaN());
  if (value_[9] > 0 && value_[9] < week_ms) time_of_week_ms_.emplace_back(t, static_cast<std::int64_t>(value_[9]));
}

void Aircraft::take_week_gps(const Binding& row, LogTime t) {
  const bool fix = value_[0] >= least_fix;
  has_fix_.push(t, fix);
  if (!fix) return;
  const double course = value_[1], speed = value_[3], climb = value_[4];
  if (within(value_[2], most_height)) flight_.height_msl.push(t, {value_[2]});
  if (row.row == Row::gps_lla && is_place(value_[7], value_[8])) {
    flight_.position.push(t, {value_[7], value_[8]});
    if (within(value_[9], most_height)) flight_.height_ellipsoid.push(t, {value_[9]});
  }
  if (within(speed, most_speed) && within(climb, most_speed) && std::isfinite(course))
    gps_velocity_.push(t, {speed * std::cos(course), speed * std::sin(course), -climb});
  if (!(value_[6] >= 0 && value_[6] < week_ms)) return;
  const auto ms = static_cast<std::int64_t>(value_[6]);
  if (value_[5] > 0 && value_[5] < 10000)
    week_clock_.add(t, utc_from_gps(static_cast<int>(value_[5]), ms));
  else
    time_of_week_ms_.emplace_back(t, ms);
}

void Aircraft::take_estimates(const Binding& row, LogTime t) {
  const Eigen::Vector3d a(value_[0], value_[1], value_[2]), b(value_[3], value_[4], value_[5]);
  if (row.row == Row::ins_ref) {
    if (is_place(value_[0], value_[1]) && within(value_[2], most_height))
      flight_.origin = Origin{{value_[0], value_[1]}, MslHeight{value_[2]}};
    return;
  }
  const auto ned = [](const Eigen::Vector3d& enu) { return Eigen::Vector3d(enu.y(), enu.x(), -enu.z()); };
  const bool is_fp = row.row == Row::rotorcraft_fp;
  if (within(a, 1e6)) (is_fp ? fp_local_ : ins_local_).push(t, is_fp ? ned(a) : a);
  if (within(b, most_speed)) (is_fp ? fp_velocity_ : ins_velocity_).push(t, is_fp ? ned(b) : b);
  if (!is_fp) return;
  rotorcraft_ = true;
  const Eigen::Vector3d angles(value_[6], value_[7], value_[8]);
  if (within(angles, 7)) fp_attitude_.push(t, q_NB_from_euler({angles.x(), angles.y(), angles.z()}));
}

void Aircraft::take_attitude(const Binding& row, LogTime t) {
  if (row.row == Row::quaternion) {
    const Eigen::Quaterniond q(value_[0], value_[1], value_[2], value_[3]);
    if (q.coeffs().allFinite() && std::abs(q.norm() - 1) < 0.1) quaternion_.push(t, q.normalized());
    return;
  }
  const Eigen::Vector3d angles(value_[0], value_[1], value_[2]);
  if (!within(angles, 7)) return;
  (row.row == Row::euler ? euler_ : attitude_).push(t, q_NB_from_euler({angles.x(), angles.y(), angles.z()}));
}

void Aircraft::take_sensors(const Binding& row, LogTime t) {
  if (row.row == Row::acceleration) {
    const Eigen::Vector3d f(value_[0], value_[1], value_[2]);
    if (within(f, 400)) flight_.accelerometer.push(t, f);
  } else if (row.row == Row::air_data) {
    BarometerSample sample;
    if (value_[0] > 1e3 && value_[0] < 1.2e5) sample.pressure_pa = value_[0];
    if (within(value_[1], most_height)) sample.altitude_m = value_[1];
    if (sample.pressure_pa) flight_.barometer.push(t, sample);
  } else {
    const bool valid = std::isnan(value_[0]) || (static_cast<int>(value_[0]) & 1) != 0;
    if (valid && within(value_[1], most_speed) && within(value_[2], most_speed))
      flight_.autopilot_wind.push(t, {{value_[2], value_[1]}, std::nullopt});
  }
}

void Aircraft::take_status(const Binding&, LogTime t) {
  rotorcraft_ = true;
  if (std::isfinite(value_[0])) has_fix_.push(t, value_[0] >= least_fix);
  const bool armed = value_[2] >= 1;
  if (!saw_status_ || armed != armed_) flight_.events.push(t, {armed ? Event::What::armed : Event::What::disarmed, {}});
  saw_status_ = true;
  armed_ = armed;
  if (std::isfinite(value_[1])) flight_.landed.push(t, value_[1] < 1);
}

void Aircraft::choose_attitude() {
  const std::pair<Stream<Eigen::Quaterniond>*, const char*> candidates[] = {
      {&quaternion_, "AHRS_QUAT_INT body_q"},
      {&attitude_, "ATTITUDE phi theta psi"},
      {&euler_, "AHRS_EULER_INT body"},
      {&fp_attitude_, "ROTORCRAFT_FP phi theta psi"}};
  for (const auto& [stream, source] : candidates) {
    if (stream->size() <= flight_.attitude.size()) continue;
    flight_.attitude = std::move(*stream);
    flight_.attitude.source = source;
  }
}

/// The receiver's own from 4 Hz on; else the filter's, but only while a fix holds: without one it drifts away.
void Aircraft::choose_velocity(const std::string& file) {
  auto& receiver = gps_int_velocity_.empty() ? gps_velocity_ : gps_int_velocity_;
  const char* receiver_source =
      gps_int_velocity_.empty() ? "GPS speed course climb" : "GPS_INT ecef_xd ecef_yd ecef_zd";
  const bool fp = fp_velocity_.size() >= ins_velocity_.size();
  const auto& filter = fp ? fp_velocity_ : ins_velocity_;
  Stream<Eigen::Vector3d> gated;
  for (std::size_t i = 0; i < filter.size(); ++i) {
    const auto at = last_at_or_before(has_fix_, filter.time[i]);
    if (at < 0 || !has_fix_.value[static_cast<std::size_t>(at)]) continue;
    if (to_seconds(filter.time[i] - has_fix_.time[static_cast<std::size_t>(at)]) > fix_holds_s) continue;
    gated.push(filter.time[i], filter.value[i]);
  }
  if (gated.size() < filter.size())
    flight_.problems.push_back({Kind::doubtful,
                                fmt::format("{} of {} velocities stand without a GPS fix and were left out",
                                            filter.size() - gated.size(), filter.size()),
                                {file, {}, {}, fp ? "ROTORCRAFT_FP" : "INS"},
                                "a filter without a fix drifts away"});
  if (receiver.size() >= 2 && (is_fast_receiver(receiver.time) || gated.size() < 2)) {
    flight_.velocity = std::move(receiver);
    flight_.velocity.origin = VelocityOrigin::receiver;
    flight_.velocity.latency = receiver_latency_;
    flight_.velocity.source = receiver_source;
    auto& sd = flight_.velocity.sd;
    if (!std::all_of(sd.begin(), sd.end(), [](double s) { return std::isfinite(s); })) sd.clear();
    return;
  }
  static_cast<Stream<Eigen::Vector3d>&>(flight_.velocity) = std::move(gated);
  flight_.velocity.origin = VelocityOrigin::fused;
  flight_.velocity.source = fp ? "ROTORCRAFT_FP veast vnorth vup" : "INS ins_xd ins_yd ins_zd";
}

/// GPS week and time where there is one. GPS_INT has no week: that comes from the .log's time of day, which is the
/// ground station's clock and right within half a week or nonsense altogether.
void Aircraft::finish_clock(const PaparazziDefinitions& definitions) {
  if (!week_clock_.empty()) {
    flight_.clock = week_clock_.estimate("GPS week and time of week");
    receiver_latency_ = week_clock_.latency();
    return;
  }
  const auto zero = definitions.time_of_day();
  if (!zero || zero->ns < least_time_of_day_ns) return;
  ClockEstimator estimator;
  for (const auto& [t, ms] : time_of_week_ms_) {
    const UtcTime about = *zero + (t - LogTime{});
    const auto gps_ms = (about - utc_from_gps(0, 0)).count() / 1'000'000 +
                        1000 * gps_minus_utc_s((about - utc_from_gps(0, 0)).count() / second_ns);
    const auto week = (gps_ms - ms + week_ms / 2) / week_ms;
    estimator.add(t, utc_from_gps(static_cast<int>(week), ms));
  }
  receiver_latency_ = estimator.latency();
  flight_.clock = estimator.estimate("GPS time of week, the week by the .log's time_of_day");
  if (flight_.clock.utc_minus_log) return;
  flight_.clock.utc_minus_log = Duration(zero->ns);
  flight_.clock.uncertainty_s = 2;
  flight_.clock.source = "the .log's time_of_day (ground station's clock)";
}

VehicleIdentity Aircraft::identity(const PaparazziDefinitions& definitions, const std::string& id) const {
  VehicleIdentity vehicle;
  vehicle.name = "aircraft " + id;
  vehicle.autopilot = "Paparazzi";
  vehicle.firmware = version_;
  std::string firmware;
  for (const auto& aircraft : definitions.aircraft()) {
    if (aircraft.id != id) continue;
    if (!aircraft.name.empty()) vehicle.name = aircraft.name;
    firmware = aircraft.firmware;
  }
  if (firmware == "rotorcraft" || (firmware.empty() && rotorcraft_))
    vehicle.airframe = Airframe::multirotor;
  else if (firmware == "fixedwing" || (firmware.empty() && fixed_wing_))
    vehicle.airframe = Airframe::fixed_wing;
  else if (!firmware.empty())
    vehicle.airframe = Airframe::other;
  return vehicle;
}

Flight Aircraft::finish(const PaparazziDefinitions& definitions, const std::string& id, const std::string& file) && {
  flight_.vehicle = identity(definitions, id);
  finish_clock(definitions);
  choose_attitude();
  choose_velocity(file);
  const bool fp = fp_local_.size() >= ins_local_.size();
  flight_.local_position = fp ? std::move(fp_local_) : std::move(ins_local_);
  flight_.local_position.source = fp ? "ROTORCRAFT_FP east north up" : "INS ins_x ins_y ins_z";
  flight_.position.source = "GPS lat lon";
  flight_.height_msl.source = "GPS hmsl";
  flight_.height_ellipsoid.source = "GPS alt";
  flight_.position.latency = flight_.height_msl.latency = flight_.height_ellipsoid.latency = receiver_latency_;
  flight_.barometer.source = "AIR_DATA pressure";
  flight_.accelerometer.source = "IMU_ACCEL";
  flight_.autopilot_wind.source = "WIND_INFO_RET east north";
  flight_.landed.source = "ROTORCRAFT_STATUS ap_in_flight";
  flight_.events.source = "ROTORCRAFT_STATUS";
  const auto& wind = flight_.autopilot_wind.value;
  if (std::all_of(wind.begin(), wind.end(), [](const auto& w) { return w.v_NA_N.norm() == 0; }))
    flight_.autopilot_wind = {};
  tidy(flight_);
  return std::move(flight_);
}

}  // namespace quadsonde::ingest::paparazzi
