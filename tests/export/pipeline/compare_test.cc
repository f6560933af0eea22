#include "export/pipeline/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "export/csv/flight_csv.h"
#include "export/csv/tables.h"
#include "tests/export/made_up.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

using support::write_text;
using testing::HasSubstr;

/// The made-up series flies for 40 s from 2025-06-15 15:06:40 UTC, at 10 m first and last, with 3 m/s from 242.
struct Made {
  support::TemporaryFolder folder;
  estimator::WindSeries series = support::made_up_series();
  profiles::WindProfile profile = support::made_up_profile();

  ReferenceFile reference(const std::string& text, const std::string& name = "ref.txt") const {
    write_text(folder / name, text);
    auto file = read_reference_file(folder / name);
    if (!file) throw std::runtime_error(ingest::to_string(file.error()));
    return std::move(*file);
  }
  Comparison compare(const std::string& text, const ReferenceSettings& settings = {}) const {
    return compare_with({&series, nullptr, &profile}, {reference(text)}, settings);
  }
};

constexpr const char* metar = "METAR LFBO 151510Z 24006G12KT 210V280 9999 Q1015\n";

TEST(ReferenceFile, IsKnownByItsContents) {
  const Made made;
  EXPECT_TRUE(
      std::holds_alternative<ingest::Truth>(made.reference(truth_csv({{ingest::LogTime{0}, {1}, {1, 2, 3}}})).content));
  for (const auto* text :
       {metar, "2025-06-15 15:10\tLFBO 151510Z VRB01KT\n", "station,valid,drct,sknt\nLFBO,2025-06-15 15:10,240,6\n",
        "utc,speed_min_m_s,speed_max_m_s,wind_from_deg\n2025-06-15T15:10:00Z,2,4,240\n"})
    EXPECT_TRUE(std::holds_alternative<std::string>(made.reference(text).content)) << text;
}

TEST(ReferenceFile, ThatIsNoneSaysWhatItIsInsteadAndWhatToDo) {
  const Made made;
  const auto refused = [&](const std::string& text) {
    write_text(made.folder / "x", text);
    const auto read = read_reference_file(made.folder / "x");
    EXPECT_FALSE(read) << text.substr(0, 40);
    return read ? ingest::Problem{} : read.error();
  };
  EXPECT_THAT(refused("").what, HasSubstr("empty"));
  EXPECT_THAT(refused(" \n\n").what, HasSubstr("empty"));
  EXPECT_THAT(refused("Dear diary\n").hint, HasSubstr("utc,speed_min_m_s"));
  EXPECT_THAT(refused(profile_csv(made.profile)).hint, HasSubstr("quadsonde compare"));
  EXPECT_THAT(refused(flight_csv(support::flown().flight)).hint, HasSubstr("quadsonde run"));
  EXPECT_EQ(refused("time_s\n1\n").where.topic, "height_agl_m") << "a table of the true wind without its heights";
  EXPECT_EQ(read_reference_file(made.folder / "nowhere").error().kind, ingest::Kind::unreadable);
}

TEST(ReferencePlace, IsThreeNumbersOfAPlaceOnEarth) {
  const auto place = reference_place("48.2486,-16.3564,10");
  ASSERT_TRUE(place && *place);
  EXPECT_EQ((*place)->place.lon_deg, -16.3564);
  EXPECT_EQ((*place)->height.m, 10);
  EXPECT_FALSE(*reference_place(""));
  for (const auto* wrong : {"48", "48,16", "48,16,x", "91,16,10", "48,16,-3", "48,16,10,2", "a,b,c"})
    EXPECT_EQ(reference_place(wrong).error().kind, ingest::Kind::usage) << wrong;
}

TEST(Compare, OfSeveralReferencesScoresEachByItself) {
  const Made made;
  const auto comparison = compare_with(
      {&made.series, nullptr, &made.profile},
      {made.reference(metar, "m.txt"),
       made.reference("utc,speed_min_m_s,speed_max_m_s,wind_from_deg\n2025-06-15T15:10:00Z,2,4,240\n", "t"),
       made.reference(
           truth_csv({{ingest::LogTime{0}, {10}, {1, 2, 0}}, {ingest::LogTime{1'000'000'000}, {10}, {1, 2, 0}}}),
           "truth.csv")},
      {});
  ASSERT_EQ(comparison.references.size(), 3u);
  EXPECT_EQ(comparison.references[0].kind, "METAR");
  EXPECT_EQ(comparison.references[1].kind, "table");
  EXPECT_EQ(comparison.references[2].kind, "truth");
  for (const auto& reference : comparison.references) EXPECT_GT(reference.whole().n, 0u) << reference.file;
  EXPECT_TRUE(comparison.problems().empty());
  EXPECT_EQ(comparison.marks.size(), 2u);
}

TEST(Compare, PlacesAReferenceWhereTheUserSays) {
  const Made made;
  EXPECT_THAT(comparison_text(made.compare(metar)), HasSubstr("distance unknown"));
  ReferenceSettings settings;
  settings.reference_at = "43.63,1.37,8";
  const auto placed = made.compare(metar, settings);
  EXPECT_THAT(comparison_text(placed), HasSubstr("11.5 km away"));
  EXPECT_EQ(placed.references[0].reports()->pairs.at(0).report.height->m, 8);
  settings.reference_at = "48.11,16.57,10";
  const auto elsewhere = made.compare(metar, settings);
  EXPECT_EQ(elsewhere.references[0].whole().n, 0u);
  ASSERT_EQ(elsewhere.problems().size(), 1u);
  EXPECT_THAT(elsewhere.problems()[0].what, HasSubstr("1274 km"));
  EXPECT_THAT(elsewhere.problems()[0].where.file, HasSubstr("ref.txt"));
}

TEST(Compare, SaysWhyNothingWasScored) {
  Made made;
  EXPECT_THAT(comparison_text(made.compare("LFBO 111510Z 24006KT\n")), HasSubstr("4 days before"));
  EXPECT_THAT(made.compare("2025-06-15 15:10 LFBO 151510Z /////KT 9999\n").problems().at(0).what, HasSubstr("no wind"));
  for (auto& p : made.series.points) p.utc.reset();
  for (auto& leg : made.profile.legs)
    for (auto& bin : leg.bins) bin.utc.reset();
  const auto undated = made.compare(metar).problems();
  ASSERT_EQ(undated.size(), 1u);
  EXPECT_THAT(undated[0].hint, HasSubstr("--start-utc"));
  EXPECT_THAT(made.compare("2025-06-15 15:10 LFBO 151510Z 24006KT\n").problems().at(0).hint, HasSubstr("--start-utc"));
}

TEST(Compare, JsonCarriesScoresSettingsLayersAndPairs) {
  const Made made;
  const auto json = nlohmann::json::parse(comparison_json(made.compare(metar), "a.mcap", 2));
  EXPECT_EQ(json["schema"], "quadsonde.compare/1");
  EXPECT_EQ(json["source"]["flight"], 2);
  EXPECT_EQ(json["settings"]["direction_above_m_s"], 2);
  const auto& reference = json["references"][0];
  EXPECT_EQ(reference["stations"][0], "LFBO");
  EXPECT_EQ(reference["scores"]["n"], 1);
  EXPECT_EQ(reference["scores"]["wind_speed_m_s"]["n"], 1);
  EXPECT_EQ(reference["layers"][0]["bottom_m"], 10);
  const auto& pair = reference["pairs"][0];
  EXPECT_EQ(pair["report_from_deg"], 240);
  EXPECT_NEAR(pair["report_gust_m_s"], 12 * 0.514444, 1e-3);
  EXPECT_EQ(pair["report_sector_deg"], nlohmann::json({210, 280}));
  EXPECT_TRUE(pair["distance_m"].is_null());
  EXPECT_TRUE(reference["no_score"].is_null());
}

TEST(Compare, JsonOfATruthCarriesScoresPerLegAndLayer) {
  const Made made;
  const auto truth =
      truth_csv({{ingest::LogTime{0}, {10}, {1, 2, 0}}, {ingest::LogTime{1'500'000'000}, {12}, {1, 2, 0}}});
  const auto json = nlohmann::json::parse(comparison_json(made.compare(truth), "a.mcap", 1));
  const auto& reference = json["references"][0];
  EXPECT_EQ(reference["kind"], "truth");
  EXPECT_EQ(reference["matched_by"], "time");
  EXPECT_EQ(reference["scores"]["n"], 6) << "1.0 to 1.5 s; before that the made-up wind converges";
  EXPECT_EQ(reference["legs"].size(), 3u);
}

TEST(Compare, DrawsReportsAsMarksWithTheirRange) {
  const Made made;
  const auto calm = made.compare("LFBO 151510Z 00000KT\n").marks.at(0);
  EXPECT_EQ(calm.low, 0) << "a speed has no negative half step";
  EXPECT_FALSE(calm.from_deg);
  const auto mark = made.compare(metar).marks.at(0);
  EXPECT_EQ(mark.name, "METAR LFBO");
  EXPECT_EQ(mark.height, 10);
  EXPECT_NEAR(mark.high - mark.low, 0.514444, 1e-5) << "one knot";
  EXPECT_EQ(mark.sector_deg, std::make_pair(210.0, 280.0));
}

TEST(CompareText, StaysWithin80Columns) {
  const Made made;
  std::istringstream lines(comparison_text(made.compare(metar)) +
                           comparison_text(made.compare("LFBO 111510Z 24006KT\n")));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

}  // namespace
}  // namespace quadsonde::product
