#include "profiles/compare/against_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/export/made_up.h"

namespace quadsonde::profiles {
namespace {

using estimator::WindEstimate;
using support::point_at;

WindEstimate wind_of(double north, double east, double sd = 0.1) {
  WindEstimate wind;
  wind.v_NA_N = {north, east};
  wind.covariance = sd * sd * Eigen::Matrix2d::Identity();
  return wind;
}

/// Ours errs by (+0.3, -0.4) north and east, every time; the truth blows 4 m/s to the north.
estimator::WindSeries biased_series() {
  estimator::WindSeries series;
  for (int i = 0; i < 100; ++i) series.points.push_back(point_at(0.1 * i, 5 + 0.3 * i, wind_of(4.3, -0.4)));
  return series;
}
ingest::Truth steady_truth() {
  ingest::Truth truth;
  for (int i = 0; i <= 20; ++i)
    truth.push_back({ingest::LogTime{ingest::seconds(0.5 * i).count()}, {5 + 1.5 * i}, {4, 0, 0}});
  return truth;
}
WindProfile four_bins(Datum datum = Datum::agl) {
  WindProfile profile;
  profile.datum = datum;
  Leg all{LegName::all, {}};
  for (int b = 0; b < 4; ++b) {
    auto bin = support::bin_at(10.0 * b, 1, 180, 1);
    if (datum == Datum::msl) bin.bottom += 150, bin.top += 150;
    bin.wind = wind_of(4.3, -0.4, 1);
    all.bins.push_back(bin);
  }
  profile.legs = {all};
  return profile;
}

TEST(AgainstTruth, GivesTheErrorsThatWereMade) {
  const auto scores = score_against_truth(biased_series(), nullptr, nullptr, steady_truth());
  const auto& s = scores.samples;
  EXPECT_EQ(s.n, 100u);
  EXPECT_NEAR(s.north.bias, 0.3, 1e-12);
  EXPECT_NEAR(s.east.bias, -0.4, 1e-12);
  EXPECT_NEAR(s.east.rmse, 0.4, 1e-12);
  EXPECT_NEAR(s.rmsve, 0.5, 1e-12);
  EXPECT_NEAR(s.speed.bias, std::hypot(4.3, 0.4) - 4, 1e-12);
  // The wind blows a little to the west of north: it comes from a little east of south, 5.3 degrees anticlockwise.
  EXPECT_NEAR(s.direction.bias, -std::atan2(0.4, 4.3) * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(*s.inside95, 0, 1e-12) << "3 and 4 sigma away";
  EXPECT_NEAR(*s.normalised_error, (9 + 16) / 2.0, 1e-9);
  EXPECT_EQ(&scores.whole(), &scores.samples);
}

TEST(AgainstTruth, TakesTheTruthLinearBetweenItsSamplesAndNeverAcrossAGap) {
  ingest::Truth truth{{ingest::LogTime{0}, {0}, {0, 0, 0}},
                      {ingest::LogTime{1'000'000'000}, {0}, {10, 0, 0}},
                      {ingest::LogTime{9'000'000'000}, {0}, {10, 0, 0}}};
  estimator::WindSeries series;
  series.points = {point_at(0.25, 10, wind_of(2.5, 0)), point_at(5, 10, wind_of(10, 0)),
                   point_at(20, 10, wind_of(10, 0))};
  const auto s = score_against_truth(series, nullptr, nullptr, truth).samples;
  EXPECT_EQ(s.n, 1u);
  EXPECT_NEAR(s.rmsve, 0, 1e-12);
}

TEST(AgainstTruth, ScoresBinsAgainstTheTruthOfTheSameTimes) {
  const auto series = biased_series();
  const auto profile = four_bins();
  const auto scores = score_against_truth(series, nullptr, &profile, steady_truth());
  ASSERT_EQ(scores.legs.size(), 1u);
  EXPECT_EQ(scores.legs[0].scores.n, 4u);
  EXPECT_NEAR(scores.legs[0].scores.rmsve, 0.5, 1e-12);
  EXPECT_NEAR(*scores.legs[0].scores.inside95, 1, 1e-12);
  const auto& lowest = scores.legs[0].bins[0];
  EXPECT_EQ(lowest.samples, 17u) << "5 to 9.8 m in steps of 0.3";
  EXPECT_EQ(lowest.scores.n, 17u) << "every layer has scores of its own";
  EXPECT_NEAR(lowest.scores.north.bias, 0.3, 1e-12);
  EXPECT_NEAR(lowest.reference.x(), 4, 1e-12);
}

TEST(AgainstTruth, AProfileAloneIsMatchedByHeightInEitherDatum) {
  for (const auto datum : {Datum::agl, Datum::msl}) {
    const auto scores = score_against_truth(four_bins(datum), steady_truth());
    EXPECT_TRUE(scores.by_height);
    ASSERT_EQ(scores.legs.size(), 1u);
    EXPECT_EQ(scores.whole().n, 4u) << name(datum);
    EXPECT_NEAR(scores.whole().rmsve, 0.5, 1e-12);
  }
}

TEST(AgainstTruth, WithoutAnInstantOrHeightInCommonHasNoPairs) {
  const ingest::Truth elsewhere{{ingest::LogTime{INT64_MAX / 2}, {500}, {1, 1, 1}}};
  EXPECT_EQ(score_against_truth(biased_series(), nullptr, nullptr, elsewhere).whole().n, 0u);
  EXPECT_EQ(score_against_truth(four_bins(), elsewhere).whole().n, 0u);
  EXPECT_EQ(score_against_truth(WindProfile{}, elsewhere).whole().n, 0u);
}

}  // namespace
}  // namespace quadsonde::profiles
