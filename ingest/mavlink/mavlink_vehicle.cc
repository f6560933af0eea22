#include "ingest/mavlink/mavlink_vehicle.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest::mavlink {
namespace {

constexpr double rad = std::numbers::pi / 180, nan = std::numeric_limits<double>::quiet_NaN();
constexpr double standard_gravity = 9.80665;
constexpr int autopilot_ardupilot = 3;

double number(const Binding& row, const std::uint8_t* payload, std::size_t i) { return row.fields[i]->number(payload); }

Eigen::Vector3d vector(const Binding& row, const std::uint8_t* payload, std::size_t i) {
  return {number(row, payload, i), number(row, payload, i + 1), number(row, payload, i + 2)};
}

bool is_place(double lat, double lon) { return std::abs(lat) <= 90 && std::abs(lon) <= 180 && !(lat == 0 && lon == 0); }

}  // namespace

void Boot::pair_clocks(LogTime boot, LogTime host) {
  // The first minutes in full, then a share: enough for a median, and no column of its own in a long log.
  constexpr std::uint64_t in_full = 8192, share = 16;
  has_boot_clock_ = true;
  if (pairs_++ < in_full || pairs_ % share == 0) host_minus_boot_.push_back(host - boot);
}

bool Boot::has_data() const {
  return attitude_.size() + attitude_quaternion_.size() + gps_.size() + fused_.size() + local_.size() +
             pressure_.size() + air_.size() >
         0;
}

void Boot::take(const Binding& row, const MavlinkFrame& frame, const Stamp& stamp, Identity& identity) {
  if (first_host_ == LogTime{}) first_host_ = stamp.host;
  const PaddedPayload padded(frame);
  const auto* payload = padded.data();
  switch (row.row) {
    case Row::heartbeat:
      return take_heartbeat(row, payload, stamp, identity);
    case Row::system_time:
      return take_system_time(row, payload, stamp);
    case Row::attitude:
    case Row::attitude_quaternion:
      return take_attitude(row, payload, stamp);
    case Row::gps_raw:
      return take_gps(row, payload, stamp);
    case Row::local_position:
    case Row::global_position:
    case Row::origin:
      return take_positions(row, payload, stamp);
    case Row::pressure:
    case Row::imu_scaled:
    case Row::imu_raw:
    case Row::imu_highres:
    case Row::hygrometer:
      return take_sensors(row, payload, stamp);
    case Row::wind:
    case Row::wind_cov:
      return take_wind(row, payload, stamp, identity);
    case Row::landed: {
      const auto state = row.fields[0]->integer(payload);  // 1 on ground, 2 in air, 3 taking off, 4 landing
      if (state >= 1 && state <= 4) landed_.push(stamp, state == 1);
      return;
    }
    case Row::esc_status:
    case Row::esc_telemetry:
      return take_rotors(row, payload, stamp);
    case Row::text:
      return take_text(row, payload, stamp, identity);
    case Row::version:
    case Row::parameter:
      return take_identity(row, payload, identity);
    case Row::simulator:
      identity.simulated = true;
      return;
    case Row::none:
      return;
  }
}

void Boot::take_system_time(const Binding& row, const std::uint8_t* payload, const Stamp& stamp) {
  constexpr std::int64_t year_2010_us = 1'262'304'000'000'000, year_2100_us = 4'102'444'800'000'000;
  const auto unix_us = row.fields[0]->integer(payload);
  // Before the first fix it is 0, or counts from 1970 or 1980.
  if (stamp.clock == Stamp::Clock::boot && unix_us > year_2010_us && unix_us < year_2100_us)
    utc_.add(stamp.t, UtcTime{unix_us * 1000});
}

void Boot::take_identity(const Binding& row, const std::uint8_t* payload, Identity& identity) {
  if (row.row == Row::version) {
    const auto version = row.fields[0]->integer(payload);
    if (identity.firmware.empty() && version != 0)
      identity.firmware = fmt::format("{}.{}.{}", version >> 24 & 255, version >> 16 & 255, version >> 8 & 255);
    return;
  }
  const auto name = row.fields[0]->text(payload);
  if (name == "Q_ENABLE") identity.quadplane = number(row, payload, 1) > 0;
  if (name == "SIM_SPEEDUP") identity.simulated = true;
}

void Boot::take_heartbeat(const Binding& row, const std::uint8_t* payload, const Stamp& stamp, Identity& identity) {
  identity.type = static_cast<std::uint8_t>(row.fields[0]->integer(payload));
  identity.autopilot = static_cast<std::uint8_t>(row.fields[1]->integer(payload));
  const auto base_mode = row.fields[2]->integer(payload);
  constexpr std::int64_t armed_flag = 0x80, simulation_flag = 0x20;
  if ((base_mode & simulation_flag) != 0) identity.simulated = true;
  const int armed = (base_mode & armed_flag) != 0 ? 1 : 0;
  if (armed != armed_) events_.push(stamp, {armed != 0 ? Event::What::armed : Event::What::disarmed, {}});
  armed_ = armed;
  const auto mode = row.fields[3]->integer(payload);
  if (mode != mode_) events_.push(stamp, {Event::What::mode, fmt::format("mode {}", mode)});
  mode_ = mode;
}

void Boot::take_attitude(const Binding& row, const std::uint8_t* payload, const Stamp& stamp) {
  if (row.row == Row::attitude) {
    const auto angles = vector(row, payload, 0);
    if (angles.allFinite()) attitude_.push(stamp, q_NB_from_euler({angles.x(), angles.y(), angles.z()}));
    return;
  }
  const Eigen::Quaterniond q(number(row, payload, 0), number(row, payload, 1), number(row, payload, 2),
                             number(row, payload, 3));
  if (q.coeffs().allFinite() && q.norm() > 0.5) attitude_quaternion_.push(stamp, q.normalized());
}

void Boot::take_gps(const Binding& row, const std::uint8_t* payload, const Stamp& stamp) {
  constexpr int least_fix = 3;
  if (row.fields[0]->integer(payload) < least_fix) {
    ++without_fix_;
    return;
  }
  // A stream faster than the receiver repeats the fix with its time.
  const auto fix_time = row.time->integer(payload);
  if (fix_time != 0 && fix_time == last_fix_) return;
  last_fix_ = fix_time;
  GpsFix fix;
  fix.point = {number(row, payload, 1) * 1e-7, number(row, payload, 2) * 1e-7};
  if (!is_place(fix.point.lat_deg, fix.point.lon_deg)) return;
  fix.msl = number(row, payload, 3) * 1e-3;
  const double speed = number(row, payload, 4), course = number(row, payload, 5), unknown = 65535;
  fix.north = fix.east = nan;
  if (speed != unknown && (course != unknown || speed == 0)) {
    const double heading = course == unknown ? 0 : course * 0.01 * rad;
    fix.north = speed * 0.01 * std::cos(heading);
    fix.east = speed * 0.01 * std::sin(heading);
  }
  const double ellipsoid = number(row, payload, 6), sd = number(row, payload, 7);
  fix.ellipsoid = ellipsoid != 0 ? ellipsoid * 1e-3 : nan;
  fix.speed_sd = sd > 0 && sd < 50e3 ? sd * 1e-3 : nan;
  gps_.push(stamp, fix);
}

void Boot::take_positions(const Binding& row, const std::uint8_t* payload, const Stamp& stamp) {
  if (row.row == Row::local_position) {
    const LocalState state{vector(row, payload, 0), vector(row, payload, 3)};
    if (state.p_NB_N.allFinite() && state.v_NB_N.allFinite()) local_.push(stamp, state);
    return;
  }
  const GeoPoint point{number(row, payload, 0) * 1e-7, number(row, payload, 1) * 1e-7};
  // Zero latitude and longitude: the filter has no position, and its velocity means nothing.
  if (!is_place(point.lat_deg, point.lon_deg)) return;
  const double msl = number(row, payload, 2) * 1e-3;
  if (row.row == Row::origin)
    origin_ = Origin{point, MslHeight{msl}};
  else
    fused_.push(stamp, {point, msl, number(row, payload, 3) * 1e-3, vector(row, payload, 4) * 0.01});
}

void Boot::take_sensors(const Binding& row, const std::uint8_t* payload, const Stamp& stamp) {
  const auto push_pressure = [&](double hpa) {
    if (hpa > 10 && hpa < 1200) pressure_.push(stamp, hpa * 100);
  };
  if (row.row == Row::pressure) return push_pressure(number(row, payload, 0));
  if (row.row == Row::hygrometer) {
    AirSample air;
    air.temperature_k = number(row, payload, 0) * 0.01 + 273.15;
    air.relative_humidity_pct = number(row, payload, 1) * 0.01;
    return air_.push(stamp, air);
  }
  const auto f = vector(row, payload, 0);
  if (!f.allFinite()) return;
  if (row.row == Row::imu_scaled) imu_scaled_.push(stamp, f * 1e-3 * standard_gravity);
  if (row.row == Row::imu_raw) imu_raw_.push(stamp, f * 1e-3 * standard_gravity);
  if (row.row != Row::imu_highres) return;
  constexpr std::int64_t acceleration_updated = 0b111, pressure_updated = 0x200;
  const auto updated = row.fields[4]->integer(payload);
  if ((updated & acceleration_updated) == acceleration_updated) imu_highres_.push(stamp, f);
  if ((updated & pressure_updated) != 0) push_pressure(number(row, payload, 3));
}

void Boot::take_wind(const Binding& row, const std::uint8_t* payload, const Stamp& stamp, const Identity& identity) {
  const auto values = vector(row, payload, 0);
  if (row.row == Row::wind_cov) {
    if (!values.head<2>().allFinite()) return;
    AutopilotWind wind{values.head<2>(), std::nullopt};
    if (std::isfinite(values.z()) && values.z() > 0) wind.sd = values.z();
    return wind_cov_.push(stamp, wind);
  }
  if (!values.allFinite()) return;
  const double from = values.x() * rad;
  // ArduPilot sends the length of the whole vector as speed, the definition means the horizontal part.
  double speed = values.y();
  if (identity.autopilot == autopilot_ardupilot && std::abs(values.z()) <= speed)
    speed = std::sqrt(speed * speed - values.z() * values.z());
  wind_.push(stamp, {-speed * Eigen::Vector2d(std::cos(from), std::sin(from)), std::nullopt});
}

void Boot::take_rotors(const Binding& row, const std::uint8_t* payload, const Stamp& stamp) {
  std::size_t first = static_cast<std::size_t>(row.variant);
  if (row.row == Row::esc_status) first = static_cast<std::size_t>(row.fields[1]->integer(payload));
  if (first > 28) return;
  // Groups of four come one after another; a row of speeds is complete when the first group comes again.
  if (first == 0 && !rpm_.empty()) rotors_.push(rotors_since_, rpm_);
  if (first == 0 || rpm_.empty()) rotors_since_ = stamp;
  if (rpm_.size() < first + 4) rpm_.resize(first + 4, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < 4; ++i) rpm_[first + i] = static_cast<float>(row.fields[0]->number(payload, i));
}

void Boot::note_text(const Stamp& stamp, std::string text, Identity& identity) {
  for (const auto* name : {"Copter V", "Plane V", "Rover V", "Sub V"})
    if (text.find(name) != std::string::npos) identity.firmware = text;
  if (text.find("SITL") != std::string::npos) identity.simulated = true;
  events_.push(stamp, {Event::What::text, std::move(text)});
}

/// Long texts come in chunks of 50 characters that share an id; the last one ends before its 50th.
void Boot::take_text(const Binding& row, const std::uint8_t* payload, const Stamp& stamp, Identity& identity) {
  constexpr std::size_t chunk = 50, most_text = 2000;
  const auto text = row.fields[0]->text(payload);
  const auto id = row.fields[1]->integer(payload);
  if (!pending_text_.empty() && (id != pending_id_ || row.fields[2]->integer(payload) == 0)) {
    note_text(stamp, std::move(pending_text_), identity);
    pending_text_.clear();
  }
  if (id == 0) return note_text(stamp, std::string(text), identity);
  pending_id_ = id;
  pending_text_ += text;
  if (text.size() == chunk && pending_text_.size() < most_text) return;
  note_text(stamp, std::move(pending_text_), identity);
  pending_text_.clear();
}

}  // namespace quadsonde::ingest::mavlink
