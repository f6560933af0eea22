#pragma once
// A flight as it was measured: SI, NED and FRD, one log clock, nothing derived.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "ingest/flight/height.h"
#include "ingest/flight/problem.h"
#include "ingest/flight/time.h"

namespace quadsonde::ingest {

/// One measured quantity: a column of times and a column of values of the same length, in file order until
/// tidy() sorts them. `source` is what the log calls it ("vehicle_gps_position[0]", "column vn_m_s").
template <class T>
struct Stream {
  std::string source;
  std::vector<LogTime> time;
  std::vector<T> value;
  std::optional<Latency> latency = std::nullopt;  ///< empty: the log does not tell when its samples were measured

  std::size_t size() const { return time.size(); }
  bool empty() const { return time.empty(); }
  void push(LogTime t, T v) {
    time.push_back(t);
    value.push_back(std::move(v));
  }
};

/// How a velocity came about; it decides how far its noise can be trusted to be white.
enum class VelocityOrigin { receiver, fused, differentiated };

/// Ground velocity v_NB_N [m/s].
struct VelocityStream : Stream<Eigen::Vector3d> {
  VelocityOrigin origin = VelocityOrigin::receiver;
  std::vector<double> sd;  ///< 1-sigma per horizontal axis [m/s]; empty, or one per sample
};

struct GeoPoint {
  double lat_deg = 0, lon_deg = 0;  ///< WGS84
};

/// Air pressure [Pa] and the height the autopilot made of it [m]; either may be unknown.
struct BarometerSample {
  std::optional<double> pressure_pa, altitude_m;
};

/// Rotor speeds [rpm], as many as the log has; unknown ones are NaN.
using RotorSpeeds = std::vector<float>;

/// Air temperature and humidity by a sensor made for it. The autopilot board's own temperature never goes here.
struct AirSample {
  std::optional<double> temperature_k, relative_humidity_pct, pressure_pa;
};

/// The autopilot's own wind, v_NA_N north and east [m/s] (toward), kept beside ours and never fed back.
struct AutopilotWind {
  Eigen::Vector2d v_NA_N = Eigen::Vector2d::Zero();
  std::optional<double> sd;  ///< 1-sigma per axis [m/s]
};

struct Event {
  enum class What { armed, disarmed, takeoff, landed, mode, reset, text };
  What what = What::text;
  std::string text;
};

/// An interval without data that the log itself tells of (dropouts).
struct Gap {
  LogTime from, to;
};

enum class Airframe { unknown, multirotor, helicopter, fixed_wing, vtol, other };

struct VehicleIdentity {
  std::string name;       ///< as the log tells it: a serial, an airframe name, a system id
  std::string autopilot;  ///< "PX4", "ArduPilot", "Paparazzi", "DJI", empty if unknown
  std::string firmware;
  Airframe airframe = Airframe::unknown;
  int rotors = 0;          ///< 0 = unknown
  bool simulated = false;  ///< the log says that no air moved
  std::optional<double> mass_kg;
};

/// The point that local coordinates start from.
struct Origin {
  GeoPoint point;
  std::optional<MslHeight> height_msl;
};

struct Flight {
  VehicleIdentity vehicle;
  Clock clock;
  std::optional<Origin> origin;  ///< of local_position

  Stream<Eigen::Quaterniond> attitude;  ///< q_NB, unit
  VelocityStream velocity;
  Stream<GeoPoint> position;
  Stream<Eigen::Vector3d> local_position;  ///< p_NB_N [m] from origin
  Stream<MslHeight> height_msl;
  Stream<EllipsoidHeight> height_ellipsoid;
  Stream<GroundHeight> height_ground;  ///< above take-off, as logged
  Stream<BarometerSample> barometer;
  Stream<Eigen::Vector3d> accelerometer;  ///< specific force in B [m/s2], about -9.8 down when level
  Stream<RotorSpeeds> rotors;
  Stream<AirSample> air;
  Stream<AutopilotWind> autopilot_wind;
  Stream<Event> events;
  std::vector<Gap> gaps;
  /// Where the log itself says whether the vehicle is in the air; decides before any guess.
  Stream<bool> landed;

  std::vector<Problem> problems;  ///< met on the way, in the order met
};

/// One topic, message type or column of a container.
struct TopicCount {
  std::string name;
  std::uint64_t messages = 0;
};

/// All that a mapper makes of one file: also of a file without a flight in it.
struct LogContent {
  std::string format;  ///< "mcap", "ulog", "dataflash", "mavlink", "paparazzi", "csv"
  std::uint64_t messages = 0;  ///< data messages decoded
  std::uint64_t salvaged = 0;  ///< of them, found behind lost structure
  std::vector<TopicCount> topics;
  std::vector<std::pair<std::string, std::string>> details;  ///< for `info`: "map" -> "skyhub", "instances" -> ...
  std::vector<Flight> flights;     ///< one per boot of the autopilot, in file order; may be empty
  std::vector<Problem> problems;   ///< of the container; what touches one flight is in its own list
};

/// Sorts every stream by time (stable; a stream that is in order is left untouched) and drops samples that are
/// not finite, with one Problem per stream that lost any.
void tidy(Flight& flight);

/// First and last time of attitude and velocity together; empty if the flight has neither.
std::optional<std::pair<LogTime, LogTime>> time_span(const Flight& flight);

/// The flight between two times, every stream cut to [from, to].
Flight cut(const Flight& flight, LogTime from, LogTime to);

/// Index of the last sample at or before t, or -1.
template <class T>
std::ptrdiff_t last_at_or_before(const Stream<T>& stream, LogTime t) {
  return std::upper_bound(stream.time.begin(), stream.time.end(), t) - stream.time.begin() - 1;
}

}  // namespace quadsonde::ingest
