// Products for services as users ask for them: by endings, layouts and a station file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::cli {
namespace {

using support::quadsonde;
using support::read_text;
using support::tree;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* station = "[uasdc]\noperator_id = \"007\"\nairframe_id = \"QS001\"\n";

struct Place {
  support::TemporaryFolder folder;
  Place() { support::place_flight(folder / "a.csv"); }
  support::Ended run(const std::vector<std::string>& arguments) const { return quadsonde(arguments, folder.path()); }
  std::string start_of(const std::string& file) const { return read_text(folder / file).substr(0, 4); }
};

TEST(Products, AreMadeByTheirEndings) {
  const Place place;
  for (const auto* file : {"p.nc", "p.bufr", "p.geojson", "p.kml", "p.ascii2nc"}) {
    const auto ended = place.run({"profile", "a.csv", "-o", file});
    EXPECT_THAT(ended.code, testing::AnyOf(0, 3)) << file << ended.err;
    EXPECT_EQ(ended.out, "");
  }
  EXPECT_EQ(place.start_of("p.nc"), "\x89HDF");
  EXPECT_EQ(place.start_of("p.bufr"), "BUFR");
  EXPECT_EQ(place.start_of("p.ascii2nc"), "ADPU");
  EXPECT_EQ(place.start_of("p.kml"), "<?xm");
  for (const auto* file : {"w.nc", "w.geojson", "w.kml"})
    EXPECT_THAT(place.run({"estimate", "a.csv", "-o", file}).code, testing::AnyOf(0, 3)) << file;
  const auto refused = place.run({"estimate", "a.csv", "-o", "w.bufr"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("quadsonde profile"));
  EXPECT_FALSE(fs::exists(place.folder / "w.bufr"));
}

TEST(Products, TheCampaignsFileIsNamedByTheTool) {
  const Place place;
  support::write_text(place.folder / "station.toml", station);
  fs::create_directory(place.folder / "there");
  for (const auto* folder : {"there", "made/below"}) {
    const auto ended = place.run({"profile", "a.csv", "-o", folder, "--layout", "uasdc"});
    EXPECT_THAT(ended.code, testing::AnyOf(0, 3)) << ended.err;
    EXPECT_THAT(tree(place.folder / folder),
                testing::ElementsAre(testing::MatchesRegex("UASDC_007_QS001_[0-9]{14}Z.nc")));
  }
  const auto again = place.run({"profile", "a.csv", "-o", "there", "--layout", "uasdc"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("--force"));
  EXPECT_THAT(place.run({"profile", "a.csv", "-o", "own.nc", "--layout", "uasdc"}).code, testing::AnyOf(0, 3));
}

TEST(Products, WithoutOperatorAndAirframeNoNameIsMadeUp) {
  const Place place;
  const auto ended = place.run({"profile", "a.csv", "-o", "out/", "--layout", "uasdc"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.err, HasSubstr("operator_id"));
  EXPECT_THAT(ended.err, HasSubstr("station.toml"));
  EXPECT_EQ(tree(place.folder.path()), std::vector<std::string>{"a.csv"}) << "nor is a folder left behind";
}

TEST(Products, AFolderIsNoFile) {
  const Place place;
  fs::create_directory(place.folder / "x.nc");
  for (const auto* output : {"x.nc", ".", "./"}) {
    for (const auto* force : {"", "--force"}) {
      std::vector<std::string> arguments{"profile", "a.csv", "-o", output};
      if (*force) arguments.push_back(force);
      const auto ended = place.run(arguments);
      EXPECT_EQ(ended.code, 2) << output;
      EXPECT_THAT(ended.err, HasSubstr("this is a folder")) << output;
    }
  }
}

TEST(Products, AStationFileThatIsWrongIsToldWithItsLine) {
  const Place place;
  support::write_text(place.folder / "s.toml", "[station]\nwigos_id = \"15015\"\n");
  const auto ended = place.run({"profile", "a.csv", "-o", "p.nc", "--station", "s.toml"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.err, HasSubstr("s.toml, line 2"));
  EXPECT_THAT(ended.err, HasSubstr("0-20000-0-15015")) << "what one looks like";
  EXPECT_NE(place.run({"profile", "a.csv", "-o", "p.nc", "--station", "none.toml"}).code, 0);
  EXPECT_FALSE(fs::exists(place.folder / "p.nc"));
}

TEST(Products, AFullDiskLeavesNoPart) {
  const Place place;
  const auto before = tree(place.folder.path());
  for (const auto* file : {"p.nc", "p.bufr", "p.kml", "p.geojson", "p.ascii2nc"}) {
    const auto ended = support::quadsonde_on_full_disk({"profile", "a.csv", "-o", file}, place.folder.path(), 100);
    EXPECT_EQ(ended.code, 1) << file << ended.err;
    EXPECT_EQ(tree(place.folder.path()), before) << file;
  }
}

TEST(Products, AreTheSameByteForByteUnderOneDate) {
  const Place place;
  ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  for (const auto* ending : {".nc", ".bufr", ".kml", ".geojson", ".ascii2nc"}) {
    place.run({"profile", "a.csv", "-o", std::string("1") + ending});
    place.run({"profile", "a.csv", "-o", std::string("2") + ending});
    EXPECT_EQ(read_text(place.folder / (std::string("1") + ending)),
              read_text(place.folder / (std::string("2") + ending)))
        << ending;
  }
  ::unsetenv("SOURCE_DATE_EPOCH");
}

TEST(Products, ASensorsTemperatureIsInTheCampaignsFormsOnlyWhereOneWasGiven) {
  const Place place;
  std::string table = "time_s,temperature_k,relative_humidity_pct\n";
  for (int t = 0; t < 200; ++t) table += std::to_string(t) + ",285.15,80\n";
  support::write_text(place.folder / "air.csv", table);
  place.run({"profile", "a.csv", "-o", "without.ascii2nc"});
  EXPECT_THAT(read_text(place.folder / "without.ascii2nc"), testing::Not(HasSubstr(" TMP ")));
  const auto ended = place.run({"profile", "a.csv", "-o", "with.ascii2nc", "--sensor", "air.csv"});
  EXPECT_THAT(read_text(place.folder / "with.ascii2nc"), HasSubstr(" TMP ")) << ended.err;
  EXPECT_THAT(read_text(place.folder / "with.ascii2nc"), HasSubstr(" 285.15\n"));
}

TEST(Section, IsPrintedAndWrittenInItsFormats) {
  const Place place;
  const auto printed = place.run({"profile", "a.csv", "--section"});
  EXPECT_THAT(printed.code, testing::AnyOf(0, 3)) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("Wind over time and height"));
  for (const auto* file : {"s.csv", "s.json", "s.nc", "s.svg", "s.html"})
    EXPECT_THAT(place.run({"profile", "a.csv", "--section", "-o", file}).code, testing::AnyOf(0, 3)) << file;
  EXPECT_EQ(place.start_of("s.nc"), "\x89HDF");
  EXPECT_THAT(read_text(place.folder / "s.csv"), HasSubstr("section_column,section_from_utc"));
  EXPECT_THAT(read_text(place.folder / "s.html"), HasSubstr("Over time and height"));
  const auto refused = place.run({"profile", "a.csv", "--section", "-o", "s.bufr"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr(".csv, .json, .nc, .svg or .html"));
  EXPECT_FALSE(fs::exists(place.folder / "s.bufr"));
}

TEST(HubHeight, IsToldWithItsIntervalInTextJsonAndReport) {
  const Place place;
  const auto text = place.run({"profile", "a.csv", "--hub-height-m", "30"}).out;
  EXPECT_THAT(text,
              testing::ContainsRegex("at hub height, 30 m: [0-9.]+ \\+- [0-9.]+ m/s from [0-9]+ \\+- [0-9]+ deg"));
  EXPECT_THAT(place.run({"profile", "a.csv", "--hub-height-m", "90"}).out,
              HasSubstr("the profile does not reach there"));
  place.run({"profile", "a.csv", "--hub-height-m", "30", "-o", "h.html"});
  EXPECT_THAT(read_text(place.folder / "h.html"), HasSubstr("at hub height, 30 m"));
  place.run({"profile", "a.csv", "--hub-height-m", "30", "-o", "h.json"});
  EXPECT_THAT(read_text(place.folder / "h.json"), HasSubstr("\"hub_height_m\": 30.0"));
}

}  // namespace
}  // namespace quadsonde::cli
