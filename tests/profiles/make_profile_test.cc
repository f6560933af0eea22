#include "profiles/make_profile.h"

#include <gtest/gtest.h>

#include "tests/estimator/smoother/made_flights.h"
#include "tests/profiles/made_series.h"

namespace quadsonde::profiles {
namespace {

using estimator::NoEstimate;
using estimator::Reason;
using estimator::WindEstimate;

const Eigen::Vector2d breeze(3, 1);

WindProfile profile_of(const estimator::WindSeries& series, ProfileSettings settings = {}) {
  auto profile = make_profile(series, settings);
  if (!profile) throw std::runtime_error(to_string(profile.error()));
  return *profile;
}
const WindEstimate* wind(const Bin& bin) { return std::get_if<WindEstimate>(&bin.wind); }

TEST(Profile, WritesUpThenDownThenAllWithTheSameBins) {
  const auto p = profile_of(SeriesMaker().climb(42, 2, breeze).climb(0, 2, -breeze).series);
  ASSERT_EQ(p.legs.size(), 3u);
  EXPECT_EQ(p.legs[0].name, LegName::up);
  EXPECT_EQ(p.legs[1].name, LegName::down);
  EXPECT_EQ(p.legs[2].name, LegName::all);
  for (const auto& leg : p.legs) {
    ASSERT_EQ(leg.bins.size(), 5u);
    for (std::size_t b = 0; b < 5; ++b) {
      EXPECT_EQ(leg.bins[b].bottom, 10.0 * static_cast<double>(b));
      EXPECT_EQ(leg.bins[b].top, 10.0 * static_cast<double>(b) + 10);
    }
  }
  ASSERT_TRUE(wind(p.legs[0].bins[1]) && wind(p.legs[1].bins[1]));
  EXPECT_LT((wind(p.legs[0].bins[1])->v_NA_N - breeze).norm(), 1e-12);
  EXPECT_LT((wind(p.legs[1].bins[1])->v_NA_N + breeze).norm(), 1e-12);
  EXPECT_LT(wind(p.legs[2].bins[1])->v_NA_N.norm(), 0.5) << "`all` holds both";
  EXPECT_EQ(p.legs[2].bins[1].samples, p.legs[0].bins[1].samples + p.legs[1].bins[1].samples);
}

ProfileSettings bins_of(double bin_m, Datum datum) {
  ProfileSettings settings;
  settings.bin_m = bin_m;
  settings.datum = datum;
  return settings;
}

TEST(Profile, EdgesAreMultiplesOfTheBinInItsDatum) {
  auto maker = SeriesMaker().from(-7).climb(38, 2, breeze);
  auto p = profile_of(maker.series, bins_of(15, Datum::agl));
  ASSERT_EQ(p.legs.front().bins.size(), 4u);
  EXPECT_EQ(p.legs.front().bins[0].bottom, -15) << "a take-off point above the ground that follows";
  EXPECT_EQ(p.legs.front().bins[3].top, 45);
  p = profile_of(maker.series, bins_of(15, Datum::msl));
  EXPECT_EQ(p.datum, Datum::msl);
  EXPECT_EQ(p.legs.front().bins.front().bottom, 135) << "143 m is in the bin from 135 to 150";
  EXPECT_EQ(p.legs.front().bins.back().top, 195);
}

TEST(Profile, PutsAHeightOnAnEdgeIntoTheBinAboveIt) {
  SeriesMaker maker;
  for (int i = 0; i < 50; ++i) maker.push(20, 0, breeze);
  const auto p = profile_of(maker.series);
  ASSERT_EQ(p.legs.size(), 1u);
  ASSERT_EQ(p.legs[0].bins.size(), 1u);
  EXPECT_EQ(p.legs[0].bins[0].bottom, 20);
}

TEST(Profile, EmptyBinsAreRowsThatSaySo) {
  auto maker = SeriesMaker().from(5).stay(30, breeze).from(45).stay(30, breeze);
  auto p = profile_of(maker.series);
  const auto& bins = p.legs.back().bins;
  ASSERT_EQ(bins.size(), 5u);
  for (std::size_t b : {1, 2, 3}) {
    ASSERT_FALSE(wind(bins[b])) << "never a zero";
    EXPECT_EQ(std::get<NoEstimate>(bins[b].wind).reason, Reason::no_samples);
    EXPECT_EQ(bins[b].quality, Quality::none);
    EXPECT_TRUE(bins[b].reasons.has(Reason::no_samples));
    EXPECT_EQ(bins[b].samples, 0u);
    EXPECT_DOUBLE_EQ(bins[b].height_agl->m, 10.0 * static_cast<double>(b) + 5);
    EXPECT_FALSE(bins[b].height_msl || bins[b].utc || bins[b].place || bins[b].sd_sampling || bins[b].spread_from_deg);
  }
  EXPECT_TRUE(wind(bins[0]) && wind(bins[4]));
}

TEST(Profile, OfAFlightWithoutAClimbHasAllOnly) {
  EXPECT_EQ(profile_of(SeriesMaker().from(30).stay(60, breeze).series).legs.size(), 1u);
  const auto p = profile_of(SeriesMaker().from(30).climb(34, 1, breeze).climb(30, 1, breeze).stay(20, breeze).series);
  ASSERT_EQ(p.legs.size(), 1u) << "4 m are no climb where a bin has 10";
  EXPECT_EQ(p.legs[0].name, LegName::all);
  EXPECT_FALSE(p.up_down);
}

TEST(Profile, OfAFlightThatNeverClimbsSaysSoAndWhatWouldBeAProfile) {
  auto p = profile_of(SeriesMaker().from(30).stay(60, breeze).series);
  ASSERT_EQ(p.notes.size(), 1u);
  EXPECT_NE(p.notes[0].what.find("stays near 30 m"), std::string::npos) << p.notes[0].what;
  EXPECT_NE(p.notes[0].hint.find("climb 100 m"), std::string::npos);
  EXPECT_TRUE(p.flown.empty());
  EXPECT_EQ(p.legs.back().bins.size(), 1u) << "no bin is invented";
  EXPECT_TRUE(profile_of(SeriesMaker().climb(42, 2, breeze).series).notes.empty());
}

TEST(Profile, OfAClimbOfFiveMetresNamesTheSmallerBinsThatWouldDo) {
  const auto flight = SeriesMaker().from(3).climb(8, 1, breeze).stay(20, breeze).climb(3, 1, breeze).series;
  const auto p = profile_of(flight);
  ASSERT_EQ(p.notes.size(), 1u);
  EXPECT_NE(p.notes[0].what.find("stays between 3 and 8 m"), std::string::npos) << p.notes[0].what;
  EXPECT_NE(p.notes[0].hint.find("--bin-m 2"), std::string::npos) << p.notes[0].hint;
  ASSERT_EQ(p.legs.size(), 1u);
  ASSERT_EQ(p.legs[0].bins.size(), 1u);
  EXPECT_NEAR(p.legs[0].bins[0].height_agl->m, 7, 1) << "the height that was flown, not the bin's middle";
  const auto fine = profile_of(flight, bins_of(2, Datum::agl));
  EXPECT_EQ(fine.legs.size(), 3u);
  EXPECT_TRUE(fine.notes.empty()) << "what the hint says is true";
}

TEST(Profile, KeepsEachAscentAndDescentApartToo) {
  const auto p = profile_of(SeriesMaker().climb(42, 2, breeze).climb(0, 2, -breeze).climb(42, 2, 2 * breeze).series);
  ASSERT_EQ(p.flown.size(), 3u);
  EXPECT_LT((wind(p.flown[2].bins[1])->v_NA_N - 2 * breeze).norm(), 1e-12);
  EXPECT_EQ(p.flown[0].bins[1].samples + p.flown[2].bins[1].samples, p.legs[0].bins[1].samples);
  EXPECT_EQ(p.flown[1].bins[1].samples, p.legs[1].bins[1].samples);
}

TEST(Profile, PausesOfAClimbCountInItsLeg) {
  auto maker = SeriesMaker().climb(25, 1, breeze).stay(30, breeze).climb(50, 1, breeze);
  const auto p = profile_of(maker.series);
  ASSERT_EQ(p.legs.size(), 3u);
  EXPECT_NEAR(static_cast<double>(p.legs[0].bins[2].samples), 400, 2) << "10 s of climb and 30 s of pause";
  EXPECT_EQ(p.legs[1].bins[2].samples, 0u);
}

TEST(Profile, FallsBackToSeaLevelAndSaysSo) {
  auto maker = SeriesMaker().climb(42, 2, breeze);
  for (auto& point : maker.series.points) point.height_agl.reset();
  const auto p = profile_of(maker.series);
  EXPECT_EQ(p.datum, Datum::msl);
  ASSERT_EQ(p.problems.size(), 1u);
  EXPECT_EQ(p.problems[0].kind, ingest::Kind::missing);
  EXPECT_NE(p.problems[0].hint.find("--takeoff-msl"), std::string::npos);
  EXPECT_EQ(p.legs[0].bins.front().bottom, 150);
  EXPECT_FALSE(p.legs[0].bins.front().height_agl) << "still not known";
}

TEST(Profile, OfAFlightWithoutAnyHeightIsRefused) {
  auto maker = SeriesMaker().climb(42, 2, breeze);
  for (auto& point : maker.series.points) point.height_agl.reset(), point.height_msl.reset();
  const auto p = make_profile(maker.series);
  ASSERT_FALSE(p);
  EXPECT_EQ(p.error().kind, ingest::Kind::missing);
}

TEST(Profile, WithoutASingleWindIsNoAnswer) {
  auto maker = SeriesMaker().climb(42, 2, breeze);
  for (auto& point : maker.series.points) point.wind = NoEstimate{Reason::converging};
  const auto p = make_profile(maker.series);
  ASSERT_FALSE(p);
  EXPECT_EQ(p.error().kind, ingest::Kind::no_answer);
}

TEST(Profile, DoesNotAverageAFastDescentInSilently) {
  auto maker = SeriesMaker().climb(42, 2, breeze);
  const std::size_t top = maker.series.points.size();
  maker.climb(0, 4, Eigen::Vector2d(1, 0));
  for (std::size_t i = top; i < maker.series.points.size(); ++i) {
    maker.series.points[i].quality = estimator::Quality::doubtful;
    maker.series.points[i].reasons.add(Reason::fast_descent);
  }
  const auto p = profile_of(maker.series);
  ASSERT_EQ(p.legs.size(), 3u);
  for (std::size_t b = 0; b < 4; ++b) {
    EXPECT_EQ(p.legs[1].bins[b].quality, estimator::Quality::doubtful);
    EXPECT_TRUE(p.legs[1].bins[b].reasons.has(Reason::fast_descent));
    EXPECT_LT((wind(p.legs[2].bins[b])->v_NA_N - breeze).norm(), 1e-12) << "`all` is the ascent's";
    EXPECT_EQ(p.legs[2].bins[b].samples, p.legs[0].bins[b].samples);
  }
}

TEST(Profile, GivesADoubtfulValueWhereThereIsNoBetterOne) {
  auto maker = SeriesMaker().from(42).climb(0, 4, breeze);
  for (auto& point : maker.series.points)
    point.quality = estimator::Quality::doubtful, point.reasons.add(Reason::fast_descent);
  const auto p = profile_of(maker.series);
  ASSERT_TRUE(wind(p.legs.back().bins[2]));
  EXPECT_EQ(p.legs.back().bins[2].quality, estimator::Quality::doubtful);
  EXPECT_TRUE(p.legs.back().bins[2].reasons.has(Reason::fast_descent));
}

TEST(Profile, ABinOfFewSamplesIsDoubtful) {
  SeriesMaker maker;
  maker.from(15).stay(30, breeze);
  for (int i = 0; i < 9; ++i) maker.push(25, 0, breeze);
  const auto p = profile_of(maker.series);
  ASSERT_EQ(p.legs.back().bins.size(), 2u);
  EXPECT_EQ(p.legs.back().bins[0].quality, estimator::Quality::good);
  EXPECT_EQ(p.legs.back().bins[1].quality, estimator::Quality::doubtful);
  EXPECT_TRUE(p.legs.back().bins[1].reasons.has(Reason::few_samples));
}

Eigen::Vector2d toward(double deg) {
  return 4 * Eigen::Vector2d(std::cos(deg * M_PI / 180), std::sin(deg * M_PI / 180));
}

TEST(Profile, SpreadOfTheDirectionIsYamartinos) {
  SeriesMaker maker;
  maker.from(15);
  for (int i = 0; i < 100; ++i) maker.push(15, 0, toward(i % 2 ? 340 : 40));  // 10 +- 30 degrees, across north
  const auto bin = profile_of(maker.series).legs.back().bins[0];
  // epsilon = sin 30 degrees = .5: 30 (1 + .1547 .125) degrees.
  ASSERT_TRUE(bin.spread_from_deg);
  EXPECT_NEAR(*bin.spread_from_deg, 30 * (1 + 0.1547 * 0.125), 1e-9);
  EXPECT_NEAR(*to_report(*wind(bin)).from_deg, 190, 1e-9) << "from the mean vector, not the mean of angles";
}

TEST(Profile, DirectionIsEmptyInALightWindAnd360FromTheNorth) {
  const auto from = [](const Eigen::Vector2d& w) {
    return to_report(*wind(profile_of(SeriesMaker().from(15).stay(30, w).series).legs.back().bins[0])).from_deg;
  };
  EXPECT_FALSE(from({0.39, 0})) << "sd 0.2 m/s, made without a trace: the samples' errors are one";
  EXPECT_TRUE(from({0.41, 0}));
  ASSERT_TRUE(from({-4, 0}));
  EXPECT_DOUBLE_EQ(*from({-4, 0}), 360);
}

TEST(Profile, MeansPlaceAndTimeOverTheBinsSamples) {
  auto maker = SeriesMaker().from(15).stay(30, breeze);
  const std::int64_t start = 1'795'435'200'000'000'000;
  for (auto& point : maker.series.points)
    point.utc = ingest::UtcTime{start + point.time.ns}, point.place = ingest::GeoPoint{43, 1};
  const auto bin = profile_of(maker.series).legs.back().bins[0];
  EXPECT_NEAR(static_cast<double>(bin.utc->ns - start) * 1e-9, 14.95, 1e-6);
  EXPECT_DOUBLE_EQ(bin.place->lat_deg, 43);
  EXPECT_DOUBLE_EQ(bin.height_agl->m, 15);
  EXPECT_DOUBLE_EQ(bin.height_msl->m, 165);
}

TEST(Profile, OfASimulatedAscentHoldsTheTruthInItsIntervals) {
  int inside = 0, bins = 0;
  double sum = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    auto s = estimator::hover(1);
    s.seed = seed;
    s.wind.model = ingest::WindField::Model::jet;
    s.path[0].kind = ingest::PathLeg::Kind::climb;
    s.path[0].speed = 1.5;
    s.path[0].to_height = 150;
    auto down = s.path[0];
    down.to_height = 10;
    s.path.push_back(down);
    const auto flown = *ingest::simulate(s);
    estimator::EstimateSettings settings;
    settings.takeoff = s.site.height;
    settings.estimate_climb_law = false;
    const auto series = estimator::estimated(flown, settings);
    const auto p = profile_of(series);
    ASSERT_EQ(p.legs.size(), 3u);
    ASSERT_TRUE(p.up_down);
    // The truth of a bin: mean over the same samples' true winds, by leg and height as estimated.
    for (const auto leg : {0, 1})
      for (const auto& bin : p.legs[static_cast<std::size_t>(leg)].bins) {
        if (bin.samples < 50) continue;
        Eigen::Vector2d truth = Eigen::Vector2d::Zero();
        double n = 0;
        for (std::size_t i = 0; i < series.points.size(); ++i) {
          const auto& point = series.points[i];
          const bool here = point.height_agl->m >= bin.bottom && point.height_agl->m < bin.top;
          const bool first_half = i < series.points.size() / 2;
          if (here && first_half == (leg == 0)) truth += flown.truth[i].v_NA_N.head<2>(), n += 1;
        }
        const Eigen::Vector2d e = wind(bin)->v_NA_N - truth / n;
        for (int i = 0; i < 2; ++i) inside += std::abs(e(i)) <= 1.96 * std::sqrt(wind(bin)->covariance(i, i)), ++bins;
        sum += e.squaredNorm();
        EXPECT_TRUE(bin.sd_sampling && bin.sd_trim && bin.sd_calibration && bin.effective_samples);
      }
  }
  ASSERT_GT(bins, 140);
  // 95 % intervals, with one effective component for two (neighbours share their trim): 3 sd below.
  EXPECT_GT(inside, (0.95 - 3 * std::sqrt(0.95 * 0.05 / (bins / 2.0))) * bins);
  EXPECT_LT(std::sqrt(sum / bins), 0.12) << "twice the gate's 0.06 m/s of a 1 m/s ascent";
}

}  // namespace
}  // namespace quadsonde::profiles
