#include "export/geoid/geoid.h"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/data.h"

namespace quadsonde {
namespace {

using product::Geoid;

Geoid coarse() { return Geoid::open(std::filesystem::path("/nowhere/at/all")); }

TEST(Geoid, TheBuildMadeTheFineGrid) {
  const auto geoid = Geoid::open();
  EXPECT_TRUE(geoid.is_fine());
  EXPECT_THAT(geoid.provenance(), testing::HasSubstr("0.25 degree"));
}

TEST(Geoid, GivesTimbuktuAsTheSameGridGivesItElsewhere) {
  // 16 46 33 N 3 0 34 W of the GeographicLib manual; 28.7079 m by this grid (design notes), 28.7068 m by the 5' grid.
  EXPECT_NEAR(*Geoid::open().undulation({16 + 46 / 60.0 + 33 / 3600.0, -(3 + 0 / 60.0 + 34 / 3600.0)}), 28.7079, 1e-4);
}

TEST(Geoid, GivesDelftToTheMillimetre) { EXPECT_NEAR(*Geoid::open().undulation({51.99, 4.37}), 43.483, 1e-3); }

TEST(Geoid, IsAtItsNodesWhatTheGridOfProjSays) {
  // Read here a second time, straight from the .gtx; half a step of the PGM, 1.5 mm, is what rounding may cost. The
  // cubic of GeographicLib is a least-squares fit and does not go through the nodes: it smooths by centimetres.
  const auto gtx = support::read_bytes(EGM96_GRID);
  ASSERT_EQ(gtx.size(), 40u + 721 * 1440 * 4);
  const auto geoid = Geoid::open();
  double sum = 0, worst = 0;
  int count = 0;
  for (int row = 10; row <= 710; row += 7) {
    for (int column = 3; column < 1440; column += 11, ++count) {
      const std::size_t at = 40 + 4 * (static_cast<std::size_t>(row) * 1440 + static_cast<std::size_t>(column));
      const auto bits = static_cast<std::uint32_t>(gtx[at] << 24 | gtx[at + 1] << 16 | gtx[at + 2] << 8 | gtx[at + 3]);
      const double d = *geoid.undulation({-90 + row * 0.25, -180 + column * 0.25}) - std::bit_cast<float>(bits);
      sum += d * d, worst = std::max(worst, std::abs(d));
    }
  }
  EXPECT_LT(std::sqrt(sum / count), 0.03);
  EXPECT_LT(worst, 0.5);
}

TEST(Geoid, TheGridInsideTheLibraryIsAsGoodAsItSays) {
  const auto fine = Geoid::open(), built_in = coarse();
  ASSERT_TRUE(fine.is_fine());
  ASSERT_FALSE(built_in.is_fine());
  EXPECT_THAT(built_in.provenance(), testing::HasSubstr("1 degree"));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> sine(-1, 1), longitude(-180, 180);
  std::vector<double> differences;
  double square = 0;
  for (int i = 0; i < 20000; ++i) {
    const ingest::GeoPoint p{std::asin(sine(random)) * 57.29577951308232, longitude(random)};
    differences.push_back(std::abs(*fine.undulation(p) - *built_in.undulation(p)));
    square += differences.back() * differences.back();
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_NEAR(std::sqrt(square / 20000), 0.42, 0.05) << "design notes, table of grids";
  EXPECT_NEAR(differences[19800], 1.8, 0.2);
  EXPECT_LT(differences.back(), 9.5);
}

TEST(Geoid, BothGridsAreWholeAtThePolesAndAcrossTheDateLine) {
  for (const auto& geoid : {Geoid::open(), coarse()}) {
    EXPECT_NEAR(*geoid.undulation({90, 0}), 13.6, 0.1);
    EXPECT_NEAR(*geoid.undulation({-90, 77}), -29.5, 0.1);
    EXPECT_NEAR(*geoid.undulation({90, 0}), *geoid.undulation({90, 133}), 0.05) << "one pole, one height";
    EXPECT_NEAR(*geoid.undulation({10, 180}), *geoid.undulation({10, -180}), 1e-9);
    EXPECT_NEAR(*geoid.undulation({10, 179.9999}), *geoid.undulation({10, -179.9999}), 1e-2);
    EXPECT_NEAR(*geoid.undulation({10, 359.9999}), *geoid.undulation({10, 0}), 1e-2);
    EXPECT_NEAR(*geoid.undulation({10, 725}), *geoid.undulation({10, 5}), 1e-9);
  }
}

TEST(Geoid, APointThatIsNoneHasNoHeight) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const auto& geoid : {Geoid::open(), coarse()})
    for (const ingest::GeoPoint p : {ingest::GeoPoint{nan, 0}, {0, nan}, {0, inf}, {90.001, 0}, {-91, 0}, {0, 1e300}})
      EXPECT_FALSE(geoid.undulation(p)) << p.lat_deg << ", " << p.lon_deg;
}

TEST(Geoid, ADamagedGridIsNotBelieved) {
  const support::TemporaryFolder folder;
  support::write_bytes(folder / "egm96-15.pgm", {'P', '5', '\n', 'x'});
  EXPECT_FALSE(Geoid::open(folder.path()).is_fine());
}

TEST(Geoid, AFlightWithHeightsAboveTheEllipsoidGetsHeightsAboveTheSea) {
  ingest::Flight flight;
  flight.height_ellipsoid.source = "GPS";
  for (int i = 0; i < 3; ++i) {
    flight.height_ellipsoid.push({i * 1000}, {100.0 + i});
    flight.position.push({i * 1000 + 1}, {47.0, 8.0});
  }
  const auto geoid = Geoid::open();
  ASSERT_TRUE(product::add_msl_heights(flight, geoid));
  ASSERT_EQ(flight.height_msl.size(), 3u);
  EXPECT_DOUBLE_EQ(flight.height_msl.value[2].m, 102 - *geoid.undulation({47.0, 8.0}));
  EXPECT_EQ(flight.height_msl.source, "GPS above the geoid EGM96");
  EXPECT_FALSE(product::add_msl_heights(flight, geoid)) << "what the log says of the sea is not replaced";
}

TEST(Geoid, WithoutAPlaceNoHeightIsConverted) {
  ingest::Flight flight;
  flight.height_ellipsoid.push({0}, {100.0});
  EXPECT_FALSE(product::add_msl_heights(flight, Geoid::open()));
  EXPECT_TRUE(flight.height_msl.empty());
}

}  // namespace
}  // namespace quadsonde
