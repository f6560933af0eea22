// Several flights to one profile.
#include "profiles/merge.h"

#include <gtest/gtest.h>

#include "ingest/motion/random.h"

namespace quadsonde::profiles {
namespace {

WindProfile flight(const std::vector<Eigen::Vector2d>& winds, double sd, double lat = 43.5, int first = 0) {
  WindProfile profile;
  Leg leg{LegName::all, {}};
  for (std::size_t i = 0; i < winds.size(); ++i) {
    Bin bin;
    bin.bottom = 10 * (static_cast<double>(i) + first);
    bin.top = bin.bottom + 10;
    bin.wind = estimator::WindEstimate{winds[i], sd * sd * Eigen::Matrix2d::Identity(), true};
    bin.quality = Quality::good;
    bin.samples = 100;
    bin.place = ingest::GeoPoint{lat, 1.5};
    leg.bins.push_back(bin);
  }
  profile.legs.push_back(leg);
  return profile;
}

const estimator::WindEstimate& wind(const MergedProfile& merged, std::size_t i) {
  return std::get<estimator::WindEstimate>(merged.profile.legs.at(0).bins.at(i).wind);
}

TEST(Merging, WeighsFlightsByTheirCovariance) {
  const auto sure = flight({{4, 0}}, 0.1), unsure = flight({{4.3, 0}}, 0.2);
  const auto merged = merge_profiles({&sure, &unsure});
  ASSERT_TRUE(merged);
  EXPECT_NEAR(wind(*merged, 0).v_NA_N.x(), (4 / 0.01 + 4.3 / 0.04) / (1 / 0.01 + 1 / 0.04), 1e-12);
  EXPECT_NEAR(wind(*merged, 0).covariance(0, 0), 1 / (1 / 0.01 + 1 / 0.04), 1e-12);
}

TEST(Merging, DoesNotDivideTheCalibrationThatAllFlightsShare) {
  auto a = flight({{4, 0}}, 0.2), b = a;
  a.legs[0].bins[0].sd_calibration = b.legs[0].bins[0].sd_calibration = 0.14;
  const auto merged = merge_profiles({&a, &b});
  // Noise .04 - .0392 along the wind is halved, .0392 stays: the mean has half of it, the other half is added.
  EXPECT_NEAR(wind(*merged, 0).covariance(0, 0), 0.04 / 2 + 0.0392 / 2, 1e-9);
  EXPECT_NEAR(wind(*merged, 0).covariance(1, 1), 0.04 / 2, 1e-9);
}

TEST(Merging, KeepsTheGapBetweenTwoFlightsAsEmptyRows) {
  const auto low = flight({{4, 0}}, 0.1), high = flight({{5, 0}}, 0.1, 43.5, 3);
  const auto merged = merge_profiles({&low, &high});
  ASSERT_TRUE(merged);
  const auto& bins = merged->profile.legs[0].bins;
  ASSERT_EQ(bins.size(), 4u);
  EXPECT_TRUE(std::holds_alternative<estimator::NoEstimate>(bins[1].wind));
  EXPECT_EQ(bins[1].quality, Quality::none);
  EXPECT_EQ(bins[1].samples, 0u);
}

TEST(Merging, TellsHonestFlightsFromThoseThatClaimTooMuch) {
  ingest::Gaussian noise(3);
  const auto drawn = [&](double scatter, double claimed) {
    std::vector<Eigen::Vector2d> winds;
    for (int i = 0; i < 20; ++i) winds.push_back({5 + scatter * noise(), scatter * noise()});
    return flight(winds, claimed);
  };
  const auto a = drawn(0.3, 0.3), b = drawn(0.3, 0.3), c = drawn(0.3, 0.3);
  const auto honest = merge_profiles({&a, &b, &c});
  EXPECT_EQ(honest->spread.degrees_of_freedom, 80);
  EXPECT_GT(honest->spread.p_value, 0.01);
  EXPECT_TRUE(honest->profile.problems.empty());
  const auto d = drawn(0.9, 0.3), e = drawn(0.9, 0.3);
  const auto vain = merge_profiles({&d, &e});
  EXPECT_LT(vain->spread.p_value, 1e-6);
  EXPECT_FALSE(vain->profile.problems.empty());
}

TEST(Merging, WidensABinInWhichFlightsContradictEachOther) {
  const auto a = flight({{4, 0}}, 0.1), b = flight({{6, 0}}, 0.1);
  const auto merged = merge_profiles({&a, &b});
  EXPECT_EQ(merged->profile.legs[0].bins[0].quality, Quality::doubtful);
  EXPECT_GT(std::sqrt(wind(*merged, 0).covariance(0, 0)), 0.5);
}

TEST(Merging, RefusesTwoSitesOtherBinsAndASingleFlight) {
  const auto here = flight({{4, 0}}, 0.1), there = flight({{4, 0}}, 0.1, 43.8);
  EXPECT_EQ(merge_profiles({&here, &there}).error().kind, ingest::Kind::usage);
  EXPECT_NE(merge_profiles({&here, &there}).error().what.find("33 km"), std::string::npos);
  auto coarse = here;
  coarse.bin_m = 20;
  EXPECT_FALSE(merge_profiles({&here, &coarse}));
  EXPECT_FALSE(merge_profiles({&here}));
}

}  // namespace
}  // namespace quadsonde::profiles
