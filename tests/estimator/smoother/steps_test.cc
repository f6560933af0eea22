#include "estimator/smoother/steps.h"

#include <gtest/gtest.h>

#include <limits>

#include "ingest/flight/rotation.h"
#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::estimator {
namespace {

using ingest::Flight;

/// Nose north; s_N = tan of the angle by which the nose is down.
Eigen::Quaterniond leaning(double s_N, double yaw = 0) { return ingest::q_NB_from_euler({0, -std::atan(s_N), yaw}); }

template <class Slope>
Flight flight_of(double seconds, double velocity_hz, double attitude_hz, Slope&& slope) {
  Flight flight;
  for (int i = 0; i <= static_cast<int>(seconds * attitude_hz + 0.5); ++i)
    flight.attitude.push(at(i / attitude_hz), leaning(slope(i / attitude_hz)));
  for (int i = 0; i <= static_cast<int>(seconds * velocity_hz + 0.5); ++i)
    flight.velocity.push(at(i / velocity_hz), Eigen::Vector3d(0.1 * i, 0, 0));
  return flight;
}

TEST(Steps, AverageAFasterAttitudeAndNeverDecimateIt) {
  // One sample of five leans by 0.5: decimated it would read 0 or 0.5; its mean is 0.1.
  const auto flight = flight_of(10, 10, 50, [](double t) { return std::lround(t * 50) % 5 == 2 ? 0.5 : 0.0; });
  const auto steps = make_steps(flight, {}).steps;
  ASSERT_EQ(steps.size(), 101u);
  for (std::size_t k = 1; k < steps.size(); ++k) {
    EXPECT_TRUE(steps[k].sound);
    EXPECT_NEAR(steps[k].input.slope.x(), 0.1, 1e-3) << k;
    EXPECT_NEAR(steps[k].input.slope.y(), 0, 1e-12);
    EXPECT_NEAR(steps[k].input.step, 0.1, 1e-9);
  }
}

TEST(Steps, InterpolateASlowerAttitude) {
  const auto flight = flight_of(10, 20, 5, [](double t) { return 0.02 * t; });
  const auto laid = make_steps(flight, {});
  EXPECT_NEAR(laid.attitude_interval, 0.2, 1e-9);
  EXPECT_NEAR(laid.velocity_interval, 0.05, 1e-9);
  for (std::size_t k = 1; k < laid.steps.size(); ++k)
    EXPECT_NEAR(laid.steps[k].input.slope.x(), 0.02 * (0.05 * static_cast<double>(k) - 0.025), 1e-5) << k;
}

TEST(Steps, ReadTheAttitudeEarlierByTheLatency) {
  const auto flight = flight_of(10, 10, 25, [](double t) { return 0.02 * t; });
  StepSettings late;
  late.latency = 0.33;
  const auto steps = make_steps(flight, late).steps;
  for (std::size_t k = 5; k < steps.size(); ++k) {
    EXPECT_NEAR(steps[k].input.slope.x(), 0.02 * (0.1 * static_cast<double>(k) - 0.05 - 0.33), 1e-5) << k;
    EXPECT_NEAR(steps[k].input.slope_rate.x(), 0.02, 1e-5);
  }
}

TEST(Steps, WeighTheAttitudeAsItsEffectDecays) {
  const auto flight = flight_of(10, 1, 50, [](double t) { return std::fmod(t, 1) < 0.5 ? 0.2 : 0.0; });
  StepSettings s;
  s.drag = 2;
  // Mean of 0.2 over the first half, weighed exp(-2 (1 - t)): .2 (e^-1 - e^-2) / (1 - e^-2).
  const double expected = 0.2 * (std::exp(-1.0) - std::exp(-2.0)) / (1 - std::exp(-2.0));
  const auto steps = make_steps(flight, s).steps;
  EXPECT_NEAR(steps[5].input.slope.x(), expected, 4e-3)
      << "the samples' ramps are 0.02 s wide; unweighed it would be 0.1";
}

TEST(Steps, BridgeAShortGapAndRestartAfterALongOne) {
  auto flight = flight_of(20, 10, 10, [](double) { return 0.1; });
  const auto drop = [&](double from, double to) {
    auto& v = flight.velocity;
    for (std::size_t i = v.size(); i-- > 0;)
      if (v.time[i] > at(from) && v.time[i] < at(to)) {
        v.time.erase(v.time.begin() + static_cast<std::ptrdiff_t>(i));
        v.value.erase(v.value.begin() + static_cast<std::ptrdiff_t>(i));
      }
  };
  drop(5, 6.5);
  drop(10, 13);
  int bridged = 0, broken = 0;
  for (const auto& step : make_steps(flight, {}).steps) {
    bridged += step.input.step > 1.4 && step.sound;
    if (!step.gap_before) continue;
    ++broken;
    EXPECT_FALSE(step.sound);
    EXPECT_EQ(step.fault, Reason::data_gap);
    EXPECT_NEAR(step.seconds, 13, 1e-9);
  }
  EXPECT_EQ(bridged, 1);
  EXPECT_EQ(broken, 1);
}

TEST(Steps, AHoleInTheAttitudeIsSaidAndNotInterpolated) {
  Flight flight = flight_of(20, 10, 20, [](double) { return 0.1; });
  Flight holed = flight;
  holed.attitude = {};
  for (std::size_t i = 0; i < flight.attitude.size(); ++i)
    if (flight.attitude.time[i] <= at(8) || flight.attitude.time[i] >= at(9))
      holed.attitude.push(flight.attitude.time[i], flight.attitude.value[i]);
  for (const auto& step : make_steps(holed, {}).steps) {
    const bool inside = step.seconds > 8.05 && step.seconds < 9.05,
               outside = step.seconds < 7.95 || step.seconds > 9.15;
    if (outside) {
      EXPECT_TRUE(step.sound) << step.seconds;
    }
    if (inside) {
      EXPECT_FALSE(step.sound) << step.seconds;
      EXPECT_EQ(step.fault, Reason::no_attitude);
    }
  }
}

TEST(Steps, OutsideTheAttitudesTimeNothingIsSound) {
  Flight flight = flight_of(20, 10, 10, [](double) { return 0.1; });
  flight.attitude = ingest::cut(flight, at(5), at(15)).attitude;
  for (const auto& step : make_steps(flight, {}).steps)
    if (step.seconds < 4.3 || step.seconds > 15.6) {
      EXPECT_FALSE(step.sound) << step.seconds;
      EXPECT_EQ(step.fault, Reason::no_attitude);
    }
}

TEST(Steps, CountARepeatedInstantOnce) {
  const Flight flight = flight_of(5, 10, 10, [](double t) { return 0.01 * t; });
  Flight twice;
  for (std::size_t i = 0; i < flight.velocity.size(); ++i)
    for (int n = 0; n < 2; ++n) {
      twice.velocity.push(flight.velocity.time[i], flight.velocity.value[i]);
      twice.attitude.push(flight.attitude.time[i], flight.attitude.value[i]);
    }
  const auto once_laid = make_steps(flight, {}), twice_laid = make_steps(twice, {});
  const auto &a = once_laid.steps, &b = twice_laid.steps;
  EXPECT_NEAR(twice_laid.attitude_interval, once_laid.attitude_interval, 1e-9);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].input.slope, b[k].input.slope);
}

TEST(Steps, RefuseATiltOver45Degrees) {
  const auto flight = flight_of(10, 10, 10, [](double t) { return t > 4.95 && t < 6.05 ? 1.2 : 0.9; });
  for (const auto& step : make_steps(flight, {}).steps) {
    EXPECT_EQ(step.sound, step.tilt < std::numbers::pi / 4) << step.seconds;
    if (step.seconds > 5.05 && step.seconds < 5.95) {
      EXPECT_EQ(step.fault, Reason::tilt_over_45_deg);
    }
  }
}

TEST(Steps, SubtractTheVerticalAccelerationFromGravity) {
  for (const bool causal : {false, true}) {
    Flight flight;
    for (int i = 0; i <= 200; ++i) {
      flight.attitude.push(at(0.05 * i), leaning(0.1));
      flight.velocity.push(at(0.05 * i), Eigen::Vector3d(0, 0, -0.7 * 0.05 * i));  // pulling up by 0.7 m/s2
    }
    StepSettings s;
    s.causal = causal;
    const auto steps = make_steps(flight, s).steps;
    EXPECT_NEAR(steps[100].input.lift, ingest::standard_gravity + 0.7, 1e-9);
    EXPECT_NEAR(steps[100].input.v_down, -0.7 * 4.975, 1e-9);
  }
}

TEST(Steps, UnwrapTheHeadingAcrossSouth) {
  Flight flight;
  for (int i = 0; i <= 100; ++i) {
    flight.attitude.push(at(0.1 * i), leaning(0, 3.0 + 0.02 * i));
    flight.velocity.push(at(0.1 * i), Eigen::Vector3d::Zero());
  }
  const auto steps = make_steps(flight, {}).steps;
  for (std::size_t k = 1; k < steps.size(); ++k)
    EXPECT_NEAR(
        std::remainder(steps[k].input.heading - (3.0 + 0.02 * (static_cast<double>(k) - 0.5)), 2 * std::numbers::pi), 0,
        1e-9);
}

TEST(Steps, TakeTheLogsOwnAccuracyWithAFloorAndADefaultWhereItIsNone) {
  Flight flight = flight_of(1, 10, 10, [](double) { return 0.1; });
  flight.velocity.sd.assign(flight.velocity.size(), 0.3);
  flight.velocity.sd[3] = 0.001;
  flight.velocity.sd[4] = std::numeric_limits<double>::quiet_NaN();
  const auto steps = make_steps(flight, {}).steps;
  EXPECT_DOUBLE_EQ(steps[2].variance, 0.09);
  EXPECT_DOUBLE_EQ(steps[3].variance, 0.0025) << "floor 0.05 m/s";
  EXPECT_DOUBLE_EQ(steps[4].variance, 0.01) << "an accuracy that is no number is not stated";
}

}  // namespace
}  // namespace quadsonde::estimator
