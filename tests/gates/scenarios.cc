#include "tests/gates/scenarios.h"

#include <cmath>
#include <numbers>

namespace quadsonde::gates {
namespace {

using ingest::HeadingRule;
using ingest::PathLeg;
using ingest::Scenario;

Eigen::Vector2d toward(double speed, double deg) {
  return speed * Eigen::Vector2d(std::cos(deg * std::numbers::pi / 180), std::sin(deg * std::numbers::pi / 180));
}

HeadingRule turning(double rate) { return {HeadingRule::Kind::turning, 0, rate}; }

/// Known to the filter: no spread between flights, no climb law, white tilt noise.
Scenario reference_flight() {
  Scenario s;
  s.vehicle = ingest::published_vehicle();
  s.vehicle.mass_kg = 0.896;
  s.vehicle.drag.linear = 0.230292 / 0.896;
  s.vehicle.air_density_kg_m3 = 1.19;
  return s;
}

}  // namespace

Scenario s1_step(double sigma_u) {
  Scenario s = reference_flight();
  s.wind.steps = {{100, toward(3.8, 180)}};
  s.wind.sigma_u = sigma_u;
  s.start_height = 3;
  PathLeg hover;
  hover.duration = 160;
  hover.heading = turning(20);
  s.path = {hover};
  return s;
}

Scenario s2_hover() {
  Scenario s = reference_flight();
  s.wind.toward = toward(4, 60);
  PathLeg hover;
  hover.duration = 180;
  hover.heading = turning(20);
  s.path = {hover};
  return s;
}

Scenario s3_ascent(double climb_rate) {
  Scenario s = reference_flight();
  s.wind.model = ingest::WindField::Model::jet;
  PathLeg up;
  up.kind = PathLeg::Kind::climb;
  up.speed = climb_rate;
  up.to_height = climb_rate > 2 ? 610 : 240;
  up.heading = turning(20);
  PathLeg down = up;
  down.to_height = 10;
  s.path = {up, down};
  return s;
}

Scenario s4_square(double latency) {
  Scenario s = reference_flight();
  s.wind.toward = toward(3, 110);
  s.start_height = 20;
  s.sensors.latency = latency;
  PathLeg square;
  square.kind = PathLeg::Kind::square;
  square.speed = 3;
  square.duration = 300;
  square.heading = turning(17);
  s.path = {square};
  return s;
}

Scenario fixed_heading() {
  Scenario s = s2_hover();
  s.path[0].heading = {};
  return s;
}

Scenario fast_hover() {
  Scenario s = s2_hover();
  s.wind.toward = toward(10, 60);
  s.vehicle.drag.linear = 0.20;
  s.vehicle.drag.quadratic = 0.02;
  return s;
}

Scenario trimmed_hover() {
  Scenario s = s2_hover();
  s.sensors.trim_roll_deg = 2;
  s.sensors.trim_pitch_deg = -6;
  return s;
}

Scenario considered_hover() {
  Scenario s = s2_hover();
  s.wind.toward = toward(6, 40);
  s.path[0].duration = 80;
  return s;
}

Scenario considered_square() {
  Scenario s = s4_square(0);
  s.wind.toward = toward(6, 40);
  s.path[0].duration = 80;
  s.path[0].heading = turning(20);
  return s;
}

Scenario s5_ascent(double climb_rate, bool pauses) {
  Scenario s = s3_ascent(climb_rate);
  for (auto& leg : s.path)
    if (pauses) leg.pause_every = 30, leg.pause = 20;
  return s;
}

Scenario rigid(Scenario s) {
  s.model = Scenario::Model::rigid_body;
  return s;
}

}  // namespace quadsonde::gates
