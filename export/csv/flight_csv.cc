#include "export/csv/flight_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "export/csv/numbers.h"

namespace quadsonde::product {
namespace {

using ingest::Flight;
using ingest::LogTime;

/// Columns of one stream: their names, and the cells of its i-th sample.
struct Group {
  std::vector<std::string> names;
  const std::vector<LogTime>* time;
  std::function<std::vector<std::string>(std::size_t)> cells;
};

std::string exact(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }
std::string exact(const std::optional<double>& value) { return value ? exact(*value) : ""; }

std::string exact_seconds(LogTime t) {
  const bool negative = t.ns < 0;
  const auto magnitude = negative ? 0 - static_cast<std::uint64_t>(t.ns) : static_cast<std::uint64_t>(t.ns);
  return fmt::format("{}{}.{:09}", negative ? "-" : "", magnitude / 1'000'000'000, magnitude % 1'000'000'000);
}

template <class Height>
Group height_group(const char* name, const ingest::Stream<Height>& stream) {
  return {{name}, &stream.time, [&stream](std::size_t i) { return std::vector{exact(stream.value[i].m)}; }};
}

Group vector_group(std::vector<std::string> names, const ingest::Stream<Eigen::Vector3d>& stream) {
  return {std::move(names), &stream.time, [&stream](std::size_t i) {
            const auto& v = stream.value[i];
            return std::vector{exact(v.x()), exact(v.y()), exact(v.z())};
          }};
}

void add_motion(std::vector<Group>& groups, const Flight& f) {
  groups.push_back({{"qw", "qx", "qy", "qz"}, &f.attitude.time, [&f](std::size_t i) {
                      const auto& q = f.attitude.value[i];
                      return std::vector{exact(q.w()), exact(q.x()), exact(q.y()), exact(q.z())};
                    }});
  groups.push_back(vector_group({"vn_m_s", "ve_m_s", "vd_m_s"}, f.velocity));
  if (f.velocity.sd.size() == f.velocity.size())
    groups.push_back(
        {{"sd_velocity_m_s"}, &f.velocity.time, [&f](std::size_t i) { return std::vector{exact(f.velocity.sd[i])}; }});
  groups.push_back({{"lat_deg", "lon_deg"}, &f.position.time, [&f](std::size_t i) {
                      return std::vector{exact(f.position.value[i].lat_deg), exact(f.position.value[i].lon_deg)};
                    }});
  groups.push_back(height_group("height_msl_m", f.height_msl));
  groups.push_back(height_group("height_ellipsoid_m", f.height_ellipsoid));
  groups.push_back(height_group("height_agl_m", f.height_ground));
}

void add_sensors(std::vector<Group>& groups, const Flight& f) {
  groups.push_back(
      {{"baro_alt_m", "pressure_pa"}, &f.barometer.time, [&f](std::size_t i) {
         return std::vector{exact(f.barometer.value[i].altitude_m), exact(f.barometer.value[i].pressure_pa)};
       }});
  groups.push_back(
      {{"temperature_k", "relative_humidity_pct"}, &f.air.time, [&f](std::size_t i) {
         return std::vector{exact(f.air.value[i].temperature_k), exact(f.air.value[i].relative_humidity_pct)};
       }});
  groups.push_back(vector_group({"ax_m_s2", "ay_m_s2", "az_m_s2"}, f.accelerometer));
  std::size_t rotors = 0;
  for (const auto& speeds : f.rotors.value) rotors = std::max(rotors, speeds.size());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min<std::size_t>(rotors, 64); ++i)
    names.push_back(fmt::format("rotor_{}_rpm", i + 1));
  groups.push_back({names, &f.rotors.time, [&f, rotors = names.size()](std::size_t i) {
                      std::vector<std::string> cells(rotors);
                      const auto& speeds = f.rotors.value[i];
                      for (std::size_t r = 0; r < std::min(rotors, speeds.size()); ++r)
                        if (std::isfinite(speeds[r])) cells[r] = fmt::format("{}", speeds[r]);
                      return cells;
                    }});
}

}  // namespace

std::string flight_csv(const Flight& flight) {
  std::vector<Group> groups;
  add_motion(groups, flight);
  add_sensors(groups, flight);
  std::erase_if(groups, [](const Group& g) { return g.time->empty() || g.names.empty(); });
  std::vector<LogTime> times;
  for (const auto& g : groups) times.insert(times.end(), g.time->begin(), g.time->end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());

  std::string text = "time_s,utc";
  for (const auto& g : groups)
    for (const auto& name : g.names) text += "," + name;
  text += '\n';
  std::vector<std::size_t> at(groups.size(), 0);
  for (const auto t : times) {
    const auto utc = flight.clock.to_utc(t);
    text += exact_seconds(t) + "," + (utc ? ingest::to_iso8601(*utc, 9) : "");
    for (std::size_t k = 0; k < groups.size(); ++k) {
      const auto& g = groups[k];
      std::vector<std::string> cells(g.names.size());
      // Of several samples at one instant the last one stands.
      while (at[k] < g.time->size() && (*g.time)[at[k]] == t) cells = g.cells(at[k]++);
      for (const auto& cell : cells) text += "," + cell;
    }
    text += '\n';
  }
  return text;
}

}  // namespace quadsonde::product
