#include "export/magnetic/magnetic_north.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

ingest::UtcTime at_year(double year) { return {static_cast<std::int64_t>((year - 1970) * 365.2425 * 86400 * 1e9)}; }

// Test values that come with the models, the first two with the 2015 set before its revision of 2018, which moved it by
// hundredths of a degree there (WMM test value files of NOAA/NCEI): date, height [km], place, declination.
TEST(MagneticNorth, AgreesWithTheModelsOwnTestValues) {
  const auto north = MagneticNorth::open();
  ASSERT_FALSE(north.empty());
  const struct {
    double year, km, lat, lon, declination;
  } values[] = {{2017.5, 0, 80, 0, -2.75},     {2017.5, 100, 0, 120, 0.32},  {2020, 65, 43, 93, 0.71},
                {2020.5, 44, 33, -118, 11.46}, {2022.5, 8, 62, 53, 18.95},   {2022.5, 0, -13, -59, -16.65},
                {2025, 48, 80, -96, -29.91},   {2025.5, 8, -66, 17, -33.14}, {2027, 57, -43, 50, -48.27},
                {2029.5, 33, 17, 5, 0.89}};
  for (const auto& v : values) {
    const auto d = north.declination({v.lat, v.lon}, 1000 * v.km, at_year(v.year));
    ASSERT_TRUE(d) << v.year << " " << v.lat;
    EXPECT_NEAR(d->deg, v.declination, v.year < 2020 ? 0.2 : 0.006 + 0.004) << v.year << " " << v.lat << " " << v.lon;
    EXPECT_FALSE(d->outside_validity);
    EXPECT_GT(d->sd_deg, 0.26);
  }
}

TEST(MagneticNorth, TakesTheSetOfTheLogsYearAndSaysHowLongItHolds) {
  const auto north = MagneticNorth::open();
  const ingest::GeoPoint toulouse{43.5657, 1.4815};
  EXPECT_EQ(north.declination(toulouse, 200, at_year(2019.9))->model, "World Magnetic Model 2015, valid 2015 to 2020");
  EXPECT_EQ(north.declination(toulouse, 200, at_year(2024.9))->model, "World Magnetic Model 2020, valid 2020 to 2025");
  EXPECT_EQ(north.declination(toulouse, 200, at_year(2026))->model, "World Magnetic Model 2025, valid 2025 to 2030");
  // Where one set ends and the next begins they differ by what the field did that nobody foresaw.
  EXPECT_NEAR(north.declination(toulouse, 200, at_year(2024.99))->deg,
              north.declination(toulouse, 200, at_year(2025.01))->deg, 0.2);
}

TEST(MagneticNorth, IsLessSureOfADateOutsideItsSetsAndOfNone) {
  const auto north = MagneticNorth::open();
  const ingest::GeoPoint toulouse{43.5657, 1.4815};
  const auto inside = north.declination(toulouse, 0, at_year(2026));
  const auto old = north.declination(toulouse, 0, at_year(2005));
  const auto undated = north.declination(toulouse, 0, {});
  ASSERT_TRUE(inside && old && undated);
  EXPECT_TRUE(old->outside_validity);
  EXPECT_GT(old->sd_deg, 1) << "ten years before the first set";
  EXPECT_FALSE(undated->date_known);
  EXPECT_GT(undated->sd_deg, inside->sd_deg + 0.5) << "it moved by over a degree from 2015 to 2025";
}

TEST(MagneticNorth, HasNoAnswerWhereNoCompassWorksAndForPointsThatAreNone) {
  const auto north = MagneticNorth::open();
  EXPECT_FALSE(north.declination({86, 139}, 0, at_year(2025))) << "beside the magnetic pole";
  EXPECT_FALSE(north.declination({91, 0}, 0, at_year(2025)));
  EXPECT_FALSE(north.declination({0, std::nan("")}, 0, at_year(2025)));
}

TEST(MagneticNorth, DoesWithoutAFolderAndWithACutFile) {
  EXPECT_TRUE(MagneticNorth::open("/nonexistent").empty());
  EXPECT_FALSE(MagneticNorth::open("/nonexistent").declination({43, 1}, 0, at_year(2025)));
  const support::TemporaryFolder folder;
  std::ofstream(folder / "wmm2025.wmm") << "WMMF-1\nName wmm2025\nRadius 6371200\n";
  EXPECT_TRUE(MagneticNorth::open(folder.path()).empty());
}

}  // namespace
}  // namespace quadsonde::product
