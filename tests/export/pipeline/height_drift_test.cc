#include "export/pipeline/height_drift.h"

#include <gtest/gtest.h>

#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

/// The ascent from the ground and back, its height drifting evenly by so much over the whole log.
ingest::Flight drifting(double metres) {
  auto flight = support::flown().flight;
  const auto from = flight.height_msl.time.front();
  const double span = ingest::to_seconds(flight.height_msl.time.back() - from);
  for (std::size_t i = 0; i < flight.height_msl.size(); ++i)
    flight.height_msl.value[i].m += metres * ingest::to_seconds(flight.height_msl.time[i] - from) / span;
  return flight;
}

/// Lift-off and touch-down of that flight: the simulated log says nothing of either.
ingest::Segment in_the_air(const ingest::Flight& flight) {
  const auto segments = ingest::airborne_segments(flight);
  return segments.at(0);
}

TEST(HeightDrift, IsSeenByTheLandingAndTakenOff) {
  const auto segment = in_the_air(drifting(0));
  EXPECT_FALSE(find_height_drift(drifting(0), segment));
  auto flight = drifting(5);
  const auto drift = find_height_drift(flight, segment);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->metres, 5, 0.8) << "the ground before and after is not in the flight";
  EXPECT_EQ(drift->by, "the landing");
  take_off_drift(flight, *drift);
  const auto clean = drifting(0);
  for (std::size_t i = 0; i < flight.height_msl.size(); ++i) {
    if (flight.height_msl.time[i] < segment.from || flight.height_msl.time[i] > segment.to) continue;
    EXPECT_NEAR(flight.height_msl.value[i].m, clean.height_msl.value[i].m, 0.8);
  }
}

TEST(HeightDrift, OfALandingElsewhereIsNoDrift) {
  auto flight = drifting(5);
  const auto segment = in_the_air(drifting(0));
  for (std::size_t i = 0; i < flight.position.size(); ++i)
    if (flight.position.time[i] > segment.to) flight.position.value[i].lat_deg += 0.001;  // 111 m
  EXPECT_FALSE(find_height_drift(flight, segment));
}

TEST(HeightDrift, IsSeenByTheSatelliteHeightWhereNoLandingIsLogged) {
  auto flight = drifting(12);
  flight.height_ellipsoid.source = "GPS";
  const auto clean = drifting(0);
  for (std::size_t i = 0; i < clean.height_msl.size(); ++i)
    flight.height_ellipsoid.push(clean.height_msl.time[i], ingest::EllipsoidHeight{clean.height_msl.value[i].m + 48});
  auto segment = in_the_air(clean);
  segment.ends_in_air = true;
  const auto drift = find_height_drift(flight, segment);
  ASSERT_TRUE(drift);
  EXPECT_EQ(drift->by, "the satellite height");
  EXPECT_GT(drift->metres, 4.5);
}

}  // namespace
}  // namespace quadsonde::product
