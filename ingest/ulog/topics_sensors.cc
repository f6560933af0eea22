#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ingest/ulog/topic_reader.h"
#include "ingest/ulog/topics.h"

namespace quadsonde::ingest::ulog {
namespace {

using Columns3 = std::array<std::optional<Column>, 3>;

Columns3 columns3(const TopicReader& reader, std::string_view array) {
  Columns3 columns;
  for (std::size_t k = 0; k < 3; ++k) columns[k] = reader.column(fmt::format("{}[{}]", array, k));
  return columns;
}

Eigen::Vector3d vector3(Bytes row, const Columns3& columns) {
  return {real(row, columns[0]), real(row, columns[1]), real(row, columns[2])};
}

const Topic* fuller(const Topic* a, const Topic* b) {
  if (!a || !b) return a ? a : b;
  return b->messages > a->messages ? b : a;
}

}  // namespace

void map_attitude(Mapping& m) {
  const auto* topic = find_topic(m.log, "vehicle_attitude");
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  std::array<std::optional<Column>, 4> q;
  for (std::size_t k = 0; k < 4; ++k) q[k] = reader.column(fmt::format("q[{}]", k));
  const auto counter = reader.column("quat_reset_counter");  // from 1.8 on
  auto& attitude = m.flight.attitude;
  reader.name_source(attitude);
  std::optional<double> resets;
  reader.for_each([&](LogTime t, Bytes row) {
    attitude.push(t, Eigen::Quaterniond(real(row, q[0]), real(row, q[1]), real(row, q[2]), real(row, q[3])));
    if (!counter) return;
    const double now = real(row, counter);
    if (resets && *resets != now) m.flight.events.push(t, {Event::What::reset, "the attitude estimate jumped"});
    resets = now;
  });
  if (!attitude.empty()) m.details.emplace_back("attitude", attitude.source);
}

/// sensor_combined.accelerometer_m_s2 (all versions) or vehicle_acceleration.xyz (1.11 on, filtered): m/s2, FRD,
/// specific force. The one that was logged more often; it is often thinned.
void map_accelerometer(Mapping& m) {
  const auto* topic = fuller(find_topic(m.log, "sensor_combined"), find_topic(m.log, "vehicle_acceleration"));
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const bool combined = topic->name == "sensor_combined";
  const auto columns = columns3(reader, combined ? "accelerometer_m_s2" : "xyz");
  const auto relative = reader.column("accelerometer_timestamp_relative");
  constexpr double invalid = 0x7FFFFFFF;  // RELATIVE_TIMESTAMP_INVALID
  auto& stream = m.flight.accelerometer;
  reader.name_source(stream);
  reader.for_each([&](LogTime t, Bytes row) {
    const auto f_B = vector3(row, columns);
    const double offset_us = relative ? real(row, relative) : 0.0;
    if (f_B.allFinite() && offset_us != invalid) stream.push(t + seconds(offset_us * 1e-6), f_B);
  });
}

/// vehicle_air_data (1.8 on: Pa, m), else sensor_combined.baro_alt_meter, else sensor_baro.pressure (mbar up to
/// 1.12, Pa later). Their temperature is the board's and is not taken.
void map_barometer(Mapping& m) {
  const Topic* topic = nullptr;
  for (const auto* name : {"vehicle_air_data", "sensor_baro", "sensor_combined"}) {
    const auto* found = find_topic(m.log, name);
    if (!found || found->messages == 0) continue;
    const TopicReader reader(m.log, *found);
    if (!reader.column_of({"baro_pressure_pa", "baro_alt_meter", "pressure"})) continue;
    topic = found;
    break;
  }
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const auto pressure = reader.column_of({"baro_pressure_pa", "pressure"});
  const auto altitude = reader.column_of({"baro_alt_meter", "altitude"});
  auto& stream = m.flight.barometer;
  reader.name_source(stream);
  reader.for_each([&](LogTime t, Bytes row) {
    BarometerSample sample;
    const double p = real(row, pressure);
    if (p > 10) sample.pressure_pa = p < 2000 ? p * 100 : p;
    // Exactly zero without a pressure is what a missing barometer writes.
    const double h = real(row, altitude);
    if (std::isfinite(h) && (h != 0 || sample.pressure_pa)) sample.altitude_m = h;
    if (sample.pressure_pa || sample.altitude_m) stream.push(t, sample);
  });
}

/// sensor_hygrometer (1.13 on): degC and % of a sensor made for the air.
void map_air(Mapping& m) {
  const auto* topic = find_topic(m.log, "sensor_hygrometer");
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const auto temperature = reader.column("temperature"), humidity = reader.column("humidity");
  auto& stream = m.flight.air;
  reader.name_source(stream);
  reader.for_each([&](LogTime t, Bytes row) {
    AirSample sample;
    if (const double c = real(row, temperature); std::isfinite(c)) sample.temperature_k = c + 273.15;
    if (const double h = real(row, humidity); std::isfinite(h)) sample.relative_humidity_pct = h;
    if (sample.temperature_k || sample.relative_humidity_pct) stream.push(t, sample);
  });
}

/// esc_status.esc[i].esc_rpm, of the esc_count first of 8.
void map_rotors(Mapping& m) {
  const auto* topic = find_topic(m.log, "esc_status");
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const auto count = reader.column("esc_count");
  std::vector<std::optional<Column>> rpm;
  while (rpm.size() < 32) {
    const auto column = reader.column(fmt::format("esc[{}].esc_rpm", rpm.size()));
    if (!column) break;
    rpm.push_back(column);
  }
  auto& stream = m.flight.rotors;
  reader.name_source(stream);
  reader.for_each([&](LogTime t, Bytes row) {
    const double escs = std::clamp(count ? real(row, count) : 0.0, 0.0, static_cast<double>(rpm.size()));
    if (!(escs > 0)) return;
    RotorSpeeds speeds;
    for (std::size_t k = 0; k < static_cast<std::size_t>(escs); ++k)
      speeds.push_back(static_cast<float>(real(row, rpm[k])));
    stream.push(t, std::move(speeds));
  });
}

namespace {

struct WindColumns {
  explicit WindColumns(const TopicReader& r)
      : north(r.column("windspeed_north")),
        east(r.column("windspeed_east")),
        var_north(r.column_of({"variance_north", "covariance_north"})),
        var_east(r.column_of({"variance_east", "covariance_east"})) {}
  /// Zeros with zero variance are what the estimator publishes while it does not estimate the wind.
  bool estimated(Bytes row) const {
    const double n = real(row, north), e = real(row, east);
    return std::isfinite(n) && std::isfinite(e) && (n != 0 || e != 0 || real(row, var_north) + real(row, var_east) > 0);
  }
  std::optional<Column> north, east, var_north, var_east;
};

bool any_estimate(const Log& log, const Topic& topic) {
  const TopicReader reader(log, topic);
  const WindColumns c(reader);
  for (std::size_t i = 0; i < reader.size(); ++i)
    if (c.estimated(reader.row(i))) return true;
  return false;
}

}  // namespace

/// wind (1.12 on), wind_estimate (1.6 to 1.11), estimator_wind (per instance), airspeed_wind: m/s, toward.
/// Multirotors have it only with drag fusion or an airspeed sensor.
void map_wind(Mapping& m) {
  const Topic* topic = nullptr;
  for (const auto* name : {"wind", "wind_estimate", "estimator_wind", "airspeed_wind"})
    for (const auto& candidate : m.log.topics)
      if (!topic && candidate.name == name && any_estimate(m.log, candidate)) topic = &candidate;
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const WindColumns c(reader);
  auto& stream = m.flight.autopilot_wind;
  reader.name_source(stream);
  reader.for_each([&](LogTime t, Bytes row) {
    if (!c.estimated(row)) return;
    AutopilotWind wind;
    wind.v_NA_N = {real(row, c.north), real(row, c.east)};
    const double variance = (real(row, c.var_north) + real(row, c.var_east)) / 2;
    if (variance > 0 && std::isfinite(variance)) wind.sd = std::sqrt(variance);
    stream.push(t, wind);
  });
  m.details.emplace_back("autopilot wind", stream.source);
}

}  // namespace quadsonde::ingest::ulog
