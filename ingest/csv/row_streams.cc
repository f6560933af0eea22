#include "ingest/csv/row_streams.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ingest/flight/local_frame.h"
#include "ingest/flight/rotation.h"

namespace quadsonde::ingest::csv {
namespace {

constexpr double degree = std::numbers::pi / 180;
/// Attitude by quaternion and by angles may differ by rounding, not by this.
constexpr double max_contradiction = 0.5 * degree;
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// Some tables repeat their last rows; a stream keeps the first of equal times.
template <class S, class V>
void push(S& stream, LogTime t, V&& v) {
  if (stream.empty() || stream.time.back() != t) stream.push(t, std::forward<V>(v));
}

}  // namespace

RowStreams::RowStreams(const Layout& layout, std::string file, Flight& flight)
    : layout_(layout),
      file_(std::move(file)),
      flight_(flight),
      q_{slot("qw"), slot("qx"), slot("qy"), slot("qz")},
      angles_{slot("roll_deg"), slot("pitch_deg"), slot("yaw_deg")},
      velocity_{slot("vn_m_s"), slot("ve_m_s"), slot("vd_m_s")},
      local_{slot("x_m"), slot("y_m"), slot("z_m")},
      acceleration_{slot("ax_m_s2"), slot("ay_m_s2"), slot("az_m_s2")},
      sd_(slot("sd_velocity_m_s")),
      lat_(slot("lat_deg")),
      lon_(slot("lon_deg")),
      msl_(slot("height_msl_m")),
      ellipsoid_(slot("height_ellipsoid_m")),
      ground_(slot("height_agl_m")),
      baro_alt_(slot("baro_alt_m")),
      pressure_(slot("pressure_pa")),
      temperature_(slot("temperature_k")),
      humidity_(slot("relative_humidity_pct")) {
  if (msl_ < 0) msl_ = slot("alt_msl_m");
  for (int i = 1; i <= 99; ++i) {
    const int rotor = slot(fmt::format("rotor_{}_rpm", i));
    if (rotor < 0) break;
    rotors_.push_back(rotor);
  }
  flight_.attitude.source =
      q_[0] >= 0 ? columns({q_[0], q_[1], q_[2], q_[3]}) : columns({angles_[0], angles_[1], angles_[2]});
  flight_.velocity.source = columns({velocity_[0], velocity_[1], velocity_[2]});
  flight_.position.source = columns({lat_, lon_});
  flight_.local_position.source = columns({local_[0], local_[1], local_[2]});
  flight_.height_msl.source = columns({msl_});
  flight_.height_ellipsoid.source = columns({ellipsoid_});
  flight_.height_ground.source = columns({ground_});
  flight_.barometer.source = columns({pressure_, baro_alt_});
  flight_.accelerometer.source = columns({acceleration_[0], acceleration_[1], acceleration_[2]});
  flight_.air.source = columns({temperature_, humidity_});
}

int RowStreams::slot(std::string_view canonical) const {
  for (std::size_t i = 0; i < layout_.bound.size(); ++i)
    if (layout_.bound[i].canonical == canonical) return static_cast<int>(i);
  return -1;
}

/// "columns vn, ve, vd": as the table names them.
std::string RowStreams::columns(std::initializer_list<int> slots) const {
  std::string text;
  for (const int s : slots)
    if (s >= 0)
      text += (text.empty() ? "columns " : ", ") + layout_.bound[static_cast<std::size_t>(s)].source->columns.front();
  return text;
}

double RowStreams::value(const Row& row, int s) const {
  return s < 0 ? nan_value : (*row.values)[static_cast<std::size_t>(s)];
}
Eigen::Vector3d RowStreams::vector(const Row& row, const Slots3& s) const {
  return {value(row, s[0]), value(row, s[1]), value(row, s[2])};
}

void RowStreams::add(const Row& row) {
  add_attitude(row);
  add_velocity(row);
  add_place(row);
  add_sensors(row);
  if (!row.event.empty()) flight_.events.push(row.time, {Event::What::text, std::string(row.event)});
}

void RowStreams::add_attitude(const Row& row) {
  const Eigen::Quaterniond q(value(row, q_[0]), value(row, q_[1]), value(row, q_[2]), value(row, q_[3]));
  const Eigen::Vector3d a = vector(row, angles_) * degree;
  const bool has_q = q.coeffs().allFinite(), has_angles = a.allFinite();
  if (!has_q && !has_angles) return;
  const auto from_angles = has_angles ? q_NB_from_euler({a.x(), a.y(), a.z()}) : q;
  // A quaternion far from unit length is none; tidy() drops what is not a number, and says so.
  const bool unit = has_q && q.norm() > 0.5 && q.norm() < 2;
  const Eigen::Quaterniond none(nan_value, nan_value, nan_value, nan_value);
  push(flight_.attitude, row.time, unit ? q : has_q ? none : from_angles);
  if (!unit || !has_angles) return;
  ++compared_;
  const double difference = q.normalized().angularDistance(from_angles);
  if (difference <= max_contradiction) return;
  if (contradictions_++ == 0) first_contradiction_ = row.line;
  worst_contradiction_ = std::max(worst_contradiction_, difference);
}

void RowStreams::add_velocity(const Row& row) {
  auto v = vector(row, velocity_);
  if (velocity_[2] < 0) v.z() = 0;  // completed from the height at the end, or the stream is dropped
  auto& stream = flight_.velocity;
  if (!v.allFinite() || (!stream.empty() && stream.time.back() == row.time)) return;
  stream.push(row.time, v);
  if (sd_ < 0) return;
  stream.sd.push_back(value(row, sd_));
  every_sd_ = every_sd_ && stream.sd.back() > 0;
}

void RowStreams::add_place(const Row& row) {
  const GeoPoint point{value(row, lat_), value(row, lon_)};
  if (std::isfinite(point.lat_deg) && std::isfinite(point.lon_deg)) push(flight_.position, row.time, point);
  const auto p = vector(row, local_);
  if (p.allFinite()) push(flight_.local_position, row.time, p);
  if (const double h = value(row, msl_); std::isfinite(h)) push(flight_.height_msl, row.time, MslHeight{h});
  if (const double h = value(row, ellipsoid_); std::isfinite(h))
    push(flight_.height_ellipsoid, row.time, EllipsoidHeight{h});
  if (const double h = value(row, ground_); std::isfinite(h)) push(flight_.height_ground, row.time, GroundHeight{h});
}

void RowStreams::add_sensors(const Row& row) {
  const auto known = [](double x) { return std::isfinite(x) ? std::optional(x) : std::nullopt; };
  const BarometerSample barometer{known(value(row, pressure_)), known(value(row, baro_alt_))};
  if (barometer.pressure_pa || barometer.altitude_m) push(flight_.barometer, row.time, barometer);
  const AirSample air{known(value(row, temperature_)), known(value(row, humidity_)), {}};
  if (air.temperature_k || air.relative_humidity_pct) push(flight_.air, row.time, air);
  const auto f_B = vector(row, acceleration_);
  if (f_B.allFinite()) push(flight_.accelerometer, row.time, f_B);
  if (rotors_.empty()) return;
  RotorSpeeds speeds;
  bool any = false;
  for (const int rotor : rotors_) {
    speeds.push_back(static_cast<float>(value(row, rotor)));
    any = any || std::isfinite(speeds.back());
  }
  if (any) push(flight_.rotors, row.time, std::move(speeds));
}

void RowStreams::complain_of_missing(std::initializer_list<const char*> group, const char* what) {
  std::string missing;
  std::size_t present = 0;
  for (const auto* name : group) {
    if (slot(name) >= 0)
      ++present;
    else
      missing += (missing.empty() ? "" : ", ") + std::string(name);
  }
  if (present == 0 || missing.empty()) return;
  flight_.problems.push_back({Kind::missing,
                              fmt::format("there is no column for {}, so the table gives no {}", missing, what),
                              {file_, {}, layout_.header_line, missing},
                              "add it to the table, or to the map of --columns"});
}

void RowStreams::finish(std::vector<std::pair<std::string, std::string>>& details) {
  if (flight_.attitude.empty()) {
    complain_of_missing({"qw", "qx", "qy", "qz"}, "attitude");
    complain_of_missing({"roll_deg", "pitch_deg", "yaw_deg"}, "attitude");
  }
  complain_of_missing({"vn_m_s", "ve_m_s"}, "velocity");
  complain_of_missing({"lat_deg", "lon_deg"}, "position");
  if (contradictions_ > 0)
    flight_.problems.push_back(
        {Kind::inconsistent,
         fmt::format("quaternion and angles differ by up to {:.1f} deg, and by more than 0.5 deg in {} of {} rows",
                     worst_contradiction_ / degree, contradictions_, compared_),
         {file_, {}, first_contradiction_, {}},
         "the quaternion is used; if the angles are right, leave qw to qz out of the map"});
  if (!every_sd_) flight_.velocity.sd.clear();
  flight_.vehicle.rotors = layout_.map->rotors > 0 ? layout_.map->rotors : static_cast<int>(rotors_.size());
  flight_.rotors.source = rotors_.empty() ? "" : columns({rotors_.front()}) + ", ...";
  complete_velocity(details);
}

/// Where the table has no velocity it is the slope of the position; where only the vertical part is missing, that
/// is the slope of the height.
void RowStreams::complete_velocity(std::vector<std::pair<std::string, std::string>>& details) {
  auto& v = flight_.velocity;
  tidy(flight_);  // places before the first fix would make slopes of their own
  if (v.empty()) {
    const auto position_source = flight_.position.empty() ? flight_.local_position.source : flight_.position.source;
    v = differentiate_position(flight_);
    tidy(flight_);
    if (v.empty()) return;
    v.source = "slope of the position (" + position_source + ")";
    details.emplace_back("velocity", v.source + ": the table has no velocity of its own");
    return;
  }
  if (velocity_[2] >= 0) return;
  Flight vertical;
  const auto take = [&](const auto& stream) {
    if (!vertical.local_position.empty()) return;
    for (std::size_t i = 0; i < stream.size(); ++i)
      vertical.local_position.push(stream.time[i], {0, 0, -stream.value[i].m});
  };
  take(flight_.height_ground);
  take(flight_.height_msl);
  take(flight_.height_ellipsoid);
  const auto slope = differentiate_position(vertical);
  if (slope.empty()) {
    v = {};
    flight_.problems.push_back(
        {Kind::missing,
         "there is no column for vd_m_s and no height to make it of, so the table gives no velocity",
         {file_, {}, layout_.header_line, "vd_m_s"},
         "add vd_m_s or a height to the table, or to the map of --columns"});
    return;
  }
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto at = std::max<std::ptrdiff_t>(last_at_or_before(slope, v.time[i]), 0);
    v.value[i].z() = slope.value[static_cast<std::size_t>(at)].z();
  }
  tidy(flight_);
  details.emplace_back("velocity", v.source + "; its vertical part is the slope of the height");
}

}  // namespace quadsonde::ingest::csv
