#include "ingest/flight/segments.h"

#include <gtest/gtest.h>

namespace quadsonde::ingest {
namespace {

LogTime at(double s) { return LogTime{} + seconds(s); }

/// Height above take-off over time, at 10 Hz, standing still.
template <class Height>
Flight flown(double duration, Height&& height) {
  Flight flight;
  for (int i = 0; i <= static_cast<int>(duration * 10); ++i) {
    const double t = 0.1 * i;
    flight.velocity.push(at(t), Eigen::Vector3d::Zero());
    flight.height_msl.push(at(t), MslHeight{150 + height(t)});
  }
  return flight;
}
double two_hops(double t) { return (t > 10 && t < 40) || (t > 60 && t < 100) ? 12 : 0.1; }

TEST(Segments, FindTakeoffAndLandingByHeight) {
  const auto segments = airborne_segments(flown(120, two_hops));
  ASSERT_EQ(segments.size(), 2u);
  // Heights are averaged over a second, so each edge is known to half of one.
  EXPECT_NEAR(to_seconds(segments[0].from - at(0)), 10.1, 0.51);
  EXPECT_NEAR(to_seconds(segments[0].to - at(0)), 39.9, 0.51);
  EXPECT_NEAR(to_seconds(segments[1].from - at(0)), 60.1, 0.51);
  EXPECT_FALSE(segments[0].starts_in_air || segments[0].ends_in_air);
}

TEST(Segments, TheLogsOwnWordDecides) {
  Flight flight = flown(120, two_hops);
  flight.landed.push(at(0), true);
  flight.landed.push(at(20), false);
  flight.landed.push(at(90), true);
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_NEAR(to_seconds(segments[0].from - at(0)), 20, 1e-6);
  EXPECT_NEAR(to_seconds(segments[0].to - at(0)), 89.9, 1e-6);
}

TEST(Segments, ADisarmedVehicleDoesNotFlyHoweverItsReceiverDrifts) {
  // dronekit_quad_flight.tlog: the height fell by 12 m after the first fix, which looked like a flight of 83 s.
  Flight flight = flown(120, two_hops);
  flight.events.push(at(0), {Event::What::disarmed, {}});
  flight.events.push(at(50), {Event::What::armed, {}});
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_NEAR(to_seconds(segments[0].from - at(0)), 60.1, 0.51);
}

TEST(Segments, AGroundSpeedIsAFlightTooWhereNoHeightIsLogged) {
  Flight flight;
  for (int i = 0; i < 600; ++i) flight.velocity.push(at(0.1 * i), {i > 100 && i < 400 ? 3.0 : 0.05, 0, 0});
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_NEAR(to_seconds(segments[0].to - segments[0].from), 29.8, 1e-6);
}

TEST(Segments, HopsShorterThanTheLeastAreNoFlight) {
  EXPECT_TRUE(airborne_segments(flown(60, [](double t) { return t > 10 && t < 18 ? 5.0 : 0.0; })).empty());
  EXPECT_TRUE(airborne_segments(Flight{}).empty());
  EXPECT_TRUE(airborne_segments(flown(60, [](double) { return 0.0; })).empty());
}

TEST(Segments, ABreakInTheDataEndsAFlightInTheAir) {
  Flight flight;
  for (int i = 0; i < 1000; ++i) {
    const double t = i < 500 ? 0.1 * i : 0.1 * i + 30;
    flight.velocity.push(at(t), {5, 0, 0});
  }
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_TRUE(segments[0].starts_in_air);
  EXPECT_TRUE(segments[0].ends_in_air);
  EXPECT_TRUE(segments[1].ends_in_air);
}

TEST(TakeoffHeight, IsTheLastHeightBeforeLiftOff) {
  const Flight flight = flown(60, [](double t) { return t < 10 ? 0.0 : t < 40 ? 20.0 : -0.5; });
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 1u);
  ASSERT_TRUE(takeoff_height(flight, segments[0]));
  EXPECT_DOUBLE_EQ(takeoff_height(flight, segments[0])->m, 150);
}

TEST(TakeoffHeight, IsThatOfTheLandingWhenTheLogBeginsInTheAir) {
  const Flight flight = flown(60, [](double t) { return t < 40 ? 20.0 : 0.0; });
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_TRUE(segments[0].starts_in_air);
  ASSERT_TRUE(takeoff_height(flight, segments[0]));
  EXPECT_DOUBLE_EQ(takeoff_height(flight, segments[0])->m, 150);
}

TEST(TakeoffHeight, IsNotGuessedWhenNeitherWasSeen) {
  Flight flight;
  for (int i = 0; i < 600; ++i) {
    flight.velocity.push(at(0.1 * i), {5, 0, 0});
    flight.height_msl.push(at(0.1 * i), MslHeight{180});
  }
  const auto segments = airborne_segments(flight);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_FALSE(takeoff_height(flight, segments[0]));
}

}  // namespace
}  // namespace quadsonde::ingest
