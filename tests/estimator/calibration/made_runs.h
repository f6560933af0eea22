#pragma once
// Wind generator runs flown by the simulator.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "estimator/calibration/tunnel.h"
#include "ingest/motion/simulator.h"

namespace quadsonde::support {

struct MadeRun {
  double stated = 4;                 ///< [m/s]
  std::optional<double> flown;       ///< what really blew; as stated if empty
  double from_deg = 200;             ///< what really was
  std::optional<double> stated_from_deg;
  double turn_deg = 360, duration = 60;
  double tilt_sd_deg = 0.5;
  double gusts = 0;                  ///< turbulence sd [m/s]
  double speed = 0;                  ///< flies along a line instead of standing still [m/s]
  std::optional<double> density = 1.19;
  ingest::DragLaw<double> drag{0.2570, 0.004, 0, 0};
  std::uint64_t seed = 1;
};

inline estimator::TunnelRun fly(const MadeRun& made) {
  constexpr double degree = 3.14159265358979323846 / 180;
  ingest::Scenario scenario;
  scenario.vehicle = ingest::published_vehicle();
  scenario.vehicle.drag = made.drag;
  const double speed = made.flown.value_or(made.stated);
  scenario.wind.toward = -speed * Eigen::Vector2d(std::cos(made.from_deg * degree), std::sin(made.from_deg * degree));
  scenario.wind.sigma_u = scenario.wind.sigma_w = made.gusts;
  scenario.start_height = 2;
  scenario.sensors.tilt_sd_deg = made.tilt_sd_deg;
  scenario.seed = made.seed;
  ingest::PathLeg leg;
  leg.duration = made.duration;
  leg.heading = {ingest::HeadingRule::Kind::turning, 0, made.turn_deg / made.duration};
  if (made.speed > 0) leg.kind = ingest::PathLeg::Kind::line, leg.speed = made.speed;
  scenario.path = {leg};
  auto flown = ingest::simulate(scenario);
  EXPECT_TRUE(flown) << ingest::to_string(flown.error());
  estimator::TunnelRun run;
  run.name = "run_" + std::to_string(static_cast<int>(made.stated)) + ".mcap";
  run.flight = std::move(flown->flight);
  run.wind_speed = made.stated;
  run.wind_from_deg = made.stated_from_deg.value_or(made.from_deg);
  run.air_density = made.density;
  return run;
}

/// One run per speed, all made alike, with seeds of their own.
inline std::vector<estimator::TunnelRun> fly_each(const std::vector<double>& speeds, MadeRun made = {}) {
  std::vector<estimator::TunnelRun> runs;
  for (const double speed : speeds) {
    made.stated = speed;
    ++made.seed;
    runs.push_back(fly(made));
  }
  return runs;
}

inline estimator::TunnelSettings published_settings() {
  estimator::TunnelSettings settings;
  settings.mass = 0.896;
  return settings;
}

}  // namespace quadsonde::support
