// The wind over time and height.
#include "profiles/section.h"

#include <gtest/gtest.h>

#include "profiles/make_profile.h"
#include "tests/profiles/made_series.h"

namespace quadsonde::profiles {
namespace {

constexpr ingest::UtcTime t0{1'750'000'000'000'000'000};

/// Flown by hand, with UTC and a place.
WindProfile profile_of(SeriesMaker maker, double hours_later = 0, double lat = 43.5, double bin_m = 10) {
  for (auto& p : maker.series.points) {
    p.utc = t0 + ingest::seconds(3600 * hours_later) + (p.time - at(0));
    p.place = ingest::GeoPoint{lat, 1.5};
  }
  ProfileSettings settings;
  settings.bin_m = bin_m;
  auto profile = make_profile(maker.series, settings);
  if (!profile) throw std::runtime_error(to_string(profile.error()));
  return *profile;
}
SeriesMaker twice_up_and_down() {
  return SeriesMaker().climb(42, 2, {3, 1}).climb(0, 2, {3, 2}).climb(62, 2, {5, 1}).climb(0, 2, {5, 2});
}
const estimator::WindEstimate* wind(const SectionColumn& column, std::size_t bin) {
  return std::get_if<estimator::WindEstimate>(&column.leg.bins.at(bin).wind);
}

TEST(Section, HasAColumnForEachAscentAndDescentOfALog) {
  const auto profile = profile_of(twice_up_and_down());
  const auto section = make_section({{"a.ulg", &profile}});
  ASSERT_TRUE(section);
  ASSERT_EQ(section->columns.size(), 4u);
  const LegName names[] = {LegName::up, LegName::down, LegName::up, LegName::down};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(section->columns[i].leg.name, names[i]);
    EXPECT_EQ(section->columns[i].flight, "a.ulg");
    EXPECT_LT(section->columns[i].from, section->columns[i].to);
    ASSERT_TRUE(wind(section->columns[i], 1));
    EXPECT_LT((wind(section->columns[i], 1)->v_NA_N - Eigen::Vector2d(i < 2 ? 3 : 5, i % 2 ? 2 : 1)).norm(), 1e-9)
        << "its own wind, not that of both ascents";
    if (i) {
      EXPECT_LE(section->columns[i - 1].to, section->columns[i].from);
    }
  }
}

TEST(Section, LeavesEmptyWhatNoLegReached) {
  const auto profile = profile_of(twice_up_and_down());
  const auto section = make_section({{"a.ulg", &profile}});
  ASSERT_EQ(section->columns[0].leg.bins.size(), 7u);
  EXPECT_FALSE(wind(section->columns[0], 5)) << "the first ascent ended at 42 m";
  EXPECT_EQ(section->columns[0].leg.bins[5].quality, Quality::none);
  EXPECT_TRUE(section->columns[0].leg.bins[5].reasons.has(estimator::Reason::no_samples));
  EXPECT_TRUE(wind(section->columns[2], 5));
}

TEST(Section, PutsFlightsOfOneSiteInTheOrderOfTheirTimesOntoOneGrid) {
  const auto late = profile_of(SeriesMaker().climb(52, 2, {4, 0}), 2);
  const auto early = profile_of(SeriesMaker().from(20).stay(60, {2, 0}));
  const auto section = make_section({{"late.ulg", &late}, {"early.ulg", &early}});
  ASSERT_TRUE(section);
  ASSERT_EQ(section->columns.size(), 2u) << "a flight without a climb is one column";
  EXPECT_EQ(section->columns[0].flight, "early.ulg");
  EXPECT_EQ(section->columns[0].leg.name, LegName::all);
  for (const auto& column : section->columns) {
    ASSERT_EQ(column.leg.bins.size(), 6u);
    for (std::size_t b = 0; b < 6; ++b) EXPECT_EQ(column.leg.bins[b].bottom, 10.0 * static_cast<double>(b));
  }
  EXPECT_TRUE(wind(section->columns[0], 2));
  EXPECT_FALSE(wind(section->columns[0], 3));
}

TEST(Section, RefusesTwoSitesOtherBinsAndFlightsWithoutUtc) {
  const auto here = profile_of(twice_up_and_down()), there = profile_of(twice_up_and_down(), 1, 44.5),
             coarse = profile_of(twice_up_and_down(), 1, 43.5, 20);
  const auto two_sites = make_section({{"a", &here}, {"b", &there}});
  ASSERT_FALSE(two_sites);
  EXPECT_EQ(two_sites.error().kind, ingest::Kind::usage);
  EXPECT_NE(two_sites.error().what.find("111 km"), std::string::npos) << two_sites.error().what;
  EXPECT_FALSE(make_section({{"a", &here}, {"b", &coarse}}));
  auto untimed = *make_profile(twice_up_and_down().series);
  const auto no_utc = make_section({{"a", &untimed}});
  ASSERT_FALSE(no_utc);
  EXPECT_EQ(no_utc.error().kind, ingest::Kind::missing);
  EXPECT_NE(no_utc.error().hint.find("--start-utc"), std::string::npos);
  EXPECT_FALSE(make_section({}));
}

}  // namespace
}  // namespace quadsonde::profiles
