// The rigid body under its controller, through simulate().
#include <gtest/gtest.h>

#include <cmath>

#include "ingest/flight/rotation.h"
#include "tests/ingest/motion/made_scenarios.h"

namespace quadsonde::ingest {
namespace {

LocalFrame frame_of(const Scenario& s) { return {s.site.point, s.site.height.m}; }

TEST(RigidFlight, ASteadyWindLeansItByItsEffectiveDrag) {
  for (const double deg : {0.0, 75.0}) {
    Scenario s = quiet_rigid_hover(40);
    s.wind.toward = toward(6, deg);
    const auto flown = fly(s);
    const Eigen::Vector3d n = flown.flight.attitude.value.back() * Eigen::Vector3d::UnitZ();
    const double rho = standard_air_density(s.site.height.m + 10);
    const double c = *effective_drag(s.rigid, 6, 0, rho, (deg + 180) * degree);
    // g s = c a, exact for a force in the rotor plane. Across the wind the body's two areas differ by 0.002 m2: some
    // 0.5 1.2 0.002 36 sin 75 cos 75 / 0.896 = 0.012 m/s2.
    const Eigen::Vector2d pull = standard_gravity * thrust_slope<double>(n), along = s.wind.toward / 6;
    EXPECT_NEAR(-pull.dot(along), 6 * c, 0.003 * 6 * c) << deg;
    EXPECT_LT(std::abs(pull.x() * along.y() - pull.y() * along.x()), 0.015) << deg;
    EXPECT_LT(flown.flight.velocity.value.back().norm(), 1e-3) << "it stands still";
  }
}

TEST(RigidFlight, HoldsItsPlaceInTenMetresPerSecondWithGusts) {
  Scenario s = quiet_rigid_hover(120);
  s.wind.toward = toward(10, 60);
  s.wind.sigma_u = 1, s.wind.sigma_w = 0.5;
  s.sensors = SensorModel{};  // noisy: it flies on these
  s.sensors.latency = 0.1;
  s.path[0].heading = {HeadingRule::Kind::turning, 0, 20};
  const auto flown = fly(s);
  const auto frame = frame_of(s);
  double worst = 0, sum = 0;
  for (std::size_t i = 0; i < flown.truth.size(); ++i) {
    const double off = frame.to_ned(flown.flight.position.value[i], s.site.height.m).head<2>().norm();
    worst = std::max(worst, off), sum += off * off;
    EXPECT_NEAR(flown.truth[i].height.m, 10, 1.5);
  }
  // The logged position itself has sd 0.5 m per axis: rms 0.7 m, worst of 1200 about 1.9 m.
  EXPECT_LT(std::sqrt(sum / static_cast<double>(flown.truth.size())), 1.3);
  EXPECT_LT(worst, 4);
}

TEST(RigidFlight, TurnsItsNoseIndependentlyOfItsTrack) {
  Scenario s = quiet_rigid_hover(60);
  s.path[0].kind = PathLeg::Kind::square;
  s.path[0].speed = 3;
  s.path[0].heading = {HeadingRule::Kind::turning, 30, 17};
  s.wind.toward = toward(3, 110);
  const auto flown = fly(s);
  double worst = 0, sum = 0;
  for (std::size_t i = 0; i < flown.flight.attitude.size(); ++i) {
    const double wanted = (30 + 17 * 0.1 * static_cast<double>(i)) * degree;
    const double off = wrap_angle(heading(flown.flight.attitude.value[i]) - wanted) / degree;
    worst = std::max(worst, std::abs(off)), sum += off * off;
  }
  EXPECT_LT(worst, 12) << "corners at 35 degrees of tilt included";
  EXPECT_LT(std::sqrt(sum / static_cast<double>(flown.flight.attitude.size())), 3);
  EXPECT_NEAR(flown.flight.velocity.value[90].x(), 3, 0.2) << "first side north";
  EXPECT_NEAR(flown.flight.velocity.value[190].y(), 3, 0.2) << "second side east";
}

TEST(RigidFlight, HoldsItsNoseAlongTheTrack) {
  Scenario s = quiet_rigid_hover(60);
  s.path[0].kind = PathLeg::Kind::circle;
  s.path[0].speed = 3;
  s.path[0].radius = 15;
  s.path[0].heading.kind = HeadingRule::Kind::along_track;
  s.wind.toward = toward(3, 110);
  const auto flown = fly(s);
  for (std::size_t i = 100; i < flown.truth.size(); ++i) {
    const Eigen::Vector3d v = flown.flight.velocity.value[i];
    EXPECT_LT(std::abs(wrap_angle(heading(flown.flight.attitude.value[i]) - std::atan2(v.y(), v.x()))), 15 * degree);
  }
}

TEST(RigidFlight, SameScenarioSameNumbers) {
  Scenario s = quiet_rigid_hover(10);
  s.sensors = SensorModel{};
  s.wind.sigma_u = 0.5;
  s.sensors.rotor_rate = 10;
  const auto a = fly(s), b = fly(s);
  s.seed = 2;
  const auto other = fly(s);
  for (std::size_t i = 0; i < a.truth.size(); ++i) {
    ASSERT_EQ(a.flight.velocity.value[i], b.flight.velocity.value[i]);
    ASSERT_EQ(a.flight.rotors.value[i], b.flight.rotors.value[i]);
    ASSERT_EQ(a.flight.attitude.value[i].coeffs(), b.flight.attitude.value[i].coeffs());
  }
  EXPECT_NE(a.flight.velocity.value.back(), other.flight.velocity.value.back());
}

TEST(RigidFlight, FliesOnWhatItMeasures) {
  // A compass 20 degrees off turns the vehicle, and a velocity that is 0.5 m/s off moves it until the position says
  // stop.
  Scenario s = quiet_rigid_hover(60);
  s.sensors.heading_error_deg = 20;
  s.sensors.velocity_bias = {0.5, 0, 0};
  const auto flown = fly(s);
  EXPECT_NEAR(heading(flown.flight.attitude.value.back()) / degree, 0, 0.5) << "it holds the heading that it sees";
  const double north = frame_of(s).to_ned(flown.flight.position.value.back(), s.site.height.m).x();
  EXPECT_GT(std::abs(north), 0.2) << "and stands where velocity and position agree";
  EXPECT_LT(std::abs(north), 2);
}

TEST(RigidFlight, RotorSpeedsAreThoseOfHoverAndRiseInTheClimb) {
  Scenario s = quiet_rigid_hover(10);
  s.sensors.rotor_rate = 10;
  PathLeg up;
  up.kind = PathLeg::Kind::climb;
  up.speed = 4;
  up.to_height = 60;
  s.path.push_back(up);
  const auto flown = fly(s);
  const auto mean = [](const RotorSpeeds& speeds) {
    double sum = 0;
    for (const float rpm : speeds) sum += rpm;
    return sum / static_cast<double>(speeds.size());
  };
  const auto hover = trim(s.rigid, Eigen::Vector3d::Zero(), 0, standard_air_density(160));
  ASSERT_EQ(flown.flight.rotors.value.front().size(), 4u);
  EXPECT_NEAR(mean(flown.flight.rotors.value[50]), hover->state.speed(0) * 30 / std::numbers::pi, 5);
  EXPECT_GT(mean(flown.flight.rotors.value[190]), 1.05 * mean(flown.flight.rotors.value[50]));
}

TEST(RigidFlight, AccelerometerReadsTheDragInTheRotorPlane) {
  Scenario s = quiet_rigid_hover(40);
  s.wind.toward = toward(5, 0);
  s.sensors.accelerometer_rate = 10;
  const auto flown = fly(s);
  const Eigen::Vector3d f = flown.flight.accelerometer.value.back();
  const Eigen::Vector3d a_B = flown.flight.attitude.value.back().inverse() * Eigen::Vector3d(-5, 0, 0);
  const double c = *effective_drag(s.rigid, 5, 0, standard_air_density(160), std::numbers::pi);
  EXPECT_NEAR(f.x(), -c * a_B.x(), 0.01);
  EXPECT_NEAR(f.norm(), standard_gravity, 0.01) << "it stands still: the whole is gravity's opposite";
}

TEST(RigidFlight, TellsTheDragLawThatItFlew) {
  Scenario s = quiet_rigid_hover(5);
  s.sensors.latency = 0.1;
  s.sensors.tilt_sd_deg = 0.4, s.sensors.tilt_wander_deg = 0.3, s.sensors.tilt_wander_time = 2;
  const auto flown = fly(s);
  const double rho = standard_air_density(s.site.height.m);
  EXPECT_EQ(flown.vehicle.latency_s, 0.1);
  EXPECT_NEAR(flown.vehicle.tilt_sd_deg, 0.5, 1e-12);
  EXPECT_NEAR(2 * 0.25 * flown.vehicle.tilt_correlation_s, 0.16 * 0.1 + 2 * 0.09 * 2, 1e-12) << "white and wander";
  const double sd = flown.vehicle.parameter_sd(p_linear) / flown.vehicle.drag.linear;
  EXPECT_GT(sd, 0.005) << "no law of two terms is the whole truth";
  EXPECT_LT(sd, 0.05);
  EXPECT_EQ(flown.vehicle.air_density_kg_m3, rho);
  EXPECT_NEAR(drag_coefficient(flown.vehicle.drag, 4.0, 0.0), *effective_drag(s.rigid, 4, 0, rho, std::numbers::pi / 4),
              0.01);
}

TEST(RigidFlight, OfABodyThatCannotHoverIsRefused) {
  Scenario s = quiet_rigid_hover(5);
  s.rigid.mass = 8;
  const auto flown = simulate(s);
  ASSERT_FALSE(flown);
  EXPECT_EQ(flown.error().kind, Kind::usage);
  EXPECT_NE(flown.error().what.find("cannot hover"), std::string::npos);
}

}  // namespace
}  // namespace quadsonde::ingest
