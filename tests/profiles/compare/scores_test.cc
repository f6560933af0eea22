#include "profiles/compare/scores.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/export/made_up.h"

namespace quadsonde::profiles {
namespace {

using support::toward_from;

Scores scores_of(const std::vector<Pair>& pairs, double direction_above = 2) {
  Scorer scorer(direction_above);
  for (const auto& pair : pairs) scorer.add(pair);
  return scorer.scores();
}

// Errors east 1, 2, 3, 6 and north 0, computed by hand: bias 3, sum of squares 50, around the mean 14.
TEST(Scores, AreThoseComputedByHand) {
  std::vector<Pair> pairs;
  for (const double e : {1.0, 2.0, 3.0, 6.0}) pairs.push_back(pair_of({0, 10 + e}, {0, 10}));
  const auto s = scores_of(pairs);
  EXPECT_EQ(s.n, 4u);
  EXPECT_DOUBLE_EQ(s.east.bias, 3);
  EXPECT_DOUBLE_EQ(s.east.rmse, std::sqrt(50 / 4.0));
  EXPECT_DOUBLE_EQ(*s.east.sd, std::sqrt(14 / 3.0));
  EXPECT_DOUBLE_EQ(s.north.bias, 0);
  EXPECT_DOUBLE_EQ(s.speed.bias, 3);
  EXPECT_DOUBLE_EQ(s.rmsve, std::sqrt(50 / 4.0));
  EXPECT_NEAR(s.east.rmse * s.east.rmse, s.east.bias * s.east.bias + *s.east.sd * *s.east.sd * 3 / 4, 1e-12);
}

// Around the mean -2, -1, 0, 3: lag-1 products 2 + 0 + 0 = 2 of 14, so r = 1/7 and n_eff = 4 (6/7) / (8/7) = 3.
TEST(Scores, GiveTheBiasAnIntervalOfItsEffectiveSamples) {
  const auto s = error_statistics({1, 2, 3, 6});
  EXPECT_NEAR(*s.effective_samples, 3, 1e-12);
  EXPECT_NEAR(*s.bias_half95, 4.3027 * std::sqrt(14 / 3.0) / std::sqrt(3.0), 1e-4) << "t of 2 degrees of freedom";
  EXPECT_FALSE(error_statistics({1}).sd) << "one pair has no scatter";
  EXPECT_FALSE(error_statistics({1}).bias_half95);
}

TEST(Scores, TakeTheQuantileOfStudentsDistribution) {
  // Tabulated to four digits in every textbook.
  EXPECT_NEAR(t_quantile(1), 12.706, 1e-3);
  EXPECT_NEAR(t_quantile(4), 2.776, 1e-3);
  EXPECT_NEAR(t_quantile(7), 2.365, 0.006 * 2.365);
  EXPECT_NEAR(t_quantile(25), 2.060, 0.006 * 2.060);
  EXPECT_NEAR(t_quantile(120), 1.980, 1e-3);
  EXPECT_NEAR(t_quantile(1e9), 1.960, 1e-3);
  for (double v = 1; v < 200; v *= 1.1) EXPECT_GT(t_quantile(v), t_quantile(v * 1.1));
}

TEST(Scores, OfErrorsThatFollowEachOtherHaveFewEffectiveSamples) {
  std::vector<double> slow, fast;
  for (int i = 0; i < 1000; ++i) slow.push_back(std::sin(i * 0.01)), fast.push_back(i % 2 ? 1 : -1);
  EXPECT_NEAR(*error_statistics(slow).effective_samples, 1000 * 0.01 / 1.99, 0.01) << "r is held at .99";
  EXPECT_EQ(*error_statistics(fast).effective_samples, 1000) << "a negative r brings no more than n";
}

TEST(Scores, OfDirectionsGoTheShortWayAroundNorth) {
  const auto s =
      scores_of({pair_of(toward_from(5, 10), toward_from(5, 350)), pair_of(toward_from(5, 340), toward_from(5, 350))});
  EXPECT_EQ(s.direction.n, 2u);
  EXPECT_NEAR(s.direction.bias, 5, 1e-9) << "+20 and -10 degrees";
  EXPECT_NEAR(s.direction.rmse, std::sqrt((400 + 100) / 2.0), 1e-9);
  EXPECT_DOUBLE_EQ(turn_between(350, 10), 20);
  EXPECT_DOUBLE_EQ(turn_between(0, 180), 180);
  EXPECT_DOUBLE_EQ(turn_between(180, 0), 180);
}

TEST(Scores, LeaveDirectionsOfSlowWindsOutAndCountThem) {
  const auto s = scores_of(
      {pair_of(toward_from(5, 10), toward_from(1.9, 350)), pair_of(toward_from(1.9, 10), toward_from(5, 350)),
       pair_of(toward_from(2.1, 10), toward_from(2.1, 10)), pair_of(toward_from(5, 10), Eigen::Vector2d::Zero())});
  EXPECT_EQ(s.n, 4u);
  EXPECT_EQ(s.direction.n, 1u);
  EXPECT_EQ(s.n_slow, 3u);
  EXPECT_EQ(scores_of({pair_of(toward_from(1, 10), toward_from(1, 20))}, 0.5).direction.n, 1u);
}

TEST(Scores, OfAWindWithoutDirectionCountTheSpeedOnly) {
  Pair variable{toward_from(3, 100), 2, 2, std::nullopt, std::nullopt};
  const auto s = scores_of({variable});
  EXPECT_EQ(s.n, 1u);
  EXPECT_NEAR(s.speed.bias, 1, 1e-12);
  EXPECT_EQ(s.east.n, 0u);
  EXPECT_EQ(s.direction.n, 0u);
  EXPECT_EQ(s.n_no_direction, 1u);
}

TEST(Scores, InsideARangeOfSpeedsAreWithoutSpeedError) {
  const auto range = [](double ours) { return Pair{toward_from(ours, 200), 2, 4, toward_from(3, 200), std::nullopt}; };
  EXPECT_EQ(speed_error(range(2)), 0);
  EXPECT_EQ(speed_error(range(3.9)), 0);
  EXPECT_NEAR(speed_error(range(4.5)), 0.5, 1e-12);
  EXPECT_NEAR(speed_error(range(1)), -1, 1e-12);
  const auto s = scores_of({range(2.5), range(4.5)});
  EXPECT_EQ(s.n_range, 2u);
  EXPECT_EQ(s.n_in_range, 1u);
  EXPECT_NEAR(s.rmsve, std::sqrt(0.25 / 2), 1e-12) << "the vector is that of the range nearest to ours";
}

TEST(Scores, TellWhetherTheExpectedErrorsAreHonest) {
  const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
  const auto s = scores_of({pair_of({0.5, 1.5}, {0, 0}, unit), pair_of({0, 3}, {0, 0}, unit)});
  EXPECT_DOUBLE_EQ(*s.inside68, 2 / 4.0) << ".5 and 0 of .5, 1.5, 0, 3";
  EXPECT_DOUBLE_EQ(*s.inside95, 3 / 4.0);
  EXPECT_DOUBLE_EQ(*s.normalised_error, (0.25 + 2.25 + 9) / 4);
  EXPECT_FALSE(scores_of({pair_of({1, 1}, {0, 0})}).normalised_error) << "no covariance, no judgement";
}

TEST(Scores, OfNothingAreEmpty) {
  const auto s = scores_of({});
  EXPECT_EQ(s.n, 0u);
  EXPECT_EQ(s.rmsve, 0);
  EXPECT_FALSE(s.inside95);
}

}  // namespace
}  // namespace quadsonde::profiles
