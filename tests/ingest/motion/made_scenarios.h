#pragma once
// Scenarios without noise and turbulence: what is left is the motion itself.
#include <gtest/gtest.h>

#include <numbers>

#include "ingest/motion/simulator.h"

namespace quadsonde::ingest {

inline constexpr double degree = std::numbers::pi / 180;

inline Eigen::Vector2d toward(double speed, double deg) {
  return {speed * std::cos(deg * degree), speed * std::sin(deg * degree)};
}

inline Scenario quiet_hover(double duration = 60) {
  Scenario s;
  s.vehicle = published_vehicle();
  s.wind.sigma_u = s.wind.sigma_w = 0;
  s.sensors.tilt_sd_deg = s.sensors.velocity_sd = s.sensors.height_sd = s.sensors.position_sd = 0;
  s.sensors.trim_roll_deg = s.sensors.trim_pitch_deg = 0;
  PathLeg hover;
  hover.duration = duration;
  s.path = {hover};
  return s;
}

inline Scenario quiet_rigid_hover(double duration = 60) {
  Scenario s = quiet_hover(duration);
  s.model = Scenario::Model::rigid_body;
  return s;
}

inline Simulation fly(const Scenario& s) {
  auto flown = simulate(s);
  EXPECT_TRUE(flown) << to_string(flown.error());
  return *flown;
}

}  // namespace quadsonde::ingest
