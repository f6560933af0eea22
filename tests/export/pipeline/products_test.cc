// What services take, from a log to the bytes: heights by the geoid, the station file, every form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "export/cf_netcdf/read_profile.h"
#include "export/geoid/geoid.h"
#include "export/pipeline/merge.h"
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

/// The cells of a CSV by row and column.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& csv) {
  std::vector<std::map<std::string, std::string>> rows;
  std::vector<std::string> names;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream stream(line + ",");
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size() && i < cells.size(); ++i) row[names[i]] = cells[i];
  }
  return rows;
}
void expect_near(const std::optional<double>& stored, const std::string& printed, double half_digit,
                 const std::string& what) {
  ASSERT_EQ(stored.has_value(), !printed.empty()) << what;
  if (stored) {
    EXPECT_NEAR(*stored, std::stod(printed), half_digit + 1e-6 * std::abs(*stored)) << what;
  }
}

TEST(Products, CsvJsonAndNetcdfOfOneRunTellTheSame) {
  for (const auto* method : {"bins", "optimal"}) {
    Flown flown;
    flown.request.settings.leg.method = method;
    apply_words(flown.request.settings);
    const auto answer = flown.answer();
    ASSERT_TRUE(answer.profile);
    const auto rows = rows_of(*render_profile(answer, Format::csv));
    const auto json = nlohmann::json::parse(*render_profile(answer, Format::json));
    ASSERT_EQ(json["rows"].size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (const auto& [name, text] : rows[i]) {
        const auto& value = json["rows"][i][name];
        if (text.empty())
          EXPECT_TRUE(value.is_null()) << name;
        else if (value.is_string())
          EXPECT_EQ(value, text) << name;
        else
          EXPECT_DOUBLE_EQ(value.get<double>(), std::stod(text)) << name;
      }
    const auto stored = read_profile_netcdf(ingest::as_bytes(*profile_netcdf_of(answer)), "p.nc");
    ASSERT_TRUE(stored) << ingest::to_string(stored.error());
    constexpr const char* legs[] = {"up", "down", "all"};
    std::size_t seen = 0;
    for (const auto& record : stored->records) {
      std::size_t bin = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        auto row = rows[i];
        if (row["leg"] != legs[record.leg]) continue;
        const auto& b = record.bins.at(bin++);
        const auto what = row["leg"] + " " + row["bin_bottom_m"];
        expect_near(b.east, row["wind_east_m_s"], 5e-5, what);
        expect_near(b.se_north, row["sd_wind_north_m_s"], 5e-5, what);
        expect_near(b.noise, row["sd_noise_m_s"], 5e-5, what);
        expect_near(b.calibration, row["sd_calibration_m_s"], 5e-5, what);
        expect_near(b.trim, row["sd_trim_m_s"], 5e-5, what);
        expect_near(b.climb_law, row["sd_climb_law_m_s"], 5e-5, what);
        expect_near(b.sampling, row["sd_sampling_m_s"], 5e-5, what);
        expect_near(b.resolution_m, row["resolution_m"], 5e-3, what);
        expect_near(b.freedom, row["freedom"], 5e-4, what);
        expect_near(b.pressure_pa, row["air_pressure_pa"], 0.5, what);
        expect_near(b.barometric_altitude_m, row["barometric_altitude_m"], 5e-3, what);
        std::vector<std::string> reasons;
        for (const auto reason : b.reasons.list()) reasons.emplace_back(estimator::name(reason));
        EXPECT_EQ(json["rows"][i]["reasons"], nlohmann::json(reasons)) << what;
        ++seen;
      }
    }
    EXPECT_GE(seen, 5u);
    EXPECT_TRUE(stored->records[0].bins[1].noise);
    EXPECT_EQ(stored->records[0].bins[1].freedom.has_value(), method == std::string("optimal"));
  }
}

/// Up and down twice, from the ground and back onto it.
std::string twice_toml() {
  auto text = std::string(support::ascent_toml());
  return text + text.substr(text.find("[[path]]"));
}

TEST(Products, ALogWithSeveralAscentsHasASectionInItsReport) {
  Flown flown;
  EXPECT_FALSE(flown.answer().section) << "one ascent and one descent are the profile's legs";
  write_text(flown.request.log, flight_csv(support::flown(twice_toml()).flight));
  const auto answer = flown.answer();
  ASSERT_TRUE(answer.section);
  EXPECT_EQ(answer.section->columns.size(), 4u);
  EXPECT_THAT(*render_profile(answer, Format::html), HasSubstr("Over time and height"));
  const auto csv = rows_of(*render_section(answer, Format::csv));
  const auto json = nlohmann::json::parse(*render_section(answer, Format::json));
  EXPECT_EQ(json["schema"], "quadsonde.section/1");
  ASSERT_EQ(json["columns"].size(), 4u);
  EXPECT_EQ(json["rows"].size(), csv.size());
  EXPECT_EQ(csv.back().at("section_column"), "4");
  EXPECT_EQ(csv.back().at("section_from_utc"), json["columns"][3]["from_utc"]);
  EXPECT_TRUE(render_section(answer, Format::netcdf));
  EXPECT_FALSE(render_section(answer, Format::bufr));
}

TEST(Products, FlightsTogetherGiveASectionBesideTheirProfile) {
  Flown flown;
  auto a = flown.answer(), b = flown.answer();
  for (auto* legs : {&b.profile->legs, &b.profile->flown})
    for (auto& leg : *legs) {
      *leg.utc_from = *leg.utc_from + ingest::seconds(3600), *leg.utc_to = *leg.utc_to + ingest::seconds(3600);
      for (auto& bin : leg.bins)
        if (bin.utc) *bin.utc = *bin.utc + ingest::seconds(3600);
    }
  const auto both = section_of({&a, &b});
  ASSERT_TRUE(both) << ingest::to_string(both.error());
  EXPECT_EQ(both->section->columns.size(), 4u);
  EXPECT_TRUE(both->profile);
  EXPECT_TRUE(both->merged);
  EXPECT_TRUE(render_section(*both, Format::html));
  EXPECT_TRUE(render_section(*both, Format::netcdf));
}

}  // namespace
}  // namespace quadsonde::product
