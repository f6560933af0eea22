#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::cli {
namespace {

using support::quadsonde;
using support::read_text;
using support::write_text;
using testing::HasSubstr;

/// A profile and a wind of the flight of place_flight (43.57 N, 1.48 E, 2025-06-15 06:00 UTC) and reports.
struct Placed {
  support::TemporaryFolder folder;
  Placed() {
    support::place_flight(folder / "a.csv");
    quadsonde({"profile", "a.csv", "-o", "p.csv"}, folder.path());
    write_text(folder / "here.txt", "2025-06-15 06:05 LFBO 150605Z 25010G18KT 220V280 9999\n");
    write_text(folder / "other_day.txt", "2025-06-12 06:05 LFBO 120605Z 25010KT 9999\n");
    write_text(folder / "other_place.csv",
               "utc,speed_min_m_s,speed_max_m_s,wind_from_deg,height_agl_m,lat_deg,lon_deg\n"
               "2025-06-15T06:05:00Z,4,6,250,10,48.11,16.57\n");
  }
  support::Ended compare(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    return quadsonde(arguments, folder.path());
  }
};

TEST(Compare, TellsWhatItTookAsWhatAndScoresInAnyOrder) {
  const Placed placed;
  for (const auto& files : std::vector<std::vector<std::string>>{{"p.csv", "here.txt"}, {"here.txt", "p.csv"}}) {
    const auto ended = placed.compare(files);
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("p.csv: a profile of ours"));
    EXPECT_THAT(ended.err, HasSubstr("here.txt: reports of a station"));
    EXPECT_THAT(ended.out, HasSubstr("Against here.txt (METAR LFBO, distance unknown)"));
    EXPECT_THAT(ended.out, HasSubstr("2025-06-15 06:05"));
    EXPECT_THAT(ended.out, HasSubstr("Gusts up to 9.3 m/s"));
    std::istringstream lines(ended.out + ended.err);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST(Compare, OfAnotherDayOrPlaceScoresNothingAndExitsWith3) {
  const Placed placed;
  const auto day = placed.compare({"p.csv", "other_day.txt", "-o", "day.json"});
  EXPECT_EQ(day.code, 3);
  EXPECT_THAT(day.err, HasSubstr("3 days before the flight"));
  EXPECT_EQ(nlohmann::json::parse(read_text(placed.folder / "day.json"))["references"][0]["scores"]["n"], 0);
  const auto place = placed.compare({"p.csv", "other_place.csv"});
  EXPECT_EQ(place.code, 3);
  EXPECT_THAT(place.err, HasSubstr("1274 km from the flight"));
  const auto said = placed.compare({"p.csv", "here.txt", "--reference-at", "48.11,16.57,10"});
  EXPECT_EQ(said.code, 3);
  EXPECT_THAT(said.err, HasSubstr("1274 km from the flight"));
  EXPECT_EQ(placed.compare({"p.csv", "here.txt", "other_day.txt"}).code, 3) << "one of two";
}

TEST(Compare, GivesOneClearMessageForEachUnusableReference) {
  const Placed placed;
  write_text(placed.folder / "empty.txt", "");
  write_text(placed.folder / "diary.txt", "Dear diary\n");
  write_text(placed.folder / "no_wind.txt", "2025-06-15 06:05 LFBO 150605Z /////KT 9999\n");
  const std::vector<std::tuple<std::string, int, std::string>> cases{{"empty.txt", 1, "empty"},
                                                                     {"diary.txt", 1, "no reference"},
                                                                     {"nowhere.txt", 1, "cannot be opened"},
                                                                     {"a.csv", 1, "flight log"},
                                                                     {"no_wind.txt", 3, "no wind"}};
  for (const auto& [file, code, what] : cases) {
    const auto ended = placed.compare({"p.csv", file});
    EXPECT_EQ(ended.code, code) << file << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(file));
    std::string plain;
    for (const char c : ended.err) plain += c == '\n' ? ' ' : c;
    EXPECT_THAT(plain, HasSubstr(what)) << file;
  }
  EXPECT_EQ(placed.compare({"p.csv", "diary.txt", "here.txt"}).code, 3) << "the others go on";
}

TEST(Compare, OfAProfileWithoutUtcHintsAtTheStart) {
  const Placed placed;
  auto text = read_text(placed.folder / "p.csv");
  for (auto at = text.find("2025-06"); at != std::string::npos; at = text.find("2025-06"))
    text.erase(at, text.find(',', at) - at);
  write_text(placed.folder / "undated.csv", text);
  const auto ended = placed.compare({"undated.csv", "here.txt"});
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(ended.err, HasSubstr("--start-utc"));
}

TEST(Compare, WritesJsonAndThePictureAndNothingElse) {
  const Placed placed;
  EXPECT_EQ(placed.compare({"p.csv", "here.txt", "-o", "c.json"}).code, 0);
  EXPECT_EQ(nlohmann::json::parse(read_text(placed.folder / "c.json"))["schema"], "quadsonde.compare/1");
  EXPECT_EQ(placed.compare({"p.csv", "here.txt", "-o", "c.svg"}).code, 0);
  EXPECT_THAT(read_text(placed.folder / "c.svg"), HasSubstr("METAR LFBO"));
  const auto printed = placed.compare({"p.csv", "here.txt", "--json"});
  EXPECT_EQ(printed.out, read_text(placed.folder / "c.json"));
  const auto two = nlohmann::json::parse(placed.compare({"p.csv", "p.csv", "here.txt", "--json"}).out);
  EXPECT_EQ(two.size(), 2u) << "several profiles: a list";
  for (const auto& wrong : std::vector<std::vector<std::string>>{{"p.csv", "here.txt", "-o", "c.txt"},
                                                                 {"p.csv", "here.txt", "-o", "c.json"},
                                                                 {"p.csv", "p.csv", "here.txt", "-o", "d.svg"},
                                                                 {"p.csv"},
                                                                 {"here.txt"},
                                                                 {"p.csv", "here.txt", "--reference-at", "48"}})
    EXPECT_EQ(placed.compare(wrong).code, 2) << testing::PrintToString(wrong);
}

TEST(Run, TakesReferencesOfAnyKindTogether) {
  const Placed placed;
  const auto ended =
      quadsonde({"run", "a.csv", "-o", "out", "--reference", "here.txt", "other_place.csv"}, placed.folder.path());
  EXPECT_EQ(ended.code, 3) << "one of them is elsewhere";
  EXPECT_THAT(ended.out, HasSubstr("Against here.txt (METAR LFBO"));
  EXPECT_THAT(ended.err, HasSubstr("1274 km"));
  const auto json = nlohmann::json::parse(read_text(placed.folder / "out/a/compare.json"));
  ASSERT_EQ(json["references"].size(), 2u);
  EXPECT_EQ(json["references"][0]["scores"]["n"], 1);
  EXPECT_EQ(json["references"][1]["scores"]["n"], 0);
  const auto page = read_text(placed.folder / "out/a/report.html");
  EXPECT_THAT(page, HasSubstr("METAR LFBO"));
  EXPECT_THAT(page, HasSubstr("Against the reference"));
}

}  // namespace
}  // namespace quadsonde::cli
