#include "ingest/motion/kinematics.h"

#include <gtest/gtest.h>

#include "tests/ingest/motion_check/flights.h"

namespace quadsonde::ingest {
namespace {

TEST(VelocityAgainstPosition, AgreesOnACleanFlight) {
  const auto seen = velocity_against_position(flown(telling_square(120, 1)));
  ASSERT_TRUE(seen);
  EXPECT_LT((seen->map - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff(), 5 * seen->sd);
  EXPECT_LT(seen->sd, 0.05);
}

TEST(VelocityAgainstPosition, SeesKnots) {
  const auto seen =
      velocity_against_position(with_velocity(flown(telling_square(120, 1)), [](auto& v) { v /= 0.514444; }));
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->map(0, 0), 0.514, 5 * seen->sd);
  EXPECT_NEAR(seen->map(1, 1), 0.514, 5 * seen->sd);
}

TEST(VelocityAgainstPosition, IsSilentAboutAVelocityMadeOfThePosition) {
  auto flight = flown(telling_square(120, 1));
  flight.velocity.origin = VelocityOrigin::differentiated;
  EXPECT_FALSE(velocity_against_position(flight));
}

TEST(VerticalAgainstHeight, SeesTheSignAndTheScale) {
  const auto flight = flown(scenario_of(Manoeuvre::ascent, {}, 60, 1));
  EXPECT_NEAR(vertical_against_height(flight).value().slope, 1, 0.05);
  EXPECT_NEAR(vertical_against_height(with_velocity(flight, [](auto& v) { v.z() *= -1; })).value().slope, -1, 0.05);
  EXPECT_NEAR(vertical_against_height(with_velocity(flight, [](auto& v) { v.z() *= 2; })).value().slope, 0.5, 0.03);
}

TEST(VerticalAgainstHeight, IsSilentInLevelFlight) {
  EXPECT_FALSE(vertical_against_height(flown(telling_square(60, 1))));
}

TEST(FrozenStretches, AreFoundWhereAValueLeapsAtTheEnd) {
  auto flight = flown(telling_square(60, 1));
  for (std::size_t i = 200; i < 260; ++i) flight.velocity.value[i] = flight.velocity.value[200];
  const auto found = frozen_stretches(flight, 1.0);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].stream, "velocity");
  EXPECT_NEAR(found[0].from, 20.0, 0.15);
  EXPECT_NEAR(found[0].to, 25.9, 0.15);
}

TEST(FrozenStretches, AreNotSeenInTheCoarseStepsOfAHover) {
  auto flight = flown(scenario_of(Manoeuvre::hover, {}, 60, 1));
  for (auto& v : flight.velocity.value) v = (v * 2).array().round() / 2;
  EXPECT_TRUE(frozen_stretches(flight, 1.0).empty());
}

TEST(LeadingZeros, AreCounted) {
  auto flight = flown(telling_square(60, 1));
  EXPECT_EQ(leading_zeros(flight), 0);
  for (std::size_t i = 0; i < 50; ++i) flight.velocity.value[i].setZero();
  EXPECT_NEAR(leading_zeros(flight), 4.9, 1e-9);
}

}  // namespace
}  // namespace quadsonde::ingest
