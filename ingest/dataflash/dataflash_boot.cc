#include "ingest/dataflash/dataflash_boot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest::dataflash {
namespace {

constexpr double rad = std::numbers::pi / 180;

/// Within what a multirotor's sensor can mean; false for NaN too.
bool within(double value, double bound) { return std::abs(value) <= bound; }

// Beyond these a value is garbage: DataFlash has no checksum that would tell.
constexpr double most_speed = 100, most_acceleration = 400, most_height = 2e4, most_distance = 1e6;
constexpr int least_fix = 3, most_fix = 6;
// Weeks before ArduPilot existed (January 2010) are a receiver's 10-bit week.
constexpr int first_week = 1565;

/// Age at t of something at a time in ms since boot [s].
double age(LogTime t, std::int64_t measured_ms) {
  return to_seconds(t - LogTime{}) - 1e-3 * static_cast<double>(measured_ms);
}

std::string mode_name(int mode) {
  constexpr std::pair<int, const char*> copter[] = {
      {0, "stabilize"}, {1, "acro"},   {2, "altitude hold"}, {3, "auto"}, {4, "guided"},
      {5, "loiter"},    {6, "return"}, {7, "circle"},        {9, "land"}, {16, "position hold"}};
  for (const auto& [number, name] : copter)
    if (number == mode) return fmt::format("mode {} ({})", mode, name);
  return fmt::format("mode {}", mode);
}

/// A board's serial as firmwares print it: a name and three words of eight hexadecimal digits.
bool is_board_serial(std::string_view text) {
  const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F'); };
  if (text.size() < 28) return false;
  const auto tail = text.substr(text.size() - 27);
  for (std::size_t i = 0; i < tail.size(); ++i)
    if (i % 9 == 8 ? tail[i] != ' ' : !is_hex(tail[i])) return false;
  return text[text.size() - 28] == ' ';
}

}  // namespace

void Boot::reject(const DataflashMessage& message) {
  auto& rejected = rejected_[message.layout->name];
  if (rejected.count++ == 0) rejected.first_at = message.at;
}

void Boot::inherit(const Boot& before) {
  if (firmware_.empty()) firmware_ = before.firmware_;
  if (frame_.empty()) frame_ = before.frame_;
  if (board_.empty()) board_ = before.board_;
  simulated_ = simulated_ || before.simulated_;
  if (parameters_.empty()) parameters_ = before.parameters_;
}

bool Boot::has_data() const {
  return !flight_.attitude.empty() || !gps_.empty() || !ekf_.empty() || !fused_position_.empty() ||
         !flight_.barometer.empty() || !flight_.accelerometer.empty();
}

void Boot::take(const Binding& row, const DataflashMessage& message, LogTime t) {
  switch (row.row) {
    case Row::attitude:
      return take_attitude(row, message, t);
    case Row::gps:
      return take_gps(row, message, t);
    case Row::gps_accuracy:
      return take_gps_accuracy(row, message, t);
    case Row::ekf_state:
      return take_ekf_state(row, message, t);
    case Row::ekf_wind:
      return take_ekf_wind(row, message, t);
    case Row::ekf_primary:
      ++primary_[{row.ekf, static_cast<int>(row.integer(message, 0, 0))}];
      return;
    case Row::barometer:
      return take_barometer(row, message, t);
    case Row::imu:
      return take_imu(row, message, t);
    case Row::parameter: {
      const double value = row.value(message, 1);
      const auto name = row.text(message, 0);
      if (!name.empty() && std::isfinite(value)) parameters_[std::string(name)] = value;
      return;
    }
    case Row::text:
      return take_text(row.text(message, 0), t);
    case Row::mode:
      return note_mode(static_cast<int>(row.integer(message, 0, -1)), t);
    case Row::event:
      return take_event(static_cast<int>(row.integer(message, 0, -1)), t);
    case Row::arming:
      return take_event(row.integer(message, 0, 0) != 0 ? 10 : 11, t);
    case Row::origin:
      return take_origin(row, message);
    case Row::position:
      return take_position(row, message, t);
    case Row::esc:
      return take_esc(row, message, t);
    case Row::hygrometer:
      return take_hygrometer(row, message, t);
    case Row::simulator:
      simulated_ = true;
      return;
    case Row::none:
      return;
  }
}

void Boot::take_attitude(const Binding& row, const DataflashMessage& message, LogTime t) {
  if (row.fields[4] != nullptr) px4_ = true;
  const double roll = row.value(message, 0), pitch = row.value(message, 1), yaw = row.value(message, 2);
  if (!within(roll, 180) || !within(pitch, 90) || !within(yaw, 360)) return reject(message);
  flight_.attitude.push(t, q_NB_from_euler({roll * rad, pitch * rad, yaw * rad}));
  if (row.fields[3] != nullptr) ++attitude_by_[static_cast<int>(row.integer(message, 3, 0))];
}

void Boot::take_gps(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int instance = row.instance_of(message);
  const auto status = row.integer(message, 0, -1);
  if (instance < 0 || instance >= most_instances || status < 0 || status > most_fix) return reject(message);
  auto& gps = gps_[instance];
  if (status < least_fix) {
    ++gps.without_fix;
    return;
  }
  const double lat = row.value(message, 3), lon = row.value(message, 4), height = row.value(message, 5);
  const double speed = row.value(message, 6), course = row.value(message, 7) * rad, down = row.value(message, 8);
  if (!within(lat, 90) || !within(lon, 180) || (lat == 0 && lon == 0) || !within(height, most_height) ||
      !within(speed, most_speed) || speed < 0 || !within(course, 4 * std::numbers::pi))
    return reject(message);
  gps.position.push(t, {lat, lon});
  gps.height.push(t, {height});
  // Without VZ (very old firmware) the EKF must give the velocity.
  if (within(down, most_speed))
    gps.velocity.push(t, {speed * std::cos(course), speed * std::sin(course), down});
  else if (row.fields[8] != nullptr)
    reject(message);
  if (row.integer(message, 9, 1) == 1) ++gps.used;
  auto week = row.integer(message, 1, 0);
  const auto ms = row.integer(message, 2, -1);
  if (week <= 0 || week > 10000 || ms < 0 || ms >= 604'800'000) return;
  while (week < first_week) week += 1024;
  gps.clock.add(t, utc_from_gps(static_cast<int>(week), ms));
}

void Boot::take_gps_accuracy(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int instance = row.instance_of(message);
  if (instance < 0 || instance >= most_instances) return reject(message);
  auto& gps = gps_[instance];
  const double sd = row.value(message, 0), ellipsoid = row.value(message, 2);
  // 655.35 m/s is ArduPilot's "unknown"; without a fix it has some meaningless tens of m/s.
  if (sd > 0 && within(sd, 50)) gps.speed_sd.push(t, sd);
  if (row.fields[2] != nullptr && ellipsoid != 0 && within(ellipsoid, most_height)) gps.ellipsoid.push(t, {ellipsoid});
  if (const auto ms = row.integer(message, 3, 0); ms > 0) gps.waited.push_back(age(t, ms));
  if (row.integer(message, 1, 1) != 0)
    ++gps.with_vertical;
  else
    ++gps.without_vertical;
}

void Boot::take_ekf_state(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int core = row.instance_of(message);
  const Eigen::Vector3d v(row.value(message, 0), row.value(message, 1), row.value(message, 2));
  const Eigen::Vector3d p(row.value(message, 3), row.value(message, 4), row.value(message, 5));
  const auto sound = [](const Eigen::Vector3d& x, double bound) {
    return within(x.x(), bound) && within(x.y(), bound) && within(x.z(), bound);
  };
  if (core < 0 || core >= most_instances || !sound(v, most_speed)) return reject(message);
  auto& ekf = ekf_[{row.ekf, core}];
  ekf.velocity.push(t, v);
  if (sound(p, most_distance)) ekf.local.push(t, p);
  if (!flight_.attitude.empty()) return;
  const double roll = row.value(message, 6), pitch = row.value(message, 7), yaw = row.value(message, 8);
  if (within(roll, 180) && within(pitch, 90) && within(yaw, 360))
    ekf.attitude.push(t, q_NB_from_euler({roll * rad, pitch * rad, yaw * rad}));
}

void Boot::take_ekf_wind(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int core = row.instance_of(message);
  const double north = row.value(message, 0), east = row.value(message, 1);
  if (core < 0 || core >= most_instances || !within(north, most_speed) || !within(east, most_speed))
    return reject(message);
  ekf_[{row.ekf, core}].wind.push(t, {{north, east}, std::nullopt});
}

void Boot::take_barometer(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int instance = row.instance_of(message);
  if (barometer_instance_ < 0) barometer_instance_ = instance;
  if (instance != barometer_instance_) return;
  const double pressure = row.value(message, 0), altitude = row.value(message, 1);
  if (!(pressure > 1e3 && pressure < 1.2e5) || !within(altitude, most_height)) return reject(message);
  flight_.barometer.push(t, {pressure, altitude});
  if (const auto ms = row.integer(message, 2, 0); ms > 0) barometer_ages_.push_back(age(t, ms));
}

void Boot::take_imu(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int instance = row.instance_of(message);
  if (imu_instance_ < 0) imu_instance_ = instance;
  if (instance != imu_instance_) return;
  const Eigen::Vector3d f(row.value(message, 0), row.value(message, 1), row.value(message, 2));
  if (!within(f.x(), most_acceleration) || !within(f.y(), most_acceleration) || !within(f.z(), most_acceleration))
    return reject(message);
  flight_.accelerometer.push(t, f);
}

void Boot::take_position(const Binding& row, const DataflashMessage& message, LogTime t) {
  const double lat = row.value(message, 0), lon = row.value(message, 1), height = row.value(message, 2);
  const double ground = row.value(message, 3);
  if (within(ground, most_height)) flight_.height_ground.push(t, {ground});
  if (!within(lat, 90) || !within(lon, 180) || (lat == 0 && lon == 0)) return;
  fused_position_.push(t, {lat, lon});
  if (within(height, most_height)) fused_height_.push(t, {height});
}

void Boot::take_origin(const Binding& row, const DataflashMessage& message) {
  if (row.integer(message, 0, -1) != 0) return;
  const double lat = row.value(message, 1), lon = row.value(message, 2), height = row.value(message, 3);
  if (!within(lat, 90) || !within(lon, 180) || !within(height, most_height)) return reject(message);
  flight_.origin = Origin{{lat, lon}, MslHeight{height}};
}

/// Each ESC has its own message; a row of speeds is complete when the numbers start again.
void Boot::take_esc(const Binding& row, const DataflashMessage& message, LogTime t) {
  const int instance = row.instance_of(message);
  const double rpm = row.value(message, 0);
  if (instance < 0 || instance >= 32 || !within(rpm, 2e5)) return reject(message);
  if (instance <= last_esc_) flight_.rotors.push(rotors_since_, rpm_);
  if (instance <= last_esc_ || last_esc_ < 0) rotors_since_ = t;
  last_esc_ = instance;
  if (rpm_.size() <= static_cast<std::size_t>(instance))
    rpm_.resize(static_cast<std::size_t>(instance) + 1, std::numeric_limits<float>::quiet_NaN());
  rpm_[static_cast<std::size_t>(instance)] = static_cast<float>(rpm);
}

void Boot::take_hygrometer(const Binding& row, const DataflashMessage& message, LogTime t) {
  const double celsius = row.value(message, 0), humidity = row.value(message, 1);
  if (!within(celsius, 90)) return reject(message);
  AirSample air;
  air.temperature_k = celsius + 273.15;
  if (humidity >= 0 && humidity <= 110) air.relative_humidity_pct = humidity;
  flight_.air.push(t, air);
}

void Boot::take_event(int id, LogTime t) {
  // Source: ArduPilot libraries/AP_Logger/LogStructure.h, enum class LogEvent.
  constexpr int armed = 10, disarmed = 11, land_complete = 18, not_landed = 28;
  if (id == armed) flight_.events.push(t, {Event::What::armed, {}});
  if (id == disarmed) flight_.events.push(t, {Event::What::disarmed, {}});
  if (id == land_complete) flight_.events.push(t, {Event::What::landed, {}});
  if (id == not_landed) flight_.events.push(t, {Event::What::takeoff, {}});
  saw_landing_ = saw_landing_ || id == land_complete || id == not_landed;
  if (id == disarmed || id == land_complete || id == not_landed) landing_.emplace_back(t, id != not_landed);
}

void Boot::note_mode(int mode, LogTime t) {
  if (mode >= 0) flight_.events.push(t, {Event::What::mode, mode_name(mode)});
}

void Boot::take_text(std::string_view text, LogTime t) {
  const auto has = [&](std::string_view part) { return text.find(part) != std::string_view::npos; };
  flight_.events.push(t, {Event::What::text, std::string(text)});
  for (const auto* name : {"Copter V", "Plane V", "Rover V", "Sub V", "Heli V", "Blimp V", "AntennaTracker V"})
    if (has(name) && firmware_.empty()) firmware_ = text;
  if (text.starts_with("Frame: ")) frame_ = text.substr(7);
  if (is_board_serial(text)) board_ = text;
  if (has("SITL")) simulated_ = true;
}

}  // namespace quadsonde::ingest::dataflash
