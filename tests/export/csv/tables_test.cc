#include "export/csv/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "export/csv/numbers.h"
#include "tests/export/made_up.h"

namespace quadsonde::product {
namespace {

using estimator::NoEstimate;
using estimator::Quality;
using estimator::Reason;
using support::estimate_of;
using support::point_at;
using testing::HasSubstr;
using testing::Not;

estimator::WindSeries two_points() {
  estimator::WindSeries series;
  series.points = {point_at(12.5, 30, NoEstimate{Reason::converging}), point_at(12.6, 30, estimate_of(5, 270, 0.5))};
  series.points[0].reasons.add(Reason::converging);
  return series;
}

TEST(WindCsv, HasTheColumnsOfTheContractAndOneRowPerStep) {
  EXPECT_EQ(wind_csv(two_points()),
            "time_s,utc,lat_deg,lon_deg,height_msl_m,height_agl_m,wind_east_m_s,wind_north_m_s,sd_wind_east_m_s,"
            "sd_wind_north_m_s,cov_wind_east_north_m2_s2,wind_speed_m_s,wind_from_deg,quality,mode,"
            "wind_up_m_s,sd_wind_up_m_s,drag_factor,sd_drag_factor,drag_updated\n"
            "12.500000,2025-06-15T15:06:52.500Z,43.5657000,1.4815000,180.00,30.00,,,,,,,,none,smoothed,,,,,\n"
            "12.600000,2025-06-15T15:06:52.600Z,43.5657000,1.4815000,180.00,30.00,5.0000,0.0000,0.5000,0.5000,0.025000,"
            "5.0000,270.00,good,smoothed,,,,,\n");
}

TEST(WindCsv, LeavesEmptyWhatIsNotKnown) {
  estimator::WindSeries series;
  series.mode = estimator::Mode::classic;
  estimator::WindPoint p;
  p.wind = estimate_of(3, 360);
  std::get<estimator::WindEstimate>(p.wind).has_covariance = false;
  p.quality = Quality::doubtful;
  series.points = {p};
  EXPECT_THAT(wind_csv(series), HasSubstr("\n0.000000,,,,,,0.0000,-3.0000,,,,3.0000,360.00,doubtful,classic,,,,,\n"));
}

TEST(WindCsv, GivesVerticalWindAndDragFactorWhereTheyAreKnown) {
  estimator::WindSeries series;
  series.points = {point_at(0, 10, estimate_of(5, 270, 0.5))};
  series.points[0].vertical = {-0.4f, 0.25f};
  series.points[0].drag = {1.25f, 0.04f, true};
  EXPECT_THAT(wind_csv(series), HasSubstr(",good,smoothed,-0.4000,0.2500,1.2500,0.0500,1\n"));
}

TEST(WindCsv, GivesNoDirectionBelowTwiceTheUncertainty) {
  estimator::WindSeries series;
  series.points = {point_at(0, 10, estimate_of(0.9, 200, 0.5))};
  EXPECT_THAT(wind_csv(series), HasSubstr(",0.9000,,good,smoothed,,,,,\n"));
}

TEST(ProfileCsv, HasTheColumnsOfTheContractAndKeepsEmptyBins) {
  profiles::WindProfile profile;
  profiles::Leg up{profiles::LegName::up, {support::bin_at(10, 4, 90, 0.2)}};
  profiles::Bin empty;
  empty.bottom = 20, empty.top = 30;
  up.bins.push_back(empty);
  profile.legs = {up};
  EXPECT_EQ(
      profile_csv(profile),
      "leg,bin_bottom_m,bin_top_m,height_agl_m,height_msl_m,utc,lat_deg,lon_deg,wind_east_m_s,wind_north_m_s,"
      "sd_wind_east_m_s,sd_wind_north_m_s,wind_speed_m_s,sd_wind_speed_m_s,wind_from_deg,sd_wind_from_deg,sigma_east_m_"
      "s,"
      "sigma_north_m_s,samples,effective_samples,quality,cov_wind_east_north_m2_s2,sd_sampling_m_s,sd_calibration_m_s,"
      "sd_trim_m_s,spread_from_deg,sd_noise_m_s,sd_climb_law_m_s,resolution_m,freedom,air_pressure_pa,"
      "air_temperature_k,relative_humidity_pct,barometric_altitude_m\n"
      "up,10.00,20.00,15.10,165.10,2025-06-15T15:06:50.000Z,43.5657000,1.4815000,-4.0000,0.0000,0.2000,0.2000,4.0000,0."
      "2000,"
      "90.00,2.86,0.5000,0.4000,100,8.25,good,0.004000,0.3000,0.1200,0.0500,6.50,,,,,,,,\n"
      "up,20.00,30.00,,,,,,,,,,,,,,,,0,,none,,,,,,,,,,,,,\n");
}

TEST(ProfileCsv, RunsFromTheGroundUpLegByLeg) {
  const auto text = profile_csv(support::made_up_profile());
  EXPECT_LT(text.find("\nup,230.00"), text.find("\ndown,10.00"));
  EXPECT_LT(text.find("\ndown,230.00"), text.find("\nall,10.00"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 3 * 23);
}

TEST(WindJson, CarriesSourceVehicleSettingsProblemsAndReasons) {
  const auto json = nlohmann::json::parse(wind_json(two_points(), support::made_up_source()));
  EXPECT_EQ(json["schema"], "quadsonde.wind/1");
  EXPECT_EQ(json["source"], nlohmann::json({{"file", "hover.ulg"}, {"sha256", "00ff"}, {"flight", 2}}));
  EXPECT_EQ(json["vehicle"]["id"], "class:generic");
  EXPECT_DOUBLE_EQ(json["vehicle"]["sd_linear_per_s"], 0.07);
  EXPECT_EQ(json["settings"]["bin_m"], 10);
  EXPECT_TRUE(json["settings"]["turbulence_sd_m_s"].is_null());
  ASSERT_EQ(json["problems"].size(), 1u);
  EXPECT_EQ(json["problems"][0]["where"]["byte"], 17);
  EXPECT_EQ(json["problems"][0]["where"]["file"], "hover.ulg") << "a product says nothing about the machine's folders";
  ASSERT_EQ(json["rows"].size(), 2u);
  EXPECT_TRUE(json["rows"][0]["wind_east_m_s"].is_null());
  EXPECT_EQ(json["rows"][0]["reasons"], nlohmann::json({"converging"}));
  EXPECT_DOUBLE_EQ(json["rows"][1]["wind_east_m_s"], 5.0);
}

TEST(ProfileJson, HasARowForEveryRowOfTheCsvWithTheSameNames) {
  const auto profile = support::made_up_profile();
  const auto json = nlohmann::ordered_json::parse(profile_json(profile, support::made_up_source()));
  EXPECT_EQ(json["schema"], "quadsonde.profile/1");
  ASSERT_EQ(json["rows"].size(), 69u);
  const auto csv = profile_csv(profile);
  std::string names;
  for (const auto& [name, value] : json["rows"][0].items())
    if (name != "reasons") names += (names.empty() ? "" : ",") + name;
  EXPECT_EQ(names, csv.substr(0, csv.find('\n')));
  EXPECT_EQ(json["rows"][37]["reasons"], nlohmann::ordered_json({"no_samples"}));
  EXPECT_EQ(json["rows"][37]["samples"], 0) << "a count of nothing is known to be 0";
  EXPECT_TRUE(json["rows"][37]["wind_speed_m_s"].is_null());
}

TEST(Json, NeverHoldsANumberThatIsNotFinite) {
  auto series = two_points();
  series.diagnostics.nis_mean = std::nan("");
  auto source = support::made_up_source();
  source.vehicle.drag.quadratic = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::json::parse(wind_json(series, source));
  EXPECT_TRUE(json["diagnostics"]["nis_mean"].is_null());
  EXPECT_TRUE(json["vehicle"]["quadratic_per_m"].is_null());
}

TEST(Json, SurvivesNamesThatAreNoUtf8) {
  auto source = support::made_up_source();
  source.vehicle.name = "quad \xff\xfe";
  EXPECT_TRUE(nlohmann::json::accept(wind_json(two_points(), source)));
}

TEST(Numbers, PrintTheSameEverywhere) {
  EXPECT_EQ(fixed(-0.00001, 4), "0.0000") << "no minus zero";
  EXPECT_EQ(fixed(std::nullopt, 2), "");
  EXPECT_EQ(fixed(std::nan(""), 2), "");
  EXPECT_EQ(seconds_text(ingest::LogTime{1'697'000'000'123'456'789}), "1697000000.123457");
  EXPECT_EQ(seconds_text(ingest::LogTime{-1'500'000'000}), "-1.500000");
}

}  // namespace
}  // namespace quadsonde::product
