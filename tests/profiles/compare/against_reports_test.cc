#include "profiles/compare/against_reports.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ingest/reference/metar.h"
#include "tests/export/made_up.h"
#include "tests/support/data.h"

namespace quadsonde::profiles {
namespace {

using ingest::knot;
using ingest::parse_iso8601;
using ingest::ReferenceWind;
using support::estimate_of;
using support::point_at;
using testing::HasSubstr;

/// Of point_at's clock: 2025-06-15T15:06:40Z is time 0.
const ingest::UtcTime start{1'750'000'000'000'000'000};

/// From 2 to 62 m and back within two minutes: 5 m/s from 250 degrees below 15 m, 9 m/s from 280 above.
estimator::WindSeries ascent() {
  estimator::WindSeries series;
  for (int i = 0; i <= 240; ++i) {
    const double t = 0.5 * i, h = 2 + (i <= 120 ? t : 120 - t);
    series.points.push_back(point_at(t, h, h <= 15 ? estimate_of(5, 250) : estimate_of(9, 280)));
  }
  series.diagnostics.sigma_u = 0.5;
  return series;
}

ingest::Reference reports(const std::vector<std::string>& metars) {
  ingest::Reference reference{"METAR", "metar.txt", {}, {}};
  for (const auto& text : metars) {
    const auto wind = ingest::parse_metar(text, start);
    EXPECT_TRUE(wind) << text;
    reference.records.push_back(wind.value_or(ReferenceWind{}));
  }
  return reference;
}

TEST(AgainstReports, TakesTheWindNearestToTenMetresInTheReportsTenMinutes) {
  const auto s = score_against_reports(ascent(), reports({"LFBO 151510Z 25010KT 9999"}));
  ASSERT_EQ(s.pairs.size(), 1u);
  const auto& m = s.pairs[0];
  EXPECT_NEAR(m.height.m, 10, 0.3) << "5 to 15 m";
  EXPECT_EQ(m.gap_s, 0);
  EXPECT_NEAR(s.scores.speed.bias, 5 - 10 * knot, 1e-9);
  EXPECT_NEAR(s.scores.direction.bias, 0, 1e-9);
  EXPECT_NEAR(s.scores.rmsve, 10 * knot - 5, 1e-9);
  EXPECT_FALSE(m.distance_m) << "a METAR names no place";
  EXPECT_FALSE(s.no_score);
}

TEST(AgainstReports, SaysTheHeightWhereNoneNearTenMetresWasFlown) {
  auto series = ascent();
  for (auto& p : series.points) p.height_agl->m += 40;
  const auto s = score_against_reports(series, reports({"LFBO 151510Z 28018KT"}));
  ASSERT_EQ(s.pairs.size(), 1u);
  EXPECT_NEAR(s.pairs[0].height.m, 44.5, 0.6) << "the lowest five metres flown";
}

TEST(AgainstReports, VariableWindScoresItsSpeedAndCalmItsComponents) {
  const auto variable = score_against_reports(ascent(), reports({"LFBO 151510Z VRB03KT"}));
  EXPECT_NEAR(variable.scores.speed.bias, 5 - 3 * knot, 1e-9);
  EXPECT_EQ(variable.scores.east.n, 0u);
  EXPECT_EQ(variable.scores.n_no_direction, 1u);
  const auto calm = score_against_reports(ascent(), reports({"LFBO 151510Z 00000KT"}));
  EXPECT_NEAR(calm.scores.speed.bias, 5, 1e-9);
  EXPECT_EQ(calm.scores.east.n, 1u);
  EXPECT_NEAR(calm.scores.rmsve, 5, 1e-9);
  EXPECT_EQ(calm.scores.direction.n, 0u);
}

TEST(AgainstReports, KeepsGustsApartAndReadsMetresPerSecond) {
  const auto s = score_against_reports(ascent(), reports({"UUEE 151510Z 25005G12MPS"}));
  EXPECT_NEAR(s.scores.speed.bias, 0, 1e-9);
  EXPECT_EQ(s.pairs[0].report.gust, 12);
}

TEST(AgainstReports, ExpectsTheSumOfOursTurbulenceRoundingAndRepresentativeness) {
  CompareSettings settings;
  settings.representativeness_m_s = 2;
  const auto s = score_against_reports(ascent(), reports({"LFBO 151510Z 27010KT"}), settings);
  ASSERT_TRUE(s.pairs.at(0).pair.covariance);
  const auto& C = *s.pairs[0].pair.covariance;
  // From the west: the speed is rounded along east (1 kt), the direction across it (10 degrees), both uniform.
  const double speed_variance = knot * knot / 12, across = 10 * knot * 10 / std::sqrt(12.0) * std::numbers::pi / 180;
  const auto& ours = s.pairs[0].wind.covariance;
  EXPECT_NEAR(C(1, 1), ours(1, 1) + speed_variance + 4, 1e-9);
  EXPECT_NEAR(C(0, 0), ours(0, 0) + across * across + 4, 1e-9);
  EXPECT_GT(ours(0, 0), 0.04) << "more than ours alone: turbulence of a short mean";
}

TEST(AgainstReports, RepresentativenessGrowsWithDistanceAndTime) {
  const auto sd_at = [](double lat_off, const char* time) {
    auto reference = reports({std::string("LFBO ") + time + " 25010KT"});
    if (lat_off > 0) reference.records[0].place = ingest::GeoPoint{43.5657 + lat_off, 1.4815};
    return score_against_reports(ascent(), reference).pairs.at(0).representativeness_m_s;
  };
  EXPECT_NEAR(sd_at(0.09, "151512Z"), 0.9, 0.1) << "10 km";
  EXPECT_GT(sd_at(0.3, "151512Z"), sd_at(0.09, "151512Z"));
  EXPECT_GT(sd_at(0.09, "151650Z"), sd_at(0.09, "151512Z"));
  EXPECT_GT(sd_at(0, "151650Z"), sd_at(0, "151512Z")) << "with the distance unknown, time alone";
}

TEST(AgainstReports, OutsideTheWindowTheNearestStandsInAndSaysSo) {
  const auto s = score_against_reports(ascent(), reports({"LFBO 151330Z 25010KT", "LFBO 151430Z 25010KT"}));
  EXPECT_TRUE(s.outside_window);
  ASSERT_EQ(s.pairs.size(), 1u);
  EXPECT_NEAR(s.pairs[0].gap_s, -(36 * 60 + 40), 1) << "14:30 to 15:06:40";
  const auto in = score_against_reports(ascent(), reports({"LFBO 151430Z 25010KT", "LFBO 151510Z 25010KT"}));
  EXPECT_FALSE(in.outside_window);
  EXPECT_EQ(in.pairs.size(), 1u);
}

TEST(AgainstReports, OfAnotherDayAreNotScoredAndTheGapIsSaid) {
  const auto s = score_against_reports(ascent(), reports({"LFBO 121510Z 25010KT"}));
  EXPECT_EQ(s.scores.n, 0u);
  ASSERT_TRUE(s.no_score);
  EXPECT_THAT(s.no_score->what, HasSubstr("3 days before"));
  EXPECT_THAT(s.no_score->what, HasSubstr("3 h"));
  EXPECT_FALSE(s.no_score->hint.empty());
  EXPECT_TRUE(score_against_reports(ascent(), reports({"LFBO 151820Z 25010KT"})).no_score) << "3 h 1 min after";
  EXPECT_FALSE(score_against_reports(ascent(), reports({"LFBO 151815Z 25010KT"})).no_score) << "2 h 56 min after";
}

TEST(AgainstReports, OfAnotherPlaceAreNotScoredAndTheDistanceIsSaid) {
  auto reference = reports({"LOWW 151510Z 25010KT"});
  ingest::place_records(reference, {48.11, 16.57}, {10});
  const auto s = score_against_reports(ascent(), reference);
  EXPECT_EQ(s.scores.n, 0u);
  ASSERT_TRUE(s.no_score);
  EXPECT_THAT(s.no_score->what, HasSubstr("1274 km"));
  EXPECT_THAT(s.no_score->what, HasSubstr("50 km"));
}

TEST(AgainstReports, NeedUtcAndAHeightAboveGroundAndHintAtBoth) {
  auto without_utc = ascent(), without_height = ascent();
  for (auto& p : without_utc.points) p.utc.reset();
  for (auto& p : without_height.points) p.height_agl.reset();
  const auto reference = reports({"LFBO 151510Z 25010KT"});
  EXPECT_THAT(score_against_reports(without_utc, reference).no_score->hint, HasSubstr("--start-utc"));
  EXPECT_THAT(score_against_reports(without_height, reference).no_score->hint, HasSubstr("--takeoff-msl"));
  EXPECT_TRUE(score_against_reports(estimator::WindSeries{}, reference).no_score);
}

TEST(AgainstReports, ATableOfRangesHasLayersOfItsHeights) {
  ingest::Reference table{"table", "t.csv", {}, {}};
  for (const double height : {10.0, 50.0}) {
    ReferenceWind wind;
    wind.utc = *parse_iso8601("2025-06-15T15:10:00Z");
    wind.speed_min = height < 20 ? 4 : 6, wind.speed_max = height < 20 ? 6 : 8;
    wind.from_deg = height < 20 ? 250 : 280;
    wind.height = ingest::GroundHeight{height};
    table.records.push_back(wind);
  }
  const auto s = score_against_reports(ascent(), table);
  ASSERT_EQ(s.layers.size(), 2u);
  EXPECT_EQ(s.layers[0].bottom, 10);
  EXPECT_EQ(s.layers[0].scores.speed.bias, 0) << "5 m/s lies in 4 to 6";
  EXPECT_NEAR(s.layers[1].scores.speed.bias, 1, 1e-9) << "9 m/s is 1 above 6 to 8";
  EXPECT_EQ(s.scores.n_in_range, 1u);
}

TEST(AgainstReports, AProfileIsMatchedWithItsBinOfTheLegAll) {
  const auto profile = support::made_up_profile();
  const auto s = score_against_reports(profile, reports({"LFBO 151515Z 25006KT"}));
  ASSERT_EQ(s.pairs.size(), 1u);
  EXPECT_NEAR(s.pairs[0].height.m, 15.1, 1e-9) << "its lowest bin";
  EXPECT_EQ(s.pairs[0].wind.v_NA_N, std::get<estimator::WindEstimate>(profile.legs[2].bins[0].wind).v_NA_N);
}

TEST(AgainstReports, OfTheSampleListMatchTheFlightOfTheirDay) {
  QUADSONDE_NEEDS_DATA("reference/metar_iem/metar_raw_list.txt");
  const auto bytes = support::read_bytes(support::data_file("reference/metar_iem/metar_raw_list.txt"));
  const auto list = ingest::read_reference(bytes, "metar_raw_list.txt", std::nullopt);
  ASSERT_TRUE(list);
  auto series = ascent();
  const auto shift = *parse_iso8601("2017-02-10T18:50:00Z") - start;
  for (auto& p : series.points) p.utc = *p.utc + shift;
  // The mean of 18:34 ended 16 min before the flight, that of 18:54 holds it; 19:34 begins half an hour later.
  CompareSettings settings;
  settings.match_window_s = 1200;
  const auto s = score_against_reports(series, *list, settings);
  ASSERT_EQ(s.pairs.size(), 2u);
  EXPECT_NEAR(*s.pairs[0].report.speed(), 8 * knot, 1e-9);
  EXPECT_NEAR(*s.pairs[0].report.gust, 13 * knot, 1e-9);
  EXPECT_EQ(s.pairs[1].report.from_deg, 280);
  EXPECT_NEAR(s.scores.speed.bias, 5 - 7.5 * knot, 1e-9);
}

}  // namespace
}  // namespace quadsonde::profiles
