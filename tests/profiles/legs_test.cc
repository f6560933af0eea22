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

}  // namespace
}  // namespace quadsonde::profiles
