// What people ask of a profile next.
#include "profiles/levels.h"

#include <gtest/gtest.h>

#include <cmath>

namespace quadsonde::profiles {
namespace {

/// A leg of 10 m bins with a speed for each, blowing toward the east.
Leg leg_of(const std::vector<double>& speeds, double sd = 0.05) {
  Leg leg;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    Bin bin;
    bin.bottom = 10 * static_cast<double>(i);
    bin.top = bin.bottom + 10;
    bin.height_agl = ingest::GroundHeight{bin.bottom + 5};
    bin.wind = estimator::WindEstimate{{0, speeds[i]}, sd * sd * Eigen::Matrix2d::Identity(), true};
    bin.quality = Quality::good;
    leg.bins.push_back(bin);
  }
  return leg;
}

std::vector<double> by_height(std::size_t bins, const std::function<double(double)>& speed) {
  std::vector<double> all;
  for (std::size_t i = 0; i < bins; ++i) all.push_back(speed(10 * static_cast<double>(i) + 5));
  return all;
}

TEST(WindsAt, LieBetweenTheMiddlesOfTwoBinsAndNeverBeyondTheProfile) {
  const auto leg = leg_of({2, 3, 4});
  const auto winds = winds_at(leg, {10, 15, 29, 31});
  EXPECT_NEAR(winds[0].wind->v_NA_N.y(), 2.5, 1e-12);
  EXPECT_NEAR(winds[1].wind->v_NA_N.y(), 3, 1e-12);
  EXPECT_NEAR(winds[2].wind->v_NA_N.y(), 4, 1e-12);  // above the last middle: that bin's, not extrapolated
  EXPECT_FALSE(winds[3].wind);
}

TEST(WindsAt, AreEmptyInAnEmptyOrBadBin) {
  auto leg = leg_of({2, 3, 4});
  leg.bins[1].wind = estimator::NoEstimate{};
  leg.bins[2].quality = Quality::bad;
  const auto winds = winds_at(leg, {8, 15, 25});
  EXPECT_NEAR(winds[0].wind->v_NA_N.y(), 2, 1e-12);  // no neighbour to lean on
  EXPECT_FALSE(winds[1].wind);
  EXPECT_FALSE(winds[2].wind);
}

TEST(ShearBetween, IsTheVectorDifferenceAndTheTurn) {
  LevelWind low{10, estimator::WindEstimate{{0, 4}, 0.01 * Eigen::Matrix2d::Identity(), true}};   // from the west
  LevelWind high{50, estimator::WindEstimate{{-3, 0}, 0.01 * Eigen::Matrix2d::Identity(), true}};  // from the north
  const auto shear = shear_between(low, high);
  EXPECT_NEAR(shear->shear.value, 5.0 / 40, 1e-12);
  EXPECT_NEAR(shear->shear.sd, std::sqrt(0.02) / 40, 1e-9);
  EXPECT_NEAR(shear->veer->value, 90, 1e-9);  // 270 to 360: clockwise, veering
}

TEST(PowerLaw, FindsTheExponentOfAPowerLaw) {
  const auto law = power_law(leg_of(by_height(12, [](double z) { return 4 * std::pow(z / 10, 0.2); })));
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->exponent.value, 0.2, 1e-9);
  EXPECT_NEAR(law->speed_10m.value, 4, 1e-9);
  EXPECT_GT(law->exponent.sd, 0);
}

TEST(LogLaw, FindsRoughnessAndFrictionVelocity) {
  const auto law = log_law(leg_of(by_height(9, [](double z) { return 0.3 / 0.4 * std::log(z / 0.03); })));
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->friction_velocity.value, 0.3, 1e-9);
  EXPECT_NEAR(law->roughness, 0.03, 1e-9);
}

TEST(Laws, AreEmptyWhereTheProfileCannotTell) {
  EXPECT_FALSE(power_law(leg_of({3, 4})));
  EXPECT_FALSE(log_law(leg_of({5, 4, 3, 2})));
}

TEST(LowLevelJet, IsFoundWithItsHeightAndHowSure) {
  const auto jet_at = [](double z) { return 3 + 6 * std::exp(-std::pow((z - 120) / 40, 2)); };
  const auto jet = low_level_jet(leg_of(by_height(25, jet_at), 0.3));
  ASSERT_TRUE(jet);
  EXPECT_NEAR(jet->height, 120, 10);
  EXPECT_NEAR(jet->speed.value, 9, 0.2);
  EXPECT_GT(jet->probability, 0.95);
  EXPECT_FALSE(low_level_jet(leg_of(by_height(25, [](double z) { return 3 + z / 50; }))));
  // A metre per second of bulge is no jet.
  EXPECT_FALSE(low_level_jet(leg_of(by_height(25, [](double z) { return 8 + std::exp(-std::pow((z - 120) / 40, 2)); }))));
}

TEST(BulkRichardson, FollowsItsDefinition) {
  auto leg = leg_of({2, 3, 4, 5, 6});
  // Isothermal at 288.15 K over 40 m: d theta / dz is about g / c_p = .00976 K/m.
  for (auto& bin : leg.bins) {
    bin.temperature_k = 288.15;
    bin.pressure_pa = 101325 * std::exp(-(bin.bottom + 5) / 8434.0);
  }
  const auto ri = bulk_richardson(leg);
  ASSERT_TRUE(ri);
  EXPECT_NEAR(ri->number.value, 9.80665 / 288.15 * 0.00976 / std::pow(0.1, 2), 0.01);
  leg.bins.back().temperature_k = std::nullopt;
  leg.bins[3].temperature_k = leg.bins[2].temperature_k = leg.bins[1].temperature_k = std::nullopt;
  EXPECT_FALSE(bulk_richardson(leg));
}

TEST(DescribeLevels, TellsTheWindAtTheHubHeightBesideTheUsualOnes) {
  WindProfile profile;
  profile.legs = {leg_of(by_height(12, [](double z) { return z / 20; }))};
  EXPECT_EQ(describe_levels(profile).winds.size(), 3u);
  profile.hub_height = 80;
  const auto winds = describe_levels(profile).winds;
  ASSERT_EQ(winds.size(), 4u);
  EXPECT_EQ(winds[2].height, 80);
  EXPECT_NEAR(winds[2].wind->v_NA_N.y(), 4, 1e-12);
  EXPECT_NEAR(winds[3].wind->v_NA_N.y(), 5, 1e-12);
  profile.hub_height = 50;
  EXPECT_EQ(describe_levels(profile).winds.size(), 3u) << "once is enough";
  profile.hub_height = 300;
  EXPECT_FALSE(describe_levels(profile).winds.back().wind) << "never extrapolated";
}

TEST(DescribeLevels, OfBinsAboveTheSeaAreStillAboveTakeOff) {
  WindProfile profile;
  profile.legs = {leg_of(by_height(12, [](double z) { return z / 20; }))};
  profile.datum = Datum::msl;
  EXPECT_TRUE(describe_levels(profile).winds.empty()) << "where the take-off point lies is not known";
  for (auto& bin : profile.legs[0].bins) {
    bin.height_msl = ingest::MslHeight{bin.height_agl->m + 500};
    bin.bottom += 500, bin.top += 500;
  }
  const auto winds = describe_levels(profile).winds;
  ASSERT_EQ(winds.size(), 3u);
  EXPECT_EQ(winds[1].height, 50);
  EXPECT_NEAR(winds[1].wind->v_NA_N.y(), 2.5, 1e-12);
}

/// The made-up leg with a drag known to 20 %, which all heights share, beside a noise of 0.05 m/s.
Leg with_shared_drag(Leg leg) {
  for (auto& bin : leg.bins) {
    auto& wind = std::get<estimator::WindEstimate>(bin.wind);
    const double along = 0.2 * wind.v_NA_N.norm();
    wind.covariance(1, 1) += along * along;
    bin.sd_calibration = along / std::sqrt(2.0);
  }
  return leg;
}

TEST(Shear, ThatTheDragScalesAtAllHeightsAlikeIsNoIndependentError) {
  const auto leg = with_shared_drag(leg_of(by_height(12, [](double z) { return 4 + z / 20; })));
  const auto winds = winds_at(leg, {15, 95});
  EXPECT_NEAR(winds[0].shared, 0.2, 1e-6);
  const auto shear = shear_between(winds[0], winds[1]);
  ASSERT_TRUE(shear);
  EXPECT_NEAR(shear->shear.value, 0.05, 1e-9);
  EXPECT_NEAR(shear->shear.sd, std::hypot(std::sqrt(2.0) * 0.05, 0.2 * 4) / 80, 2e-4)
      << "20 % of the shear and the noise of both, not 20 % of both winds";
}

TEST(PowerLaw, ItsExponentDoesNotHangOnTheDragButTheSpeedDoes) {
  const auto plain = leg_of(by_height(12, [](double z) { return 5 * std::pow(z / 10, 0.2); }));
  const auto exact = power_law(plain), open = power_law(with_shared_drag(plain));
  ASSERT_TRUE(exact && open);
  EXPECT_NEAR(open->exponent.value, 0.2, 1e-6);
  EXPECT_LT(open->exponent.sd, 3 * exact->exponent.sd);
  EXPECT_NEAR(open->speed_10m.sd, 0.2 * 5, 0.05);
}

}  // namespace
}  // namespace quadsonde::profiles
