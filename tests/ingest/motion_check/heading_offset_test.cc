#include "ingest/motion/heading_offset.h"

#include <cmath>

#include "ingest/motion/scenario.h"
#include "tests/ingest/motion/made_scenarios.h"

namespace quadsonde::ingest {
namespace {

const char* square = R"(
seed = 1
[wind]
model = "constant"
speed_m_s = 4
from_deg = 290
turbulence_sd_m_s = 0.5
[[path]]
kind = "square"
speed_m_s = 3
side_duration_s = 10
duration_s = 300
yaw_rate_deg_s = 17
)";

Flight flown(unsigned seed, double wrong_deg, const std::string& toml = square) {
  auto scenario = parse_scenario(toml, "scenario.toml");
  EXPECT_TRUE(scenario) << to_string(scenario.error());
  scenario->seed = seed;
  auto flight = fly(*scenario).flight;
  const Eigen::Quaterniond by(Eigen::AngleAxisd(wrong_deg * degree, Eigen::Vector3d::UnitZ()));
  for (auto& q : flight.attitude.value) q = by * q;
  return flight;
}

TEST(HeadingOffset, IsFoundOnASquareWithinItsOwnUncertainty) {
  double squares = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto found = estimate_heading_offset(flown(seed, 8));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->deg, -8, 4 * found->sd_deg) << seed;
    EXPECT_LT(found->sd_deg, 2.7) << "8 deg must stand out";
    EXPECT_TRUE(found->determined(2)) << found->deg << " +- " << found->sd_deg;
    squares += std::pow((found->deg + 8) / found->sd_deg, 2);
  }
  EXPECT_LT(squares / 12, 2.2) << "normalised errors of 12 flights: chi-square 12, 99.9 %";
}

TEST(HeadingOffset, IsNotInventedWhereTheHeadingsAreRight) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto found = estimate_heading_offset(flown(seed, 0));
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->determined(2)) << found->deg << " +- " << found->sd_deg;
  }
}

TEST(HeadingOffset, IsNotDeterminedByAHover) {
  const auto flight = flown(3, 20, R"(
seed = 1
[wind]
model = "constant"
speed_m_s = 4
from_deg = 290
turbulence_sd_m_s = 0.5
[[path]]
kind = "hover"
duration_s = 300
yaw_rate_deg_s = 20
)");
  const auto found = estimate_heading_offset(flight);
  if (found) {
    EXPECT_FALSE(found->determined(2)) << found->deg << " +- " << found->sd_deg;
  }
}

TEST(HeadingOffset, SaysNothingOfAFewSeconds) {
  const auto flight = flown(1, 8);
  const auto from = flight.velocity.time.front();
  EXPECT_FALSE(estimate_heading_offset(cut(flight, from, from + seconds(20))));
  EXPECT_FALSE(estimate_heading_offset(Flight{}));
}

}  // namespace
}  // namespace quadsonde::ingest
