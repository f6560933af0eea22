// What services take, from a log to the bytes: heights by the geoid, the station file, every form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "export/geoid/geoid.h"
#include "export/pipeline/netcdf.h"
#include "export/pipeline/render.h"
#include "export/pipeline/run_log.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

using support::write_text;
using testing::HasSubstr;

/// A folder with a flown log whose heights, where asked, are above the ellipsoid only.
struct Flown {
  support::TemporaryFolder folder;
  RunRequest request;
  explicit Flown(bool above_ellipsoid = false) {
    auto flight = support::flown().flight;
    if (above_ellipsoid) {
      const double undulation = *Geoid::open().undulation({43.5657, 1.4815});
      for (std::size_t i = 0; i < flight.height_msl.size(); ++i)
        flight.height_ellipsoid.push(flight.height_msl.time[i], {flight.height_msl.value[i].m + undulation});
      flight.height_msl = {};
    }
    write_text(folder / "ascent.csv", flight_csv(flight));
    request.log = folder / "ascent.csv";
    request.want_classic = false;
  }
  FlightAnswer answer() const {
    const auto result = run_log(request);
    EXPECT_TRUE(result) << (result ? "" : ingest::to_string(result.error()));
    return result ? result->flights.at(0).answer : FlightAnswer{};
  }
};

std::vector<double> altitudes(const FlightAnswer& answer) {
  std::vector<double> all;
  for (const auto& leg : answer.profile->legs)
    for (const auto& bin : leg.bins)
      if (bin.height_msl) all.push_back(bin.height_msl->m);
  return all;
}

TEST(Products, ALogWithHeightsAboveTheEllipsoidOnlyGetsThoseAboveTheSea) {
  const auto own = Flown().answer(), made = Flown(true).answer();
  EXPECT_THAT(altitudes(made), testing::Pointwise(testing::DoubleNear(0.02), altitudes(own)));
  ASSERT_TRUE(made.part.takeoff);
  EXPECT_NEAR(made.part.takeoff->m, own.part.takeoff->m, 0.02);
  EXPECT_EQ(own.source.made_heights, "");
  EXPECT_THAT(made.source.made_heights, HasSubstr("minus the geoid (EGM96, 0.25 degree grid"));
  const auto json = nlohmann::json::parse(*render_profile(made, Format::json));
  EXPECT_THAT(json["source"]["heights"].get<std::string>(), HasSubstr("EGM96"));
  EXPECT_EQ(made.source.problems.size(), own.source.problems.size()) << "it is no fault of the log";
  EXPECT_TRUE(profile_netcdf_of(made));
}

TEST(Products, TheOffsetOfTheDatumShiftsAlsoHeightsThatTheGeoidGave) {
  Flown flown(true);
  const auto before = altitudes(flown.answer());
  flown.request.settings.input.height_offset_m = 7;
  auto after = altitudes(flown.answer());
  for (auto& z : after) z -= 7;
  EXPECT_THAT(after, testing::Pointwise(testing::DoubleNear(1e-6), before));
}

TEST(Products, EveryFormOfAProfileIsMade) {
  const auto answer = Flown().answer();
  for (const auto format : {Format::csv, Format::json, Format::svg, Format::html, Format::netcdf, Format::bufr,
                            Format::geojson, Format::kml, Format::met_point}) {
    const auto text = render_profile(answer, format);
    ASSERT_TRUE(text) << ingest::to_string(text.error());
    EXPECT_GT(text->size(), 300u);
  }
  for (const auto format : {Format::csv, Format::json, Format::netcdf, Format::geojson, Format::kml})
    EXPECT_TRUE(render_wind(answer, format));
  for (const auto format : {Format::bufr, Format::met_point})
    EXPECT_THAT(render_wind(answer, format).error().hint, HasSubstr("quadsonde profile"));
}

TEST(Products, LayoutAndFormFollowTheSettings) {
  Flown flown;
  const auto cf = flown.answer();
  flown.request.settings.product.layout = "uasdc";
  flown.request.settings.product.bufr = "uasdc";
  const auto uasdc = flown.answer();
  EXPECT_NE(*render_profile(uasdc, Format::netcdf), *render_profile(cf, Format::netcdf));
  EXPECT_EQ(*render_profile(uasdc, Format::netcdf), *uasdc_of(uasdc));
  EXPECT_NE(*bufr_of(uasdc), *bufr_of(cf));
  EXPECT_EQ(*profile_netcdf_of(uasdc), *profile_netcdf_of(cf)) << "by its name it is always CF";
}

TEST(Products, TheStationFileBesideTheLogIsTaken) {
  Flown flown;
  EXPECT_EQ(flown.answer().station.file, "");
  EXPECT_THAT(named_uasdc_of(flown.answer()).error().hint, HasSubstr("operator_id"));
  write_text(flown.folder / "station.toml", "[uasdc]\noperator_id = \"007\"\nairframe_id = \"QS001\"\n");
  const auto named = named_uasdc_of(flown.answer());
  ASSERT_TRUE(named);
  EXPECT_THAT(named->name, testing::MatchesRegex("UASDC_007_QS001_202506150600[0-9][0-9]Z.nc"));
  write_text(flown.folder / "station.toml", "[uasdc]\noperator = \"007\"\n");
  const auto refused = run_log(flown.request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
  EXPECT_EQ(refused.error().where.line, 2u);
}

TEST(Products, WithoutUtcTheLogIsNamed) {
  auto answer = Flown().answer();
  for (auto& leg : answer.profile->legs) {
    leg.utc_from.reset(), leg.utc_to.reset();
    for (auto& bin : leg.bins) bin.utc.reset();
  }
  for (const auto format : {Format::netcdf, Format::bufr, Format::met_point}) {
    const auto text = render_profile(answer, format);
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().kind, ingest::Kind::missing);
    EXPECT_EQ(text.error().where.file, "ascent.csv");
    EXPECT_THAT(text.error().hint, HasSubstr("--start-utc"));
  }
}

}  // namespace
}  // namespace quadsonde::product
