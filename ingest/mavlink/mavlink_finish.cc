// What is chosen among several messages of one meaning, once a boot has been heard to its end.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ingest/flight/rate.h"
#include "ingest/mavlink/mavlink_vehicle.h"

namespace quadsonde::ingest::mavlink {
namespace {

constexpr std::uint8_t autopilot_ardupilot = 3, autopilot_px4 = 12;
// Before the last leap second a firmware's fixed number of them may be wrong by one.
constexpr std::int64_t last_leap_second_ns = 1'483'228'800'000'000'000;
constexpr std::int64_t year_2010_ns = 1'262'304'000'000'000'000;

/// Source: mavlink/mavlink minimal.xml, MAV_TYPE.
void set_airframe(const Identity& identity, VehicleIdentity& vehicle) {
  constexpr std::pair<int, int> multirotors[] = {{2, 4}, {3, 2}, {13, 6}, {14, 8}, {15, 3}, {29, 12}, {35, 10}};
  for (const auto& [type, rotors] : multirotors) {
    if (identity.type != type) continue;
    vehicle.airframe = Airframe::multirotor;
    vehicle.rotors = rotors;
    return;
  }
  if (identity.type == 4)
    vehicle.airframe = Airframe::helicopter;
  else if (identity.type == 1)
    vehicle.airframe = identity.quadplane ? Airframe::vtol : Airframe::fixed_wing;
  else if (identity.type >= 19 && identity.type <= 25)
    vehicle.airframe = Airframe::vtol;
  else if (identity.has_heartbeat && identity.type != 0)
    vehicle.airframe = Airframe::other;
}

VehicleIdentity vehicle_of(const Identity& identity) {
  VehicleIdentity vehicle;
  vehicle.name = fmt::format("system {}", identity.system);
  if (identity.autopilot == autopilot_ardupilot) vehicle.autopilot = "ArduPilot";
  if (identity.autopilot == autopilot_px4) vehicle.autopilot = "PX4";
  vehicle.firmware = identity.firmware;
  vehicle.simulated = identity.simulated;
  set_airframe(identity, vehicle);
  return vehicle;
}

/// Down velocity of the nearest fused sample within half a second; NaN without one.
class DownAt {
 public:
  explicit DownAt(const Stream<Eigen::Vector3d>& fused) : fused_(fused) {}
  double operator()(LogTime t) {
    const auto after = std::lower_bound(fused_.time.begin(), fused_.time.end(), t);
    const auto i = static_cast<std::size_t>(after - fused_.time.begin());
    double best = 0.5, down = std::numeric_limits<double>::quiet_NaN();
    for (const auto k : {i, i == 0 ? i : i - 1}) {
      if (k >= fused_.size() || std::abs(to_seconds(fused_.time[k] - t)) > best) continue;
      best = std::abs(to_seconds(fused_.time[k] - t));
      down = fused_.value[k].z();
    }
    return down;
  }

 private:
  const Stream<Eigen::Vector3d>& fused_;
};

void sort_by_time(Stream<Eigen::Vector3d>& stream) {
  if (std::is_sorted(stream.time.begin(), stream.time.end())) return;
  std::vector<std::size_t> order(stream.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return stream.time[a] < stream.time[b]; });
  Stream<Eigen::Vector3d> sorted;
  for (const auto i : order) sorted.push(stream.time[i], stream.value[i]);
  sorted.source = stream.source;
  stream = std::move(sorted);
}

}  // namespace

template <class T>
std::vector<LogTime> Boot::boot_times(const Column<T>& column) const {
  std::vector<LogTime> times = column.time;
  std::size_t utc = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (column.clock[i] == Stamp::Clock::boot) continue;
    const bool is_utc = column.clock[i] == Stamp::Clock::utc;
    const LogTime host = is_utc ? column.host_of_utc[utc++] : times[i];
    // Without a pair of UTC and boot time the ground station's time of arrival is all there is.
    if (is_utc && !utc_.empty())
      times[i] = *clock_.to_log(UtcTime{times[i].ns});
    else
      times[i] = host - host_offset_;
  }
  return times;
}

template <class T, class S, class Pick>
void Boot::pour(const Column<T>& column, S& stream, Pick pick) const {
  const auto times = boot_times(column);
  stream.time.reserve(times.size());
  stream.value.reserve(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    auto value = pick(column.value[i]);
    if constexpr (requires {
                    value.has_value();
                    *value;
                  }) {
      if (value) stream.push(times[i], *value);
    } else {
      stream.push(times[i], std::move(value));
    }
  }
}

/// A column that becomes a stream as it is, and is no longer needed.
template <class T, class S>
void Boot::pour_all(Column<T>& column, S& stream) const {
  stream.time = boot_times(column);
  stream.value = std::move(column.value);
  column = {};
}

/// How late frames reach the log, against the quickest: the times of the streams are the vehicle's and free of it.
void Boot::tell_link(std::vector<std::pair<std::string, std::string>>& details) const {
  ClockEstimator link;
  for (const auto offset : host_minus_boot_) link.add(LogTime{offset.count()}, UtcTime{});
  if (const auto latency = link.latency())
    details.emplace_back("link",
                         fmt::format("frames are logged {:.3f} s (median) after the quickest one", latency->median_s));
}

/// The vehicle's own UTC; else the ground station's clock, which may be wrong by seconds.
void Boot::finish_clock() {
  if (has_boot_clock_) {
    const auto middle = host_minus_boot_.begin() + static_cast<std::ptrdiff_t>(host_minus_boot_.size() / 2);
    std::nth_element(host_minus_boot_.begin(), middle, host_minus_boot_.end());
    host_offset_ = *middle;
  }
  if (!utc_.empty()) {
    clock_ = utc_.estimate("autopilot UTC (SYSTEM_TIME)");
    if (clock_.utc_minus_log->count() < last_leap_second_ns) clock_.uncertainty_s = std::max(clock_.uncertainty_s, 1.0);
    return;
  }
  if (first_host_.ns < year_2010_ns) return;
  clock_.utc_minus_log = host_offset_;
  clock_.uncertainty_s = 2;
  clock_.source = "ground station's clock";
}

void Boot::finish_velocity(Flight& flight) const {
  Stream<Eigen::Vector3d> fused, receiver;
  std::vector<double> sd;
  // LOCAL_POSITION_NED is finer than 1 cm/s; it may come more rarely.
  if (2 * local_.size() >= fused_.size()) {
    pour(local_, fused, [](const LocalState& s) { return s.v_NB_N; });
    fused.source = "LOCAL_POSITION_NED vx vy vz";
  } else {
    pour(fused_, fused, [](const FusedFix& s) { return s.v_NB_N; });
    fused.source = "GLOBAL_POSITION_INT vx vy vz";
  }
  sort_by_time(fused);
  DownAt down(fused);
  bool all_sd = true;
  const auto times = boot_times(gps_);
  for (std::size_t i = 0; i < gps_.size(); ++i) {
    const auto& fix = gps_.value[i];
    const auto t = times[i];
    const double vertical = down(t);
    if (!std::isfinite(fix.north) || !std::isfinite(vertical)) continue;
    receiver.push(t, {fix.north, fix.east, vertical});
    sd.push_back(fix.speed_sd);
    all_sd = all_sd && std::isfinite(fix.speed_sd);
  }
  const double step = median_interval(receiver.time), fused_step = median_interval(fused.time);
  const bool enough =
      static_cast<double>(receiver.size()) * step > 0.5 * static_cast<double>(fused.size()) * fused_step;
  auto& velocity = flight.velocity;
  if (is_fast_receiver(receiver.time) && enough) {
    static_cast<Stream<Eigen::Vector3d>&>(velocity) = std::move(receiver);
    velocity.origin = VelocityOrigin::receiver;
    velocity.source = "GPS_RAW_INT vel cog, down of " + fused.source.substr(0, fused.source.find(' '));
    if (all_sd) velocity.sd = std::move(sd);
    return;
  }
  static_cast<Stream<Eigen::Vector3d>&>(velocity) = std::move(fused);
  velocity.origin = VelocityOrigin::fused;
}

void Boot::finish_position(Flight& flight) const {
  pour(local_, flight.local_position, [](const LocalState& s) { return s.p_NB_N; });
  flight.local_position.source = "LOCAL_POSITION_NED x y z";
  flight.origin = origin_;
  pour(fused_, flight.height_ground, [](const FusedFix& s) { return GroundHeight{s.ground}; });
  flight.height_ground.source = "GLOBAL_POSITION_INT relative_alt";
  if (gps_.size() >= 2) {
    pour(gps_, flight.position, [](const GpsFix& s) { return s.point; });
    pour(gps_, flight.height_msl, [](const GpsFix& s) { return MslHeight{s.msl}; });
    pour(gps_, flight.height_ellipsoid, [](const GpsFix& s) {
      return std::isfinite(s.ellipsoid) ? std::optional(EllipsoidHeight{s.ellipsoid}) : std::nullopt;
    });
    flight.position.source = "GPS_RAW_INT lat lon";
    flight.height_msl.source = "GPS_RAW_INT alt";
    flight.height_ellipsoid.source = "GPS_RAW_INT alt_ellipsoid";
  } else {
    pour(fused_, flight.position, [](const FusedFix& s) { return s.point; });
    pour(fused_, flight.height_msl, [](const FusedFix& s) { return MslHeight{s.msl}; });
    flight.position.source = "GLOBAL_POSITION_INT lat lon";
    flight.height_msl.source = "GLOBAL_POSITION_INT alt";
  }
}

void Boot::finish_wind(Flight& flight, std::vector<std::pair<std::string, std::string>>& details) {
  const bool with_sd = wind_cov_.size() > 0;
  auto& wind = with_sd ? wind_cov_ : wind_;
  if (wind.size() == 0) return;
  // A filter without drag or airspeed fusion sends zeros; that is no estimate.
  if (std::all_of(wind.value.begin(), wind.value.end(), [](const auto& w) { return w.v_NA_N.norm() == 0; })) {
    details.emplace_back("autopilot wind", "zero throughout: no estimate");
    return;
  }
  pour_all(wind, flight.autopilot_wind);
  flight.autopilot_wind.source = with_sd ? "WIND_COV wind_x wind_y" : "WIND direction speed";
}

Flight Boot::finish(const Identity& identity, std::vector<std::pair<std::string, std::string>>& details) && {
  Flight flight;
  flight.vehicle = vehicle_of(identity);
  tell_link(details);
  finish_clock();
  flight.clock = clock_;
  const bool quaternion = attitude_quaternion_.size() >= attitude_.size();
  pour_all(quaternion ? attitude_quaternion_ : attitude_, flight.attitude);
  flight.attitude.source = quaternion ? "ATTITUDE_QUATERNION q1 q2 q3 q4" : "ATTITUDE roll pitch yaw";
  finish_velocity(flight);
  finish_position(flight);
  finish_wind(flight, details);
  pour(pressure_, flight.barometer, [](double pa) { return BarometerSample{pa, std::nullopt}; });
  flight.barometer.source = "SCALED_PRESSURE press_abs";
  // RAW_IMU has a scale only where ArduPilot sends it.
  const bool raw_is_scaled = identity.autopilot == autopilot_ardupilot;
  auto& imu = imu_highres_.size() > 0                    ? imu_highres_
              : imu_scaled_.size() > 0 || !raw_is_scaled ? imu_scaled_
                                                         : imu_raw_;
  flight.accelerometer.source = &imu == &imu_highres_ ? "HIGHRES_IMU" : &imu == &imu_raw_ ? "RAW_IMU" : "SCALED_IMU";
  pour_all(imu, flight.accelerometer);
  pour_all(landed_, flight.landed);
  flight.landed.source = "EXTENDED_SYS_STATE landed_state";
  pour_all(rotors_, flight.rotors);
  flight.rotors.source = "ESC rpm";
  pour_all(air_, flight.air);
  flight.air.source = "HYGROMETER_SENSOR";
  pour_all(events_, flight.events);
  flight.events.source = "HEARTBEAT STATUSTEXT";
  if (without_fix_ > 0) details.emplace_back("GPS_RAW_INT without a 3D fix", fmt::format("{} messages", without_fix_));
  tidy(flight);
  return flight;
}

}  // namespace quadsonde::ingest::mavlink
