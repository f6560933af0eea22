#pragma once
// A short flight that the simulator makes: from the ground up, down and back onto it, turning.
#include <stdexcept>
#include <string>

#include "export/csv/flight_csv.h"
#include "export/csv/truth_csv.h"
#include "ingest/motion/scenario.h"
#include "tests/support/data.h"

namespace quadsonde::support {

inline const char* ascent_toml() {
  return R"(
name = "ascent"
from_ground = true
start_height_m = 2
seed = 3
[site]
lat_deg = 43.5657
lon_deg = 1.4815
height_msl_m = 150
start_utc = "2025-06-15T06:00:00Z"
[wind]
model = "constant"
speed_m_s = 5
from_deg = 250
turbulence_sd_m_s = 0.3
[[path]]
kind = "climb"
speed_m_s = 1
to_height_m = 42
yaw_rate_deg_s = 20
[[path]]
kind = "climb"
speed_m_s = 1
to_height_m = 2
yaw_rate_deg_s = 20
)";
}

inline ingest::Simulation flown(const std::string& toml = ascent_toml()) {
  const auto scenario = ingest::parse_scenario(toml, "scenario.toml");
  if (!scenario) throw std::runtime_error(ingest::to_string(scenario.error()));
  auto simulation = ingest::simulate(*scenario);
  if (!simulation) throw std::runtime_error(ingest::to_string(simulation.error()));
  return std::move(*simulation);
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  write_bytes(path, {text.begin(), text.end()});
}
inline std::string read_text(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

}  // namespace quadsonde::support
