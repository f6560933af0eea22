// What the air was like in each bin.
#include "profiles/air_levels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "profiles/make_profile.h"
#include "tests/profiles/made_series.h"

namespace quadsonde::profiles {
namespace {

TEST(AirLevels, FillTheBinsInWhichASensorMeasured) {
  const auto maker = SeriesMaker().climb(40, 1, {3, 0});
  auto profile = *make_profile(maker.series);
  ingest::Flight flight;
  for (int s = 0; s < 40; ++s) {
    if (s < 30) flight.air.push(at(s), {290.0 - 0.01 * s, 60.0, std::nullopt});
    flight.barometer.push(at(s), {101325.0 - 12 * s, std::nullopt});
  }
  fill_air(profile, maker.series, flight);
  for (const auto& leg : profile.legs) {
    ASSERT_EQ(leg.bins.size(), 4u);
    if (leg.name == LegName::down) continue;
    EXPECT_NEAR(*leg.bins[0].temperature_k, 289.955, 0.01);
    EXPECT_NEAR(*leg.bins[1].relative_humidity_pct, 60, 1e-9);
    EXPECT_NEAR(*leg.bins[0].pressure_pa, 101325 - 12 * 4.5, 7) << "the autopilot's barometer, where no other is";
    EXPECT_FALSE(leg.bins[3].temperature_k) << "the sensor had stopped: never a guess";
    EXPECT_TRUE(leg.bins[3].pressure_pa);
  }
}

TEST(AirLevels, AreEmptyWithoutASensor) {
  const auto maker = SeriesMaker().climb(40, 1, {3, 0});
  auto profile = *make_profile(maker.series);
  fill_air(profile, maker.series, {});
  for (const auto& bin : profile.legs.back().bins)
    EXPECT_FALSE(bin.temperature_k || bin.pressure_pa || bin.relative_humidity_pct);
}

TEST(BarometricAltitude, IsThatOfTheStandardAtmosphere) {
  // ISO 2533, table 5.
  EXPECT_NEAR(*barometric_altitude(101325), 0, 1e-9);
  EXPECT_NEAR(*barometric_altitude(89874.6), 1000, 0.1);
  EXPECT_NEAR(*barometric_altitude(54019.9), 5000, 0.2);
  EXPECT_NEAR(*barometric_altitude(107477), -500, 1);
  EXPECT_FALSE(barometric_altitude(20000)) << "beyond the tropopause the law is another";
  EXPECT_FALSE(barometric_altitude(0));
  EXPECT_FALSE(barometric_altitude(std::nan("")));
  EXPECT_FALSE(barometric_altitude(Bin{})) << "no pressure, no height of it";
}

}  // namespace
}  // namespace quadsonde::profiles
