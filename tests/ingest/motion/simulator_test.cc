#include "ingest/motion/simulator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ingest/flight/local_frame.h"
#include "ingest/flight/rotation.h"
#include "ingest/flight/segments.h"
#include "ingest/motion/random.h"
#include "tests/ingest/motion/made_scenarios.h"

namespace quadsonde::ingest {
namespace {

bool same(const Simulation& a, const Simulation& b) {
  if (a.flight.attitude.size() != b.flight.attitude.size() || a.truth.size() != b.truth.size()) return false;
  for (std::size_t i = 0; i < a.flight.attitude.size(); ++i)
    if (a.flight.attitude.value[i].coeffs() != b.flight.attitude.value[i].coeffs()) return false;
  for (std::size_t i = 0; i < a.truth.size(); ++i)
    if (a.truth[i].v_NA_N != b.truth[i].v_NA_N || a.flight.velocity.value[i] != b.flight.velocity.value[i] ||
        a.flight.position.value[i].lat_deg != b.flight.position.value[i].lat_deg ||
        a.flight.height_msl.value[i] != b.flight.height_msl.value[i])
      return false;
  return true;
}

TEST(Simulator, SameScenarioSameNumbers) {
  Scenario s = quiet_hover(20);
  s.wind.sigma_u = 0.5;
  s.sensors = SensorModel{};
  EXPECT_TRUE(same(fly(s), fly(s)));
  Scenario other = s;
  other.seed = 2;
  EXPECT_FALSE(same(fly(s), fly(other)));
}

TEST(Simulator, ASteadyHoverBalancesThrustSlopeAndDrag) {
  Scenario s = quiet_hover();
  s.wind.toward = toward(6, 75);
  s.vehicle.drag = {0.2, 0.02, 0.03, 0};
  const auto flown = fly(s);
  const Eigen::Vector3d n = flown.flight.attitude.value.back() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d slope = thrust_slope<double>(n);
  const Eigen::Vector2d expected = -(0.2 + 0.02 * 6) * s.wind.toward;  // g s = c a, a = -w
  EXPECT_LT((standard_gravity * slope - expected).norm(), 1e-6);
  EXPECT_LT(flown.flight.velocity.value.back().norm(), 1e-6) << "it stands still";
}

TEST(Simulator, TheMotionObeysEquationOne) {
  // Velocity differences against the law, from the log alone: 100 Hz, no noise, in a climb through shear.
  Scenario s = quiet_hover();
  s.wind.model = WindField::Model::jet;
  s.sensors.output_rate = 100;
  s.vehicle.drag = {0.2, 0.02, 0.03, 0.001};
  PathLeg up;
  up.kind = PathLeg::Kind::climb;
  up.speed = 3;
  up.to_height = 120;
  s.path = {up};
  const auto flown = fly(s);
  const auto& v = flown.flight.velocity.value;
  double worst = 0;
  for (std::size_t i = 0; i + 1 < v.size(); ++i) {
    const Eigen::Vector3d vdot = (v[i + 1] - v[i]) / 0.01;
    // The command of this tick moves the thrust before the drag is formed: the attitude of the next sample.
    const Eigen::Vector3d n = flown.flight.attitude.value[i + 1] * Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d told = horizontal_acceleration<double>(
        s.vehicle.drag, thrust_slope<double>(n), standard_gravity - vdot.z(), v[i] - flown.truth[i].v_NA_N, {0, 0});
    worst = std::max(worst, (told - vdot.head<2>()).norm());
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(Simulator, TrimsAppearInTheLogAsTheScenarioSays) {
  Scenario s = quiet_hover(20);
  s.sensors.trim_roll_deg = 2;
  s.sensors.trim_pitch_deg = -6;
  s.path[0].heading = {HeadingRule::Kind::turning, 0, 30};
  for (const auto& q : fly(s).flight.attitude.value) {
    const auto seen = euler_from_q_NB(q);
    EXPECT_NEAR(seen.roll / degree, 2, 1e-9) << "a calm hover is level, and the log shows the trim";
    EXPECT_NEAR(seen.pitch / degree, -6, 1e-9);
  }
}

TEST(Simulator, LatencyDelaysTheVelocityAndNothingElse) {
  Scenario s = quiet_hover();
  s.path[0].kind = PathLeg::Kind::square;
  s.path[0].speed = 3;
  Scenario late = s;
  late.sensors.latency = 0.2;
  const auto a = fly(s), b = fly(late);
  ASSERT_EQ(a.flight.velocity.size(), b.flight.velocity.size());
  for (std::size_t i = 2; i < a.flight.velocity.size(); ++i)
    ASSERT_EQ(b.flight.velocity.value[i], a.flight.velocity.value[i - 2]) << "0.2 s at 10 Hz: two samples";
  for (std::size_t i = 0; i < a.flight.attitude.size(); ++i)
    ASSERT_EQ(a.flight.attitude.value[i].coeffs(), b.flight.attitude.value[i].coeffs());
}

TEST(Simulator, TakesOffFromTheGroundAndLands) {
  Scenario s = quiet_hover(30);
  s.from_ground = true;
  s.start_height = 12;
  const auto flown = fly(s);
  const auto& heights = flown.flight.height_msl.value;
  EXPECT_NEAR(heights.front().m, s.site.height.m, 0.05);
  EXPECT_NEAR(heights.back().m, s.site.height.m, 0.1);
  const auto segments = airborne_segments(flown.flight);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_FALSE(segments[0].starts_in_air || segments[0].ends_in_air);
  ASSERT_TRUE(takeoff_height(flown.flight, segments[0]));
  EXPECT_NEAR(takeoff_height(flown.flight, segments[0])->m, s.site.height.m, 1);
  double highest = 0;
  for (const auto& row : flown.truth) highest = std::max(highest, row.height.m);
  EXPECT_NEAR(highest, 12, 0.5);
}

TEST(Simulator, StaysLevelAndInPlaceWhileItStandsOnTheGround) {
  for (const auto model : {Scenario::Model::point_mass, Scenario::Model::rigid_body}) {
    Scenario s = quiet_hover(5);
    s.model = model;
    s.from_ground = true;
    s.start_height = 3;
    s.wind.toward = toward(8, 60);
    s.sensors.landed_state = true;
    const auto flown = fly(s);
    const auto& landed = flown.flight.landed;
    ASSERT_EQ(landed.size(), 3u) << "on the ground, in the air, on the ground";
    ASSERT_TRUE(landed.value[0] && !landed.value[1] && landed.value[2]);
    int standing = 0;
    for (std::size_t i = 0; i < flown.flight.velocity.size(); ++i) {
      const LogTime t = flown.flight.velocity.time[i];
      if (t >= landed.time[1] && t <= landed.time[2]) continue;
      ++standing;
      const auto seen = euler_from_q_NB(flown.flight.attitude.value[i]);
      EXPECT_EQ(std::abs(seen.roll) + std::abs(seen.pitch), 0);
      EXPECT_EQ(flown.flight.velocity.value[i].norm(), 0);
    }
    EXPECT_GT(standing, 50) << "3 s before and 3 s after";
    EXPECT_NEAR(flown.truth.back().height.m, 0, 0.021);
  }
}

TEST(Simulator, GoesWhereItsPathSays) {
  Scenario s = quiet_hover(10);
  s.path[0].kind = PathLeg::Kind::line;
  s.path[0].speed = 4;
  s.path[0].course_deg = 90;
  const auto flown = fly(s);
  const LocalFrame frame(s.site.point, s.site.height.m);
  const Eigen::Vector3d end = frame.to_ned(flown.flight.position.value.back(), s.site.height.m + 10);
  EXPECT_NEAR(end.y(), 40, 1.5);
  EXPECT_NEAR(end.x(), 0, 0.1);
  EXPECT_NEAR(flown.flight.velocity.value.back().y(), 4, 0.1);
}

TEST(Simulator, TurnsAsToldAndPausesInItsClimb) {
  Scenario s = quiet_hover(18);
  s.path[0].heading = {HeadingRule::Kind::turning, 10, 20};
  const auto turned = fly(s);
  EXPECT_NEAR(heading(turned.flight.attitude.value.front()) / degree, 10, 0.3);
  EXPECT_NEAR(heading(turned.flight.attitude.value[90]) / degree, wrap_angle((10 + 180) * degree) / degree, 0.3);
  PathLeg up;
  up.kind = PathLeg::Kind::climb;
  up.speed = 2;
  up.to_height = 50;
  up.pause_every = 10;
  up.pause = 5;
  s.path = {up};
  // 40 m at 2 m/s are 20 s, with three pauses of 5 s inside.
  EXPECT_NEAR(static_cast<double>(fly(s).truth.size()) / 10, 35, 0.5);
}

TEST(Simulator, RunsTheAttitudeAtItsOwnRate) {
  Scenario s = quiet_hover(10);
  s.sensors.output_rate = 5;
  s.sensors.attitude_rate = 50;
  const auto flown = fly(s);
  EXPECT_EQ(flown.flight.velocity.size(), 50u);
  EXPECT_EQ(flown.flight.attitude.size(), 500u);
  EXPECT_EQ(flown.truth.size(), 50u);
}

TEST(Simulator, NoiseIsAsLargeAsTheScenarioSays) {
  Scenario s = quiet_hover(600);
  s.sensors.velocity_sd = 0.2;
  s.sensors.tilt_sd_deg = 0.5;
  s.wind.sigma_u = 0.5;
  s.wind.time_u = 1;
  Scenario still = s;
  still.sensors.velocity_sd = still.sensors.tilt_sd_deg = 0;
  const auto noisy = fly(s), clean = fly(still);
  double v2 = 0, tilt2 = 0, wind2 = 0;
  for (std::size_t i = 0; i < noisy.truth.size(); ++i) {
    v2 += (noisy.flight.velocity.value[i] - clean.flight.velocity.value[i]).squaredNorm() / 3;
    const auto a = euler_from_q_NB(noisy.flight.attitude.value[i]), b = euler_from_q_NB(clean.flight.attitude.value[i]);
    tilt2 += (std::pow(a.roll - b.roll, 2) + std::pow(a.pitch - b.pitch, 2)) / (2 * degree * degree);
    wind2 += clean.truth[i].v_NA_N.head<2>().squaredNorm() / 2;
  }
  const double n = static_cast<double>(noisy.truth.size());
  // 6000 samples: the sd of an sd is 1 %; the turbulence has 600 independent seconds per axis, 3 %.
  EXPECT_NEAR(std::sqrt(v2 / n), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(tilt2 / n), 0.5, 0.025);
  EXPECT_NEAR(std::sqrt(wind2 / n), 0.5, 0.05);
}

TEST(Simulator, RefusesToFlyNothingOrForDays) {
  Scenario s = quiet_hover();
  s.path.clear();
  const auto none = simulate(s);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, Kind::usage);
}

TEST(Gaussian, IsStandardNormalAndTheSameEverywhere) {
  Gaussian noise(1);
  double sum = 0, sum2 = 0, beyond = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double z = noise();
    sum += z, sum2 += z * z, beyond += std::abs(z) > 1.959964;
  }
  EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(sum2 / n, 1, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(beyond / n, 0.05, 4 * std::sqrt(0.05 * 0.95 / n));
  // mt19937_64's first output for seed 1 is fixed by the C++ standard's definition of the engine.
  EXPECT_NEAR(Gaussian(1).uniform(), 0.13387664401253274, 1e-16);
}

}  // namespace
}  // namespace quadsonde::ingest
