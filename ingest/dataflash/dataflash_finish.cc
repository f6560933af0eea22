// The choices among several receivers and filters, made when a boot has been read to its end.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ingest/dataflash/dataflash_boot.h"
#include "ingest/flight/rate.h"

namespace quadsonde::ingest::dataflash {
namespace {

/// For each time the nearest accuracy; the last known one where none is within a second.
std::vector<double> accuracy_at(const std::vector<LogTime>& time, const Stream<double>& accuracy) {
  std::vector<double> sd;
  if (accuracy.empty()) return sd;
  std::size_t i = 0;
  for (const auto t : time) {
    while (i + 1 < accuracy.size() && accuracy.time[i + 1] <= t) ++i;
    const bool next_is_nearer = i + 1 < accuracy.size() && accuracy.time[i + 1] - t < t - accuracy.time[i];
    sd.push_back(accuracy.value[next_is_nearer ? i + 1 : i]);
  }
  return sd;
}

/// The receiver's own delay is not in the log: what UTC shows against its quickest fix, and how long the message waited
/// in the autopilot, are both less than the whole.
std::optional<Latency> receiver_latency(const GpsColumns& gps) {
  const auto waited = latency_of(gps.waited), late = gps.clock.latency();
  if (!waited && !late) return std::nullopt;
  return Latency{std::max(waited ? waited->median_s : 0, late ? late->median_s : 0), true};
}

template <class Map>
int most_frequent(const Map& counts, int otherwise) {
  int best = otherwise;
  std::uint64_t most = 0;
  for (const auto& [value, count] : counts) {
    if (count <= most) continue;
    most = count;
    best = value;
  }
  return best;
}

Airframe airframe_of_class(int frame_class) {
  // Source: ArduPilot libraries/AP_Motors/AP_Motors_Class.h, motor_frame_class.
  if (frame_class == 6 || frame_class == 11 || frame_class == 13) return Airframe::helicopter;
  return frame_class == 0 ? Airframe::unknown : Airframe::multirotor;
}

int rotors_of_class(int frame_class) {
  constexpr int rotors[] = {0, 4, 6, 8, 8, 6, 0, 3, 1, 2, 2, 0, 12, 0, 10};
  return frame_class >= 0 && frame_class < 15 ? rotors[frame_class] : 0;
}

int rotors_of_frame(std::string_view frame) {
  constexpr std::pair<const char*, int> names[] = {{"OCTA_QUAD", 8}, {"OCTA", 8}, {"HEXA", 6},         {"Y6", 6},
                                                   {"TRI", 3},       {"QUAD", 4}, {"DODECA_HEXA", 12}, {"DECA", 10}};
  for (const auto& [name, rotors] : names)
    if (frame.starts_with(name)) return rotors;
  return 0;
}

}  // namespace

std::optional<double> Boot::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  if (found == parameters_.end()) return std::nullopt;
  return found->second;
}

VehicleIdentity Boot::identity() const {
  VehicleIdentity vehicle;
  vehicle.name = board_;
  vehicle.autopilot = "ArduPilot";
  vehicle.firmware = firmware_;
  vehicle.simulated = simulated_ || parameter("SIM_SPEEDUP").has_value();
  const auto is = [&](std::string_view kind) { return firmware_.find(kind) != std::string::npos; };
  const int frame_class = static_cast<int>(parameter("FRAME_CLASS").value_or(0));
  // Rovers have a FRAME_CLASS too; way-point speed is a parameter of multirotors.
  const bool copter =
      is("Copter V") || (firmware_.empty() && (parameter("WPNAV_SPEED") || parameter("WP_YAW_BEHAVIOR")));
  if (copter) {
    vehicle.airframe = frame_class == 0 ? Airframe::multirotor : airframe_of_class(frame_class);
    if (frame_.starts_with("HELI")) vehicle.airframe = Airframe::helicopter;
    vehicle.rotors = frame_class == 0 ? rotors_of_frame(frame_) : rotors_of_class(frame_class);
  } else if (is("Plane V") || parameter("TRIM_ARSPD_CM") || parameter("ARSPD_FBW_MIN")) {
    vehicle.airframe = parameter("Q_ENABLE").value_or(0) > 0 ? Airframe::vtol : Airframe::fixed_wing;
  } else if (is("Heli V")) {
    vehicle.airframe = Airframe::helicopter;
  } else if (!firmware_.empty()) {
    vehicle.airframe = Airframe::other;
  }
  return vehicle;
}

/// EKF2 or EKF3: by what flew (ATT), by the parameter, else by what was logged most.
int Boot::ekf_generation() const {
  std::map<int, std::uint64_t> logged;
  for (const auto& [key, ekf] : ekf_) logged[key.first] += ekf.velocity.size();
  for (const int wanted : {most_frequent(attitude_by_, 0), static_cast<int>(parameter("AHRS_EKF_TYPE").value_or(0))})
    if (const auto found = logged.find(wanted); found != logged.end() && found->second > 0) return wanted;
  return most_frequent(logged, 0);
}

/// The receiver that the vehicle used most; without that mark the one with the most fixes.
const GpsColumns* Boot::best_gps(int& instance) const {
  const GpsColumns* best = nullptr;
  for (const auto& [number, gps] : gps_) {
    if (gps.position.empty()) continue;
    if (best != nullptr && std::pair(gps.used, gps.velocity.size()) <= std::pair(best->used, best->velocity.size()))
      continue;
    best = &gps;
    instance = number;
  }
  return best;
}

void Boot::choose_velocity(int gps_instance, int ekf_generation, int core) {
  const auto ekf = ekf_.find({ekf_generation, core});
  const auto gps = gps_.find(gps_instance);
  const bool has_ekf = ekf != ekf_.end() && ekf->second.velocity.size() >= 2;
  if (gps != gps_.end() && gps->second.velocity.size() >= 2) {
    auto& receiver = gps->second;
    const bool vertical = receiver.without_vertical <= receiver.with_vertical;
    // A receiver that had a fix in less than half of the flight leaves too much of it out.
    const double covered = static_cast<double>(receiver.velocity.size()) * median_interval(receiver.velocity.time);
    const bool enough = !has_ekf || covered > 0.5 * static_cast<double>(ekf->second.velocity.size()) *
                                                  median_interval(ekf->second.velocity.time);
    if (!has_ekf || (is_fast_receiver(receiver.velocity.time) && vertical && enough)) {
      flight_.velocity = std::move(receiver.velocity);
      flight_.velocity.origin = VelocityOrigin::receiver;
      flight_.velocity.latency = receiver_latency(receiver);
      flight_.velocity.source = fmt::format("GPS[{}] Spd GCrs VZ", gps_instance);
      flight_.velocity.sd = accuracy_at(flight_.velocity.time, receiver.speed_sd);
      if (!vertical)
        flight_.problems.push_back({Kind::doubtful,
                                    "the receiver measures no vertical velocity: VZ is no measurement",
                                    {{}, {}, {}, "GPA"},
                                    "log an EKF (XKF1 or NKF1) beside it"});
      return;
    }
  }
  if (!has_ekf) return;
  flight_.velocity = std::move(ekf->second.velocity);
  flight_.velocity.origin = VelocityOrigin::fused;
  const char* message = ekf_generation == 3 ? "XKF1" : ekf_generation == 2 ? "NKF1" : "EKF1";
  flight_.velocity.source = fmt::format("{}[{}] VN VE VD", message, core);
}

void Boot::finish_gps(int instance) {
  const auto found = gps_.find(instance);
  if (found == gps_.end()) {
    flight_.position = std::move(fused_position_);
    flight_.position.source = "POS Lat Lng";
    flight_.height_msl = std::move(fused_height_);
    flight_.height_msl.source = "POS Alt";
    return;
  }
  auto& gps = found->second;
  flight_.position = std::move(gps.position);
  flight_.position.source = fmt::format("GPS[{}] Lat Lng", instance);
  flight_.height_msl = std::move(gps.height);
  flight_.height_msl.source = fmt::format("GPS[{}] Alt", instance);
  flight_.height_ellipsoid = std::move(gps.ellipsoid);
  flight_.height_ellipsoid.source = fmt::format("GPA[{}] AEl", instance);
  flight_.position.latency = flight_.height_msl.latency = flight_.height_ellipsoid.latency = receiver_latency(gps);
  flight_.clock = gps.clock.estimate("GPS week and time of week");
}

/// The land detector's own word. Before its first word the opposite held.
void Boot::finish_landed() {
  if (!saw_landing_) return;
  auto& landed = flight_.landed;
  landed.source = "EV";
  const auto& [first, on_ground_then] = landing_.front();
  const auto span = time_span(flight_);
  if (span && span->first < first) landed.push(span->first, !on_ground_then);
  for (const auto& [t, on_ground] : landing_) landed.push(t, on_ground);
}

/// Wind, position and, in need, attitude of the filter core that flew.
void Boot::finish_ekf(int generation, int core, const std::string& file, Details& details) {
  const auto found = ekf_.find({generation, core});
  if (found == ekf_.end()) return;
  auto& ekf = found->second;
  flight_.local_position = std::move(ekf.local);
  flight_.local_position.source = fmt::format("EKF{}[{}] PN PE PD", generation, core);
  const auto& wind = ekf.wind.value;
  // A filter without drag or airspeed fusion logs zeros; that is no estimate.
  if (std::any_of(wind.begin(), wind.end(), [](const auto& w) { return w.v_NA_N != Eigen::Vector2d::Zero(); })) {
    flight_.autopilot_wind = std::move(ekf.wind);
    flight_.autopilot_wind.source = fmt::format("EKF{}[{}] VWN VWE", generation, core);
  } else if (!wind.empty()) {
    details.emplace_back("autopilot wind", "zero throughout: the EKF fused neither drag nor airspeed");
  }
  if (!flight_.attitude.empty() || ekf.attitude.empty()) return;
  flight_.attitude = std::move(ekf.attitude);
  flight_.attitude.source = fmt::format("EKF{}[{}] Roll Pitch Yaw", generation, core);
  flight_.problems.push_back({Kind::missing,
                              "there is no ATT; the EKF's angles lack part of the board trim",
                              {file, {}, {}, "ATT"},
                              "let the vehicle log ATT (LOG_BITMASK attitude)"});
}

/// The core that the vehicle said it used; without that word the one with the most states.
int Boot::primary_core(int generation, std::size_t& cores) const {
  std::map<int, std::uint64_t> said, logged;
  for (const auto& [key, count] : primary_)
    if (key.first == generation && ekf_.contains(key)) said[key.second] = count;
  for (const auto& [key, ekf] : ekf_)
    if (key.first == generation) logged[key.second] = ekf.velocity.size();
  cores = logged.size();
  return most_frequent(said, most_frequent(logged, 0));
}

void Boot::name_sources() {
  if (flight_.attitude.source.empty()) flight_.attitude.source = "ATT Roll Pitch Yaw";
  flight_.height_ground.source = "POS RelHomeAlt";
  flight_.barometer.latency = latency_of(std::move(barometer_ages_));
  flight_.barometer.source = fmt::format("BARO[{}]", std::max(barometer_instance_, 0));
  flight_.accelerometer.source = fmt::format("IMU[{}]", std::max(imu_instance_, 0));
  flight_.rotors.source = "ESC RPM";
  flight_.air.source = "HYGR";
  flight_.events.source = "EV ARM MODE MSG";
}

void Boot::note_rejected(const std::string& file) {
  for (const auto& [name, rejected] : rejected_)
    flight_.problems.push_back(
        {Kind::damaged,
         fmt::format("{} message{} with values that no such sensor gives, or cut by garbage, left out", rejected.count,
                     rejected.count == 1 ? "" : "s"),
         {file, rejected.first_at, {}, name},
         "the rest is used"});
}

Flight Boot::finish(const std::string& file, Details& details) && {
  flight_.vehicle = identity();
  int receiver = -1;
  best_gps(receiver);
  const int generation = ekf_generation();
  std::size_t cores = 0;
  const int core = primary_core(generation, cores);
  finish_ekf(generation, core, file, details);
  choose_velocity(receiver, generation, core);
  for (const auto& [number, gps] : gps_)
    if (gps.without_fix > 0)
      details.emplace_back(fmt::format("GPS[{}] without a 3D fix", number),
                           fmt::format("{} messages", gps.without_fix));
  if (gps_.size() > 1) details.emplace_back("receiver used", fmt::format("GPS[{}] of {}", receiver, gps_.size()));
  if (cores > 0) details.emplace_back("filter used", fmt::format("EKF{} core {} of {}", generation, core, cores));
  finish_gps(receiver);
  name_sources();
  note_rejected(file);
  tidy(flight_);
  finish_landed();
  return std::move(flight_);
}

}  // namespace quadsonde::ingest::dataflash
