#include "ingest/mcap/foreign_rules.h"

#include <cmath>
#include <map>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest::foreign {
namespace {

std::string text_at(const Json& message, std::string_view path) {
  const auto* value = value_at(message, path);
  return value && value->is_string() ? value->get<std::string>() : std::string{};
}

bool contains(std::string text, std::string_view word) {
  for (auto& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return text.find(word) != text.npos;
}

/// REP 103: east-north-up and forward-left-up, unless the frame's name says NED.
bool says_ned(const std::string& frame) { return contains(frame, "ned") || contains(frame, "frd"); }

void take_attitude(LogTime t, const std::optional<Eigen::Quaterniond>& q, bool ned, Part& part) {
  if (q && q->norm() > 0.5) part.flight.attitude.push(t, ned ? *q : q_NB_from_enu_flu(*q));
}

void take_local_position(LogTime t, const std::optional<Eigen::Vector3d>& p, bool ned, Part& part) {
  if (p) part.flight.local_position.push(t, to_ours(ned ? Axes::ned : Axes::enu, *p));
}

void take_point(LogTime t, std::optional<double> lat, std::optional<double> lon, Part& part) {
  if (lat && lon) part.flight.position.push(t, {*lat, *lon});
}

/// foxglove.LocationFix. The schema does not tell the datum of its altitude; receivers give it above the sea.
void location_fix(LogTime t, const Json& m, Part& part) {
  take_point(t, number_at(m, "latitude"), number_at(m, "longitude"), part);
  if (const auto h = number_at(m, "altitude")) part.flight.height_msl.push(t, {*h});
  if (const auto v = vector_at(m, "velocity")) part.flight.velocity.push(t, to_ours(Axes::enu, *v));
}

void pose_in_frame(LogTime t, const Json& m, Part& part) {
  const bool ned = says_ned(text_at(m, "frame_id"));
  take_attitude(t, quaternion_at(m, "pose.orientation"), ned, part);
  take_local_position(t, vector_at(m, "pose.position"), ned, part);
}

void foxglove_log(LogTime t, const Json& m, Part& part) {
  if (auto text = text_at(m, "message"); !text.empty()) part.flight.events.push(t, {Event::What::text, std::move(text)});
}

/// sensor_msgs/NavSatFix: altitude is above the WGS84 ellipsoid; status below 0 is no fix.
void nav_sat_fix(LogTime t, const Json& m, Part& part) {
  if (number_at(m, "status.status").value_or(0) < 0) return;
  take_point(t, number_at(m, "latitude"), number_at(m, "longitude"), part);
  if (const auto h = number_at(m, "altitude")) part.flight.height_ellipsoid.push(t, {*h});
}

/// sensor_msgs/Imu: a first covariance of -1 says that there is no such measurement.
void imu(LogTime t, const Json& m, Part& part) {
  const bool frd = says_ned(text_at(m, "header.frame_id"));
  if (number_at(m, "orientation_covariance[0]").value_or(0) >= 0)
    take_attitude(t, quaternion_at(m, "orientation"), frd, part);
  if (number_at(m, "linear_acceleration_covariance[0]").value_or(0) < 0) return;
  if (const auto f = vector_at(m, "linear_acceleration"))
    part.flight.accelerometer.push(t, to_ours(frd ? Axes::frd : Axes::flu, *f));
}

/// nav_msgs/Odometry: the pose in header.frame_id, the twist in child_frame_id, that is, in body axes.
void odometry(LogTime t, const Json& m, Part& part) {
  const bool ned = says_ned(text_at(m, "header.frame_id")), frd = says_ned(text_at(m, "child_frame_id"));
  const auto q = quaternion_at(m, "pose.pose.orientation");
  if (!q || q->norm() < 0.5) return;
  take_attitude(t, q, ned, part);
  take_local_position(t, vector_at(m, "pose.pose.position"), ned, part);
  const auto v = vector_at(m, "twist.twist.linear");
  if (!v) return;
  const Eigen::Quaterniond q_NB = (ned ? *q : q_NB_from_enu_flu(*q)).normalized();
  part.flight.velocity.origin = VelocityOrigin::fused;
  part.flight.velocity.push(t, q_NB * to_ours(frd ? Axes::frd : Axes::flu, *v));
}

void pose_stamped(LogTime t, const Json& m, Part& part) {
  const bool ned = says_ned(text_at(m, "header.frame_id"));
  take_attitude(t, quaternion_at(m, "pose.orientation"), ned, part);
  take_local_position(t, vector_at(m, "pose.position"), ned, part);
}

/// geometry_msgs/TwistStamped: its axes are those of header.frame_id. Body axes would need the attitude of the same
/// instant; such a topic is left to the user's map.
void twist_stamped(LogTime t, const Json& m, Part& part) {
  const auto frame = text_at(m, "header.frame_id");
  if (contains(frame, "base") || contains(frame, "body") || contains(frame, "fcu")) return;
  const auto v = vector_at(m, "twist.linear");
  if (!v) return;
  part.flight.velocity.origin = VelocityOrigin::fused;
  part.flight.velocity.push(t, to_ours(says_ned(frame) ? Axes::ned : Axes::enu, *v));
}

std::optional<double> first_number(const Json& m, std::initializer_list<const char*> names) {
  for (const auto* name : names)
    if (const auto value = number_at(m, name)) return value;
  return std::nullopt;
}

std::optional<Eigen::Vector3d> three(const std::optional<double>& a, const std::optional<double>& b,
                                     const std::optional<double>& c) {
  if (!a || !b || !c) return std::nullopt;
  return Eigen::Vector3d(*a, *b, *c);
}

/// Attitude of a JSON message: qw..qz, an array q (w first, as autopilots write it), or angles in degrees.
std::optional<Eigen::Quaterniond> json_attitude(const Json& m) {
  const auto w = first_number(m, {"qw", "q[0]"}), x = first_number(m, {"qx", "q[1]"});
  const auto y = first_number(m, {"qy", "q[2]"}), z = first_number(m, {"qz", "q[3]"});
  if (w && x && y && z) return Eigen::Quaterniond(*w, *x, *y, *z);
  const auto angles = three(number_at(m, "roll_deg"), number_at(m, "pitch_deg"), number_at(m, "yaw_deg"));
  if (!angles) return std::nullopt;
  constexpr double kRadians = 3.14159265358979323846 / 180;
  return q_NB_from_euler({angles->x() * kRadians, angles->y() * kRadians, angles->z() * kRadians});
}

void json_motion(LogTime t, const Json& m, Part& part) {
  take_attitude(t, json_attitude(m), true, part);
  const auto lat = first_number(m, {"lat_deg", "lat", "latitude"}), lon = first_number(m, {"lon_deg", "lon", "longitude"});
  take_point(t, lat, lon, part);
  const auto v = three(first_number(m, {"vn_m_s", "vn"}), first_number(m, {"ve_m_s", "ve"}), first_number(m, {"vd_m_s", "vd"}));
  if (v) {
    // Beside a latitude it is the receiver's own; beside nothing or local coordinates the estimator's.
    part.flight.velocity.origin = lat && lon ? VelocityOrigin::receiver : VelocityOrigin::fused;
    part.flight.velocity.push(t, *v);
    take_local_position(t, vector_at(m, ""), true, part);
  }
  if (const auto h = first_number(m, {"height_msl_m", "alt_msl_m", "alt"}); h && (lat || m.contains("height_msl_m")))
    part.flight.height_msl.push(t, {*h});
  if (const auto h = number_at(m, "height_ellipsoid_m")) part.flight.height_ellipsoid.push(t, {*h});
  if (const auto h = number_at(m, "height_agl_m")) part.flight.height_ground.push(t, {*h});
}

void json_sensors(LogTime t, const Json& m, Part& part) {
  const auto pressure = number_at(m, "pressure_pa"), altitude = number_at(m, "baro_alt_m");
  if (pressure || altitude) part.flight.barometer.push(t, {pressure, altitude});
  const auto temperature = number_at(m, "temperature_k"), humidity = number_at(m, "relative_humidity_pct");
  if (temperature || humidity) part.flight.air.push(t, {temperature, humidity, std::nullopt});
  const auto f = three(number_at(m, "ax_m_s2"), number_at(m, "ay_m_s2"), number_at(m, "az_m_s2"));
  if (f) part.flight.accelerometer.push(t, *f);
}

void json_wind(LogTime t, const Json& m, Part& part) {
  const auto north = first_number(m, {"wind_north_m_s", "north"}), east = first_number(m, {"wind_east_m_s", "east"});
  if (!north || !east) return;
  const auto var_n = number_at(m, "var_north"), var_e = number_at(m, "var_east");
  // A variance of 0 says that it was not estimated.
  const bool known = var_n && var_e && *var_n > 0 && *var_e > 0;
  part.flight.autopilot_wind.push(
      t, {{*north, *east}, known ? std::optional(std::sqrt((*var_n + *var_e) / 2)) : std::nullopt});
}

/// ROS 1 and ROS 2 names of one type are one, and so are names of JSON and protobuf schemas.
std::string plain(std::string name) {
  if (const auto at = name.find("/msg/"); at != name.npos) name.erase(at, 4);
  return name;
}

}  // namespace

Eigen::Vector3d to_ours(Axes axes, const Eigen::Vector3d& v) {
  if (axes == Axes::enu) return {v.y(), v.x(), -v.z()};
  if (axes == Axes::flu) return {v.x(), -v.y(), -v.z()};
  return v;
}

Eigen::Quaterniond q_NB_from_enu_flu(const Eigen::Quaterniond& q) {
  // Half turns about (1, 1, 0) and about x, multiplied out; the common sign means nothing.
  const double h = std::sqrt(0.5);
  return Eigen::Quaterniond(h * (q.w() + q.z()), h * (q.x() + q.y()), h * (q.x() - q.y()), h * (q.w() - q.z()));
}

std::optional<Eigen::Vector3d> vector_at(const Json& message, const std::string& path) {
  const auto* at = value_at(message, path);
  return at ? three(number_at(*at, "x"), number_at(*at, "y"), number_at(*at, "z")) : std::nullopt;
}

std::optional<Eigen::Quaterniond> quaternion_at(const Json& message, const std::string& path) {
  const auto* at = value_at(message, path);
  const auto v = vector_at(message, path);
  const auto w = at ? number_at(*at, "w") : std::nullopt;
  if (!v || !w) return std::nullopt;
  return Eigen::Quaterniond(*w, v->x(), v->y(), v->z());
}

Rule rule_for_schema(const std::string& schema_name) {
  static const std::map<std::string, Rule> rules = {
      {"foxglove.LocationFix", location_fix},       {"foxglove.PoseInFrame", pose_in_frame},
      {"foxglove.Log", foxglove_log},               {"sensor_msgs/NavSatFix", nav_sat_fix},
      {"sensor_msgs/Imu", imu},                     {"nav_msgs/Odometry", odometry},
      {"geometry_msgs/PoseStamped", pose_stamped},  {"geometry_msgs/TwistStamped", twist_stamped},
      {"foxglove_msgs/LocationFix", location_fix},  {"foxglove_msgs/PoseInFrame", pose_in_frame}};
  const auto name = plain(schema_name);
  if (name.starts_with("px4_msgs/")) return px4_rule(name);
  const auto found = rules.find(name);
  return found == rules.end() ? Rule{} : found->second;
}

Rule rule_for_json(const std::string& topic, const std::string& schema_name) {
  const bool wind = contains(topic, "wind") || contains(schema_name, "wind");
  return [wind](LogTime t, const Json& m, Part& part) {
    json_motion(t, m, part);
    json_sensors(t, m, part);
    if (wind) json_wind(t, m, part);
  };
}

LogTime stated_time(LogTime log_time, const Json& message) {
  constexpr double kClose = 10;  // [s]
  for (const auto* path : {"header.stamp", "timestamp"}) {
    const auto* stamp = value_at(message, path);
    if (!stamp || !stamp->is_object()) continue;
    const auto whole = first_number(*stamp, {"sec", "seconds"}), part = first_number(*stamp, {"nanosec", "nsec", "nanos"});
    // Whole seconds times 1e9 must fit into 63 bits.
    if (!whole || !part || !(std::abs(*whole) < 9e9) || !(std::abs(*part) < 1e10)) continue;
    const LogTime stated{static_cast<std::int64_t>(*whole) * 1'000'000'000 + static_cast<std::int64_t>(*part)};
    if (std::abs(to_seconds(stated - log_time)) < kClose) return stated;
  }
  return log_time;
}

}  // namespace quadsonde::ingest::foreign
