#include "profiles/legs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/profiles/made_series.h"

namespace quadsonde::profiles {
namespace {

const Eigen::Vector2d breeze(3, 1);

std::vector<Part> parts_of(const SeriesMaker& maker, double least_extent = 5) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : maker.series.points) heights.push_back(p.height_agl->m);
  return find_parts(maker.series.points, heights, least_extent);
}
double share(const std::vector<Part>& parts, Part part) {
  return static_cast<double>(std::count(parts.begin(), parts.end(), part)) / static_cast<double>(parts.size());
}

TEST(Legs, AnAscentAndADescentAreTwo) {
  const auto parts = parts_of(SeriesMaker().climb(100, 2, breeze).climb(0, 2, breeze));
  EXPECT_NEAR(share(parts, Part::up), 0.5, 0.03);
  EXPECT_NEAR(share(parts, Part::down), 0.5, 0.03);
}

TEST(Legs, APauseInAClimbBelongsToIt) {
  const auto parts = parts_of(SeriesMaker().climb(40, 2, breeze).stay(60, breeze).climb(80, 2, breeze));
  EXPECT_EQ(share(parts, Part::up), 1);
}

TEST(Legs, APauseAtTheTopOrALongHoverBelongsToNeither) {
  auto parts = parts_of(SeriesMaker().climb(40, 2, breeze).stay(60, breeze).climb(0, 2, breeze));
  EXPECT_EQ(parts[500], Part::level) << "between up and down";
  parts = parts_of(SeriesMaker().climb(40, 2, breeze).stay(120, breeze).climb(80, 2, breeze));
  EXPECT_EQ(parts[800], Part::level) << "longer than 90 s is a hover of its own";
}

TEST(Legs, ShortStepsWithPausesAreOneClimb) {
  SeriesMaker steps;
  for (int i = 1; i <= 10; ++i) steps.climb(3.0 * i, 1, breeze).stay(10, breeze);
  const auto parts = parts_of(steps);
  EXPECT_GT(share(parts, Part::up), 0.9) << "each step is smaller than the least extent, together they are a climb";
}

TEST(Legs, WobblesAreLevel) {
  SeriesMaker wobble;
  wobble.from(20);
  for (int i = 0; i < 10; ++i) wobble.climb(22, 0.5, breeze).climb(20, 0.5, breeze);
  EXPECT_EQ(share(parts_of(wobble), Part::level), 1);
}

std::vector<FoundLeg> legs_of(const SeriesMaker& maker, const std::vector<Part>& parts) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : maker.series.points) heights.push_back(p.height_agl->m);
  return found_legs(maker.series, parts, heights);
}

TEST(FoundLegs, AreListedInTheOrderOfTimeWithTheirHeights) {
  const auto maker = SeriesMaker().climb(40, 2, breeze).stay(60, breeze).climb(0, 2, breeze);
  const auto legs = legs_of(maker, parts_of(maker));
  ASSERT_EQ(legs.size(), 3u);
  EXPECT_EQ(legs[0].kind, FoundLeg::Kind::ascent);
  EXPECT_EQ(legs[1].kind, FoundLeg::Kind::hover);
  EXPECT_EQ(legs[2].kind, FoundLeg::Kind::descent);
  EXPECT_NEAR(*legs[0].highest, 40, 1);
  EXPECT_NEAR(legs[0].climb, 2, 0.15);
  EXPECT_NEAR(legs[1].seconds, 60, 4) << "the climb rate is averaged over 4 s";
}

TEST(NamedLegs, AreThoseOfTheUser) {
  const auto maker = SeriesMaker().climb(40, 2, breeze).stay(60, breeze).climb(0, 2, breeze);
  const auto parts = *named_parts(maker.series.points, "up 2-10.5, down 85-95");
  EXPECT_EQ(parts[50], Part::up);
  EXPECT_EQ(parts[150], Part::level);
  EXPECT_EQ(parts[900], Part::down);
}

TEST(NamedLegs, ThatCannotBeReadOrHoldNothingAreRefused) {
  const auto maker = SeriesMaker().climb(40, 2, breeze);
  for (const char* text : {"up", "up 5", "up 9-3", "sideways 1-5", "up 1-5 down 6-7", "up 500-600"}) {
    const auto parts = named_parts(maker.series.points, text);
    ASSERT_FALSE(parts) << text;
    EXPECT_EQ(parts.error().kind, ingest::Kind::usage);
    EXPECT_NE(parts.error().hint.find("time_s"), std::string::npos);
  }
}

}  // namespace
}  // namespace quadsonde::profiles
