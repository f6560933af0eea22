#include "export/pipeline/compare_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "profiles/make_profile.h"
#include "tests/export/made_up.h"

namespace quadsonde::product {
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

TEST(CompareWithTruth, GivesTheErrorsThatWereMade) {
  const auto comparison = compare_with_truth(biased_series(), nullptr, nullptr, steady_truth());
  const auto& s = comparison.samples;
  EXPECT_EQ(s.n, 100u);
  EXPECT_NEAR(s.bias_north, 0.3, 1e-12);
  EXPECT_NEAR(s.bias_east, -0.4, 1e-12);
  EXPECT_NEAR(s.rmse_east, 0.4, 1e-12);
  EXPECT_NEAR(s.rmsve, 0.5, 1e-12);
  EXPECT_NEAR(s.bias_speed, std::hypot(4.3, 0.4) - 4, 1e-12);
  // The wind blows a little to the west of north: it comes from a little east of south, 5.3 degrees anticlockwise.
  EXPECT_NEAR(*s.bias_direction, -std::atan2(0.4, 4.3) * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(*s.inside95, 0, 1e-12) << "3 and 4 sigma away";
  EXPECT_NEAR(*s.normalised_error, (9 + 16) / 2.0, 1e-9);
}

TEST(CompareWithTruth, TakesTheTruthLinearBetweenItsSamplesAndNeverAcrossAGap) {
  ingest::Truth truth{{ingest::LogTime{0}, {0}, {0, 0, 0}},
                      {ingest::LogTime{1'000'000'000}, {0}, {10, 0, 0}},
                      {ingest::LogTime{9'000'000'000}, {0}, {10, 0, 0}}};
  estimator::WindSeries series;
  series.points = {point_at(0.25, 10, wind_of(2.5, 0)), point_at(5, 10, wind_of(10, 0)),
                   point_at(20, 10, wind_of(10, 0))};
  const auto s = compare_with_truth(series, nullptr, nullptr, truth).samples;
  EXPECT_EQ(s.n, 1u);
  EXPECT_NEAR(s.rmsve, 0, 1e-12);
}

TEST(CompareWithTruth, ScoresBinsAgainstTheTruthOfTheSameTimes) {
  const auto series = biased_series();
  profiles::WindProfile profile;
  profiles::Leg all{profiles::LegName::all, {}};
  for (int b = 0; b < 4; ++b) {
    profiles::Bin bin = support::bin_at(10.0 * b, 1, 180, 1);
    bin.wind = wind_of(4.3, -0.4, 1);
    all.bins.push_back(bin);
  }
  profile.legs = {all};
  const auto comparison = compare_with_truth(series, nullptr, &profile, steady_truth());
  ASSERT_EQ(comparison.legs.size(), 1u);
  EXPECT_EQ(comparison.legs[0].scores.n, 4u);
  EXPECT_NEAR(comparison.legs[0].scores.rmsve, 0.5, 1e-12);
  EXPECT_NEAR(*comparison.legs[0].scores.inside95, 1, 1e-12);
  EXPECT_EQ(comparison.legs[0].bins[0].samples, 17u) << "5 to 9.8 m in steps of 0.3";
  ASSERT_EQ(comparison.levels.size(), 4u);
  EXPECT_NEAR(comparison.levels[1].height, 15, 1e-12);
  EXPECT_NEAR(comparison.levels[1].v_NA_N.x(), 4, 1e-12);
}

TEST(CompareWithTruth, SaysWhenNothingCanBeCompared) {
  const auto comparison =
      compare_with_truth(biased_series(), nullptr, nullptr, {{ingest::LogTime{INT64_MAX / 2}, {0}, {1, 1, 1}}});
  EXPECT_EQ(comparison.samples.n, 0u);
  EXPECT_THAT(comparison_sentences(comparison).at(0), testing::HasSubstr("no instant in common"));
}

TEST(CompareJson, CarriesScoresPerLegAndLayer) {
  auto comparison = compare_with_truth(biased_series(), nullptr, nullptr, steady_truth());
  comparison.file = "truth.csv";
  const auto json = nlohmann::json::parse(comparison_json(comparison, "a.mcap", 1));
  EXPECT_EQ(json["schema"], "quadsonde.compare/1");
  EXPECT_DOUBLE_EQ(json["references"][0]["samples"]["rmsve_m_s"], 0.5);
  EXPECT_EQ(json["references"][0]["file"], "truth.csv");
}

}  // namespace
}  // namespace quadsonde::product
