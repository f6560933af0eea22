#include <fmt/format.h>

#include <algorithm>

#include "ingest/ulog/topic_reader.h"
#include "ingest/ulog/topics.h"

namespace quadsonde::ingest::ulog {
namespace {

/// A slower receiver than this leaves manoeuvres unseen; the estimator's velocity is better then.
constexpr double min_receiver_rate = 4.0;
/// Seconds since 1970 in us below which a receiver has not found its date (2014).
constexpr std::int64_t min_utc_us = 1'400'000'000'000'000;
constexpr std::int64_t max_utc_us = 4'102'444'800'000'000;  // 2100

/// A number that one generation of the firmware writes under another name and unit than the next.
class ScaledColumn {
 public:
  struct Spelling {
    const char* name;
    double factor;  ///< to deg or m
  };
  ScaledColumn(const TopicReader& reader, std::initializer_list<Spelling> spellings) {
    for (const auto& [name, factor] : spellings) {
      if (column_) break;
      column_ = reader.column(name);
      factor_ = factor;
    }
  }
  /// NaN where no spelling is there.
  double operator()(Bytes row) const { return real(row, column_) * factor_; }

 private:
  std::optional<Column> column_;
  double factor_ = 1;
};

/// vehicle_gps_position (all versions), sensor_gps (1.12 on): both have the same fields. Position was int32 1e-7 deg
/// and mm, from 1.15 double deg and m. s_variance_m_s is a standard deviation [m/s] despite its name.
struct GpsColumns {
  explicit GpsColumns(const TopicReader& r)
      : north(r.column("vel_n_m_s")),
        east(r.column("vel_e_m_s")),
        down(r.column("vel_d_m_s")),
        speed_sd(r.column("s_variance_m_s")),
        fix(r.column("fix_type")),
        valid(r.column("vel_ned_valid")),
        lat_deg(r, {{"latitude_deg", 1}, {"lat", 1e-7}}),
        lon_deg(r, {{"longitude_deg", 1}, {"lon", 1e-7}}),
        height_msl(r, {{"altitude_msl_m", 1}, {"alt", 1e-3}}),
        height_ellipsoid(r, {{"altitude_ellipsoid_m", 1}, {"alt_ellipsoid", 1e-3}}),
        utc(r.column("time_utc_usec")),
        utc_offset(r.column("timestamp_time_relative")) {}

  bool has_fix(Bytes row) const { return real(row, fix) >= 3; }
  Eigen::Vector3d velocity(Bytes row) const { return {real(row, north), real(row, east), real(row, down)}; }
  bool usable_velocity(Bytes row) const { return has_fix(row) && flag(row, valid, true) && velocity(row).allFinite(); }
  GeoPoint point(Bytes row) const { return {lat_deg(row), lon_deg(row)}; }

  std::optional<Column> north, east, down, speed_sd, fix, valid;
  ScaledColumn lat_deg, lon_deg, height_msl, height_ellipsoid;
  std::optional<Column> utc, utc_offset;
};

struct Coverage {
  std::size_t samples = 0;
  LogTime first, last;
  void add(LogTime t) {
    first = samples == 0 ? t : std::min(first, t);
    last = samples == 0 ? t : std::max(last, t);
    ++samples;
  }
  double span() const { return samples > 1 ? to_seconds(last - first) : 0; }
  double rate() const { return span() > 0 ? static_cast<double>(samples - 1) / span() : 0; }
};

struct Receiver {
  const Topic* topic = nullptr;
  Coverage velocity;  ///< of usable velocities
  std::size_t fixes = 0;
};

Receiver survey(const Log& log, const Topic& topic) {
  const TopicReader reader(log, topic);
  const GpsColumns gps(reader);
  Receiver receiver{&topic, {}, 0};
  reader.for_each([&](LogTime t, Bytes row) {
    if (!gps.has_fix(row)) return;
    ++receiver.fixes;
    if (gps.usable_velocity(row)) receiver.velocity.add(t);
  });
  return receiver;
}

/// The receiver with the most usable velocities; the autopilot's own choice first where they are equal.
Receiver best_receiver(const Log& log, std::vector<std::pair<std::string, std::string>>& details) {
  Receiver best;
  std::string all;
  for (const auto* name : {"vehicle_gps_position", "sensor_gps"})
    for (const auto& topic : log.topics) {
      if (topic.name != name) continue;
      const auto receiver = survey(log, topic);
      all += fmt::format("{}{}[{}]: {} fixes, {:.1f} Hz", all.empty() ? "" : "; ", topic.name, topic.multi_id,
                         receiver.fixes, receiver.velocity.rate());
      const auto key = [](const Receiver& r) { return std::pair(r.velocity.samples, r.fixes); };
      if (!best.topic || key(receiver) > key(best)) best = receiver;
    }
  if (!all.empty()) details.emplace_back("receivers", all);
  return best;
}

/// Pairs of log time and UTC of one receiver topic. UTC is that of the instant timestamp + timestamp_time_relative;
/// PX4 has done the leap seconds.
ClockEstimator clock_of(const TopicReader& reader) {
  ClockEstimator clock;
  const GpsColumns gps(reader);
  for (std::size_t i = 0; gps.utc && i < reader.size(); ++i) {
    const auto row = reader.row(i);
    const auto t = reader.time(row);
    const auto utc_us = integer(row, *gps.utc);
    if (!t || !gps.has_fix(row) || !utc_us || *utc_us < min_utc_us || *utc_us > max_utc_us) continue;
    const double relative_us = gps.utc_offset ? real(row, gps.utc_offset) : 0.0;
    if (!(std::abs(relative_us) < 1e9)) continue;
    clock.add(*t + seconds(relative_us * 1e-6), UtcTime{*utc_us * 1000});
  }
  return clock;
}

void take_clock(Mapping& m) {
  ClockEstimator clock;
  for (const auto* name : {"vehicle_gps_position", "sensor_gps"})
    if (const auto* topic = find_topic(m.log, name); topic && clock.empty())
      clock = clock_of(TopicReader(m.log, *topic));
  m.flight.clock = clock.estimate("autopilot UTC (time_utc_usec)");
}

/// By the driver's own time of measurement; else what UTC shows.
std::optional<Latency> receiver_latency(const TopicReader& reader) {
  const auto told = reader.latency();
  return told ? told : clock_of(reader).latency();
}

void take_receiver_velocity(Mapping& m, const Topic& topic) {
  const TopicReader reader(m.log, topic);
  const GpsColumns gps(reader);
  auto& v = m.flight.velocity;
  v.source = reader.name();
  v.origin = VelocityOrigin::receiver;
  v.latency = receiver_latency(reader);
  bool every_sd = true;
  reader.for_each([&](LogTime t, Bytes row) {
    if (!gps.usable_velocity(row)) return;
    v.push(t, gps.velocity(row));
    v.sd.push_back(real(row, gps.speed_sd));
    every_sd = every_sd && v.sd.back() > 0 && v.sd.back() < 1e3;
  });
  if (!every_sd) v.sd.clear();
}

void take_receiver_position(Mapping& m, const Topic& topic) {
  const TopicReader reader(m.log, topic);
  const GpsColumns gps(reader);
  auto& f = m.flight;
  f.position.source = f.height_msl.source = f.height_ellipsoid.source = reader.name();
  f.position.latency = f.height_msl.latency = f.height_ellipsoid.latency = receiver_latency(reader);
  reader.for_each([&](LogTime t, Bytes row) {
    if (!gps.has_fix(row)) return;
    const auto point = gps.point(row);
    if (std::isfinite(point.lat_deg) && std::isfinite(point.lon_deg)) f.position.push(t, point);
    if (const double h = gps.height_msl(row); std::isfinite(h)) f.height_msl.push(t, {h});
    // Drivers that do not know it leave exactly zero.
    if (const double h = gps.height_ellipsoid(row); std::isfinite(h) && h != 0) f.height_ellipsoid.push(t, {h});
  });
}

/// vehicle_local_position: NED metres from ref_lat, ref_lon (deg), ref_alt (m AMSL); vx, vy, vz; evh = sd [m/s].
/// All versions. NaN references until the estimator knows where it is.
struct LocalColumns {
  explicit LocalColumns(const TopicReader& r)
      : x(r.column("x")),
        y(r.column("y")),
        z(r.column("z")),
        vx(r.column("vx")),
        vy(r.column("vy")),
        vz(r.column("vz")),
        sd(r.column("evh")),
        xy(r.column("xy_valid")),
        zz(r.column("z_valid")),
        vxy(r.column("v_xy_valid")),
        vzz(r.column("v_z_valid")),
        lat(r.column("ref_lat")),
        lon(r.column("ref_lon")),
        alt(r.column("ref_alt")),
        xy_global(r.column("xy_global")),
        z_global(r.column("z_global")),
        resets(r.column("vxy_reset_counter")) {}
  std::optional<Column> x, y, z, vx, vy, vz, sd, xy, zz, vxy, vzz, lat, lon, alt, xy_global, z_global, resets;
};

void take_local_position(Mapping& m, const Topic& topic) {
  const TopicReader reader(m.log, topic);
  const LocalColumns c(reader);
  auto& f = m.flight;
  f.local_position.source = reader.name();
  f.local_position.latency = reader.latency();
  reader.for_each([&](LogTime t, Bytes row) {
    if (!flag(row, c.xy, true) || !flag(row, c.zz, true)) return;
    const Eigen::Vector3d p(real(row, c.x), real(row, c.y), real(row, c.z));
    if (p.allFinite()) f.local_position.push(t, p);
    const GeoPoint ref{real(row, c.lat), real(row, c.lon)};
    if (!flag(row, c.xy_global, true) || !std::isfinite(ref.lat_deg + ref.lon_deg) ||
        (ref.lat_deg == 0 && ref.lon_deg == 0))
      return;
    const bool moved = f.origin && (std::abs(f.origin->point.lat_deg - ref.lat_deg) > 1e-7 ||
                                    std::abs(f.origin->point.lon_deg - ref.lon_deg) > 1e-7);
    if (moved) f.events.push(t, {Event::What::reset, "the origin of the local position moved"});
    f.origin = Origin{ref, {}};
    if (const double alt = real(row, c.alt); flag(row, c.z_global, true) && std::isfinite(alt))
      f.origin->height_msl = MslHeight{alt};
  });
}

Coverage fused_coverage(const Log& log, const Topic* topic) {
  Coverage coverage;
  if (!topic) return coverage;
  const TopicReader reader(log, *topic);
  const LocalColumns c(reader);
  reader.for_each([&](LogTime t, Bytes row) {
    if (flag(row, c.vxy, true) && flag(row, c.vzz, true)) coverage.add(t);
  });
  return coverage;
}

void take_fused_velocity(Mapping& m, const Topic& topic) {
  const TopicReader reader(m.log, topic);
  const LocalColumns c(reader);
  auto& v = m.flight.velocity;
  v.source = reader.name();
  v.origin = VelocityOrigin::fused;
  v.latency = reader.latency();
  bool every_sd = true;
  std::optional<double> resets;
  reader.for_each([&](LogTime t, Bytes row) {
    if (!flag(row, c.vxy, true) || !flag(row, c.vzz, true)) return;
    v.push(t, {real(row, c.vx), real(row, c.vy), real(row, c.vz)});
    v.sd.push_back(real(row, c.sd));
    every_sd = every_sd && v.sd.back() > 0 && v.sd.back() < 1e3;
    if (!c.resets) return;
    const double now = real(row, c.resets);
    if (resets && *resets != now) m.flight.events.push(t, {Event::What::reset, "the estimator's velocity jumped"});
    resets = now;
  });
  if (!every_sd) v.sd.clear();
}

/// vehicle_global_position: lat, lon (deg), alt (m AMSL) of the estimator; all versions.
void take_global_position(Mapping& m, const Topic& topic) {
  const TopicReader reader(m.log, topic);
  const auto lat = reader.column("lat"), lon = reader.column("lon"), alt = reader.column("alt");
  auto& f = m.flight;
  f.position.source = f.height_msl.source = reader.name();
  f.position.latency = f.height_msl.latency = reader.latency();
  reader.for_each([&](LogTime t, Bytes row) {
    f.position.push(t, {real(row, lat), real(row, lon)});
    if (const double h = real(row, alt); std::isfinite(h)) f.height_msl.push(t, {h});
  });
}

/// MSL height from the local position when nothing else tells it.
void take_height_from_local(Flight& f) {
  if (!f.height_msl.empty() || !f.origin || !f.origin->height_msl) return;
  f.height_msl.source = f.local_position.source + " and its origin";
  for (std::size_t i = 0; i < f.local_position.size(); ++i)
    f.height_msl.push(f.local_position.time[i], {f.origin->height_msl->m - f.local_position.value[i].z()});
}

}  // namespace

void map_navigation(Mapping& m) {
  const auto receiver = best_receiver(m.log, m.details);
  const auto* local = find_topic(m.log, "vehicle_local_position");
  const auto* global = find_topic(m.log, "vehicle_global_position");
  take_clock(m);
  if (local) take_local_position(m, *local);
  if (receiver.topic && receiver.fixes > 0)
    take_receiver_position(m, *receiver.topic);
  else if (global)
    take_global_position(m, *global);
  take_height_from_local(m.flight);

  // The receiver's own velocity has white noise and a stated accuracy; the estimator's is smoother but already
  // holds the autopilot's idea of the motion. So the receiver, where it is quick enough and covers the flight.
  const auto fused = fused_coverage(m.log, local);
  const auto& own = receiver.velocity;
  const bool covers = own.span() >= 0.5 * fused.span();
  if (own.samples > 1 && ((own.rate() >= min_receiver_rate && covers) || fused.samples < 2))
    take_receiver_velocity(m, *receiver.topic);
  else if (fused.samples > 0)
    take_fused_velocity(m, *local);
  const auto& v = m.flight.velocity;
  if (v.empty()) return;
  m.details.emplace_back(
      "velocity", fmt::format("{} ({})", v.source, v.origin == VelocityOrigin::receiver ? "receiver" : "estimator"));
}

}  // namespace quadsonde::ingest::ulog
