#pragma once
// One boot of one MAVLink vehicle: its columns on whatever clock each message carries, and the Flight they make.
#include <array>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/mavlink/mavlink_frame.h"

namespace quadsonde::ingest::mavlink {

enum class Row {
  none,
  heartbeat,
  system_time,
  attitude,
  attitude_quaternion,
  local_position,
  global_position,
  gps_raw,
  pressure,
  imu_scaled,
  imu_raw,
  imu_highres,
  wind,
  wind_cov,
  landed,
  esc_status,
  esc_telemetry,
  hygrometer,
  text,
  version,
  parameter,
  origin,
  simulator
};

constexpr std::size_t most_values = 11;

/// A message that a Flight is made of, its fields found once.
struct Binding {
  Row row = Row::none;
  int variant = 0;  ///< first rotor of an ESC group
  const MavlinkField* time = nullptr;
  bool time_is_ms = false;  ///< since boot; else microseconds since boot or 1970
  std::array<const MavlinkField*, most_values> fields{};
};

/// @return Row::none for a message that says nothing of a flight
const Binding& binding_of(const MavlinkMessageInfo& info);

/// When something was measured, as far as the message says.
struct Stamp {
  enum class Clock : std::uint8_t { boot, host, utc } clock = Clock::host;
  LogTime t;     ///< on that clock
  LogTime host;  ///< when the ground station had it
};

/// A column whose samples carry different clocks until the end, when offsets between those are known.
template <class T>
struct Column {
  std::vector<LogTime> time;
  std::vector<Stamp::Clock> clock;
  std::vector<LogTime> host_of_utc;  ///< for the samples in UTC only, in their order
  std::vector<T> value;

  void push(const Stamp& s, T v) {
    time.push_back(s.t);
    clock.push_back(s.clock);
    if (s.clock == Stamp::Clock::utc) host_of_utc.push_back(s.host);
    value.push_back(std::move(v));
  }
  std::size_t size() const { return value.size(); }
};

struct GpsFix {
  GeoPoint point;
  double msl = 0, north = 0, east = 0;  ///< m, m/s; velocity NaN if unknown
  double ellipsoid = 0, speed_sd = 0;   ///< m, m/s; NaN if not sent
};
struct FusedFix {
  GeoPoint point;
  double msl = 0, ground = 0;
  Eigen::Vector3d v_NB_N;
};
struct LocalState {
  Eigen::Vector3d p_NB_N, v_NB_N;
};

/// What is known of the vehicle over all its boots.
struct Identity {
  std::uint8_t system = 0, component = 1, type = 0, autopilot = 0;
  bool has_heartbeat = false, simulated = false, quadplane = false;
  std::string firmware;
};

class Boot {
 public:
  void take(const Binding& row, const MavlinkFrame& frame, const Stamp& stamp, Identity& identity);
  /// A pair of this vehicle's boot clock and the ground station's.
  void pair_clocks(LogTime boot, LogTime host);
  bool has_data() const;
  Flight finish(const Identity& identity, std::vector<std::pair<std::string, std::string>>& details) &&;

 private:
  void take_system_time(const Binding& row, const std::uint8_t* payload, const Stamp& stamp);
  void take_identity(const Binding& row, const std::uint8_t* payload, Identity& identity);
  void take_heartbeat(const Binding& row, const std::uint8_t* payload, const Stamp& stamp, Identity& identity);
  void take_attitude(const Binding& row, const std::uint8_t* payload, const Stamp& stamp);
  void take_gps(const Binding& row, const std::uint8_t* payload, const Stamp& stamp);
  void take_positions(const Binding& row, const std::uint8_t* payload, const Stamp& stamp);
  void take_sensors(const Binding& row, const std::uint8_t* payload, const Stamp& stamp);
  void take_wind(const Binding& row, const std::uint8_t* payload, const Stamp& stamp, const Identity& identity);
  void take_rotors(const Binding& row, const std::uint8_t* payload, const Stamp& stamp);
  void take_text(const Binding& row, const std::uint8_t* payload, const Stamp& stamp, Identity& identity);
  void note_text(const Stamp& stamp, std::string text, Identity& identity);

  template <class T>
  std::vector<LogTime> boot_times(const Column<T>& column) const;
  template <class T, class S, class Pick>
  void pour(const Column<T>& column, S& stream, Pick pick) const;
  template <class T, class S>
  void pour_all(Column<T>& column, S& stream) const;
  void tell_link(std::vector<std::pair<std::string, std::string>>& details) const;
  void finish_clock();
  void finish_velocity(Flight& flight) const;
  void finish_position(Flight& flight) const;
  void finish_wind(Flight& flight, std::vector<std::pair<std::string, std::string>>& details);

  Column<Eigen::Quaterniond> attitude_, attitude_quaternion_;
  Column<GpsFix> gps_;
  Column<FusedFix> fused_;
  Column<LocalState> local_;
  Column<double> pressure_;  ///< Pa
  Column<Eigen::Vector3d> imu_scaled_, imu_raw_, imu_highres_;
  Column<AutopilotWind> wind_, wind_cov_;
  Column<bool> landed_;
  Column<RotorSpeeds> rotors_;
  Column<AirSample> air_;
  Column<Event> events_;
  RotorSpeeds rpm_;
  Stamp rotors_since_;
  std::optional<Origin> origin_;
  std::int64_t last_fix_ = -1;
  int armed_ = -1;
  std::int64_t mode_ = -1;
  std::uint64_t without_fix_ = 0;
  std::string pending_text_;
  std::int64_t pending_id_ = 0;

  std::vector<Duration> host_minus_boot_;  ///< of a share of the frames
  std::uint64_t pairs_ = 0;
  LogTime first_host_;
  ClockEstimator utc_;
  bool has_boot_clock_ = false;
  Duration host_offset_{0};
  Clock clock_;
};

}  // namespace quadsonde::ingest::mavlink
