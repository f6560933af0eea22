#include "ingest/motion/sensors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ingest/flight/rotation.h"
#include "tests/ingest/motion/made_scenarios.h"

namespace quadsonde::ingest {
namespace {

double sd(const std::vector<double>& x) {
  double sum = 0, sum2 = 0;
  for (const double v : x) sum += v, sum2 += v * v;
  const double n = static_cast<double>(x.size());
  return std::sqrt(sum2 / n - sum * sum / (n * n));
}

double lagged(const std::vector<double>& x, std::size_t lag) {
  double sum = 0, sum2 = 0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) sum += x[i] * x[i + lag], sum2 += x[i] * x[i];
  return sum / sum2;
}

TEST(Sensors, StreamsRunAtTheirOwnRates) {
  Scenario s = quiet_rigid_hover(10);
  s.sensors.attitude_rate = 50, s.sensors.velocity_rate = 5, s.sensors.position_rate = 1;
  s.sensors.barometer_rate = 20, s.sensors.accelerometer_rate = 100, s.sensors.rotor_rate = 10;
  const auto f = fly(s).flight;
  EXPECT_EQ(f.attitude.size(), 500u);
  EXPECT_EQ(f.velocity.size(), 50u);
  EXPECT_EQ(f.position.size(), 10u);
  EXPECT_EQ(f.height_msl.size(), 10u);
  EXPECT_EQ(f.barometer.size(), 200u);
  EXPECT_EQ(f.accelerometer.size(), 1000u);
  EXPECT_EQ(f.rotors.size(), 100u);
}

TEST(Sensors, WhatIsAskedForMoreLeavesTheRestAsItWas) {
  Scenario s = quiet_hover(20);
  s.sensors = SensorModel{};
  s.wind.sigma_u = 0.5;
  Scenario more = s;
  more.sensors.barometer_rate = more.sensors.accelerometer_rate = 10;
  more.sensors.barometer_walk = 1, more.sensors.accelerometer_sd = 0.1, more.sensors.landed_state = true;
  more.sensors.log = {600, 0.5};
  const auto a = fly(s), b = fly(more);
  ASSERT_FALSE(b.flight.gaps.empty());
  std::size_t k = 0;
  for (std::size_t i = 0; i < b.flight.velocity.size(); ++i) {
    while (a.flight.velocity.time[k] < b.flight.velocity.time[i]) ++k;
    ASSERT_EQ(a.flight.velocity.value[k], b.flight.velocity.value[i]);
  }
  EXPECT_LT(b.flight.velocity.size(), a.flight.velocity.size());
}

TEST(Sensors, TiltAndHeadingWanderWithTheirSdAndTime) {
  Scenario s = quiet_hover(4000);
  s.sensors.output_rate = 2;
  s.sensors.tilt_wander_deg = 0.7, s.sensors.tilt_wander_time = 4;
  s.sensors.heading_wander_deg = 2, s.sensors.heading_wander_time = 4;
  s.sensors.heading_error_deg = 3;
  std::vector<double> roll, yaw;
  for (const auto& q : fly(s).flight.attitude.value) {
    roll.push_back(euler_from_q_NB(q).roll / degree);
    yaw.push_back(heading(q) / degree);
  }
  double mean = 0;
  for (double& y : yaw) mean += y / static_cast<double>(yaw.size());
  for (double& y : yaw) y -= mean;
  // 500 independent values: 3 % of an sd; the mean 0.09 degrees; 3 sd.
  EXPECT_NEAR(mean, 3, 0.3);
  EXPECT_NEAR(sd(roll), 0.7, 0.07);
  EXPECT_NEAR(sd(yaw), 2, 0.2);
  EXPECT_NEAR(lagged(roll, 8), std::exp(-1), 0.12) << "4 s later";
  EXPECT_NEAR(lagged(yaw, 8), std::exp(-1), 0.12);
}

TEST(Sensors, VelocityHasItsBiasAndItsWander) {
  Scenario s = quiet_hover(4000);
  s.sensors.output_rate = 2;
  s.sensors.velocity_bias = {0.3, -0.2, 0.1};
  s.sensors.velocity_wander = 0.1, s.sensors.velocity_wander_time = 4;
  std::vector<double> north;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto flown = fly(s);
  for (const auto& v : flown.flight.velocity.value) {
    mean += v / static_cast<double>(flown.flight.velocity.size());
    north.push_back(v.x() - 0.3);
  }
  EXPECT_LT((mean - s.sensors.velocity_bias).norm(), 0.03);
  EXPECT_NEAR(sd(north), 0.1, 0.01);
  EXPECT_NEAR(lagged(north, 8), std::exp(-1), 0.12);
}

TEST(Sensors, BarometerDriftsAsToldAndWalks) {
  Scenario s = quiet_hover(3600);
  s.sensors.barometer_rate = 1;
  s.sensors.barometer_sd = 0;
  s.sensors.barometer_drift_per_hour = 5;
  const auto drift = fly(s).flight.barometer;
  EXPECT_NEAR(*drift.value.front().altitude_m, 160, 1e-9);
  EXPECT_NEAR(*drift.value.back().altitude_m, 165, 0.01);
  EXPECT_NEAR(*drift.value.front().pressure_pa, 101325 * std::pow(1 - 0.0065 * 160 / 288.15, 5.25588), 0.5)
      << "ISO 2533";
  s.sensors.barometer_drift_per_hour = 0;
  s.sensors.barometer_walk = 2;
  double sum = 0;
  for (s.seed = 1; s.seed <= 40; ++s.seed) {
    s.path[0].duration = 900;
    sum += std::pow(*fly(s).flight.barometer.value.back().altitude_m - 160, 2);
  }
  // 40 walks over a quarter of an hour: sd 1 m, known to 11 %.
  EXPECT_NEAR(std::sqrt(sum / 40), 1, 0.35);
}

TEST(Sensors, ReceiverDropOutsTakeTheShareThatTheyShould) {
  Scenario s = quiet_hover(7200);
  s.sensors.receiver = {120, 3};
  const auto flown = fly(s);
  // 120 times an hour between losses of 3 s: 30 s on, 3 s off on the mean; some 220 losses, 7 % of the share.
  const double share = 1 - static_cast<double>(flown.flight.velocity.size()) / 72000;
  EXPECT_NEAR(share, 3.0 / 33, 0.02);
  EXPECT_EQ(flown.flight.position.size(), flown.flight.velocity.size());
  EXPECT_EQ(flown.flight.attitude.size(), 72000u);
  EXPECT_EQ(flown.truth.size(), 72000u) << "the wind blew on";
  EXPECT_TRUE(flown.flight.gaps.empty()) << "the log itself lost nothing";
}

TEST(Sensors, LogDropOutsSilenceEveryStreamAndAreTold) {
  Scenario s = quiet_hover(1800);
  s.sensors.barometer_rate = 10;
  s.sensors.log = {120, 2};
  const auto f = fly(s).flight;
  ASSERT_GT(f.gaps.size(), 20u);
  for (const auto& gap : f.gaps) {
    EXPECT_LT(gap.from, gap.to);
    for (const auto* times : {&f.attitude.time, &f.velocity.time, &f.position.time, &f.barometer.time})
      for (const auto t : *times) ASSERT_FALSE(t >= gap.from && t < gap.to);
  }
}

TEST(Sensors, AccelerometerReadsMinusGravityInACalmHoverTiltedByTheTrim) {
  Scenario s = quiet_hover(10);
  s.sensors.accelerometer_rate = 50;
  s.sensors.trim_roll_deg = 2, s.sensors.trim_pitch_deg = -4;
  s.sensors.accelerometer_bias = {0.1, 0, 0};
  const auto f = fly(s).flight;
  const Eigen::Vector3d up = f.attitude.value.back().inverse() * Eigen::Vector3d(0, 0, -standard_gravity);
  EXPECT_LT((f.accelerometer.value.back() - up - Eigen::Vector3d(0.1, 0, 0)).norm(), 1e-9);
}

TEST(Sensors, AccelerometerOfThePointMassObeysTheDragLaw) {
  Scenario s = quiet_hover(30);
  s.path[0].kind = PathLeg::Kind::square;
  s.path[0].speed = 3;
  s.wind.toward = {4, 1};
  s.sensors.accelerometer_rate = 10;
  const auto flown = fly(s);
  for (std::size_t i = 10; i < flown.truth.size(); ++i) {
    const Eigen::Vector3d air_B =
        flown.flight.attitude.value[i].inverse() * (flown.flight.velocity.value[i] - flown.truth[i].v_NA_N);
    // Sampled between two steps of 10 ms, in which the motion changes by some 0.1 m/s2.
    EXPECT_LT((flown.flight.accelerometer.value[i].head<2>() + s.vehicle.drag.linear * air_B.head<2>()).norm(), 0.05);
  }
}

TEST(Sensors, LatencyIsTheAgeOfTheVelocityForTheRigidBodyToo) {
  // Correlation of the logged velocity with the position's own rate: best at the latency.
  Scenario s = quiet_rigid_hover(60);
  s.path[0].kind = PathLeg::Kind::square;
  s.path[0].speed = 3;
  s.sensors.output_rate = 50;
  s.sensors.latency = 0.2;
  const auto flown = fly(s);
  const LocalFrame frame(s.site.point, s.site.height.m);
  std::vector<Eigen::Vector3d> rate;
  const auto at = [&](std::size_t i) { return frame.to_ned(flown.flight.position.value[i], s.site.height.m); };
  for (std::size_t i = 1; i + 1 < flown.flight.position.size(); ++i) rate.push_back(25 * (at(i + 1) - at(i - 1)));
  double best = 1e9;
  std::size_t age = 0;
  for (std::size_t lag = 0; lag < 30; ++lag) {
    double sum = 0;
    for (std::size_t i = 40; i < rate.size(); ++i)
      sum += (flown.flight.velocity.value[i + 1] - rate[i - lag]).head<2>().squaredNorm();
    if (sum < best) best = sum, age = lag;
  }
  EXPECT_EQ(age, 10u) << "0.2 s at 50 Hz";
}

}  // namespace
}  // namespace quadsonde::ingest
