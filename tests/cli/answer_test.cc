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
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

void expect_narrow(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

TEST(Answer, OfEveryVerbFitsIn80ColumnsAndGoesToStandardOutput) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  support::place_scenario(folder / "s.toml");
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"run", "a.csv"}, {"info", "a.csv"}, {"estimate", "a.csv"}, {"profile", "a.csv"}, {"simulate", "s.toml"}}) {
    const auto ended = quadsonde(arguments, folder.path());
    EXPECT_THAT(ended.code, AnyOf(0, 3)) << ended.err;
    EXPECT_GT(ended.out.size(), 40u);
    expect_narrow(ended.out);
    expect_narrow(ended.err);
    EXPECT_THAT(ended.err, Not(HasSubstr("\033"))) << "no colour into a file";
    EXPECT_THAT(ended.err, Not(HasSubstr("["))) << "no bar into a file";
  }
  EXPECT_EQ(support::tree(folder.path()), (std::vector<std::string>{"a.csv", "s.toml"}));
}

TEST(Answer, TakesAFlagBeforeItsInputAsWellAsBehindIt) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  const auto before = quadsonde({"profile", "--leg", "up", "a.csv"}, folder.path());
  const auto behind = quadsonde({"profile", "a.csv", "--leg", "up"}, folder.path());
  EXPECT_THAT(before.code, AnyOf(0, 3)) << before.err;
  EXPECT_EQ(before.out, behind.out);
}

TEST(Answer, OfMergedFlightsIsOneProfile) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  support::place_flight(folder / "b.csv");
  const auto merged = quadsonde({"profile", "--merge", "a.csv", "b.csv", "--json"}, folder.path());
  const auto json = nlohmann::json::parse(merged.out, nullptr, false);
  ASSERT_FALSE(json.is_discarded()) << merged.err;
  EXPECT_TRUE(json.is_object()) << "one object, not a list";
  EXPECT_EQ(json["source"]["file"], "a.csv, b.csv");
  const auto alone = quadsonde({"profile", "--merge", "a.csv"}, folder.path());
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, HasSubstr("two logs"));
}

TEST(Answer, AsJsonIsJsonForEveryVerb) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  support::place_scenario(folder / "s.toml");
  const std::vector<std::pair<std::vector<std::string>, std::string>> calls{
      {{"run", "a.csv", "--json"}, "quadsonde.run/1"},
      {{"info", "a.csv", "--json"}, "quadsonde.info/1"},
      {{"estimate", "a.csv", "--json"}, "quadsonde.wind/1"},
      {{"profile", "a.csv", "--json"}, "quadsonde.profile/1"},
      {{"simulate", "s.toml", "--json"}, "quadsonde.simulation/1"}};
  for (const auto& [arguments, schema] : calls) {
    const auto ended = quadsonde(arguments, folder.path());
    const auto json = nlohmann::json::parse(ended.out, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << arguments[0] << ended.out.substr(0, 200);
    EXPECT_EQ(json["schema"], schema);
  }
  const auto two = nlohmann::json::parse(quadsonde({"info", "a.csv", "a.csv", "--json"}, folder.path()).out);
  EXPECT_EQ(two.size(), 2u) << "several inputs: a list";
}

TEST(Answer, QuietSaysNothingOnStandardErrorButErrors) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  write_text(folder / "quadsonde.toml", "bin_m = 20\n");
  EXPECT_EQ(quadsonde({"profile", "a.csv", "--quiet"}, folder.path()).err, "");
  EXPECT_THAT(quadsonde({"profile", "none.csv", "--quiet"}, folder.path()).err, HasSubstr("error"));
}

TEST(Settings, OfTheFileBesideTheInputAreUsedAndFlagsWin) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  write_text(folder / "quadsonde.toml", "bin_m = 20\nleg = \"all\"\n");
  const auto from_file = quadsonde({"profile", "a.csv", "-o", "1.json"}, folder.path());
  EXPECT_THAT(from_file.err, HasSubstr("settings from"));
  EXPECT_EQ(nlohmann::json::parse(read_text(folder / "1.json"))["settings"]["bin_m"], 20);
  quadsonde({"profile", "a.csv", "-o", "2.json", "--bin-m", "5"}, folder.path());
  const auto flagged = nlohmann::json::parse(read_text(folder / "2.json"));
  EXPECT_EQ(flagged["settings"]["bin_m"], 5);
  EXPECT_EQ(flagged["settings"]["leg"], "all");
  EXPECT_EQ(flagged["rows"][0]["leg"], "all");
}

TEST(Settings, ThatNoVerbKnowsOrOutOfRangeAreRefusedWithTheirLine) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  for (const auto* text : {"leg = \"all\"\nbin_metres = 20\n", "leg = \"all\"\nbin_m = -3\n",
                           "leg = \"all\"\nbin_m = [1, 2]\n", "leg = \"all\"\nbin_m = = 3\n"}) {
    write_text(folder / "quadsonde.toml", text);
    const auto ended = quadsonde({"profile", "a.csv"}, folder.path());
    EXPECT_EQ(ended.code, 2) << text;
    EXPECT_THAT(ended.err, HasSubstr("line 2")) << text;
  }
  // A setting of another verb is no mistake: one file serves all.
  write_text(folder / "quadsonde.toml", "truth = \"t.csv\"\n");
  EXPECT_THAT(quadsonde({"profile", "a.csv"}, folder.path()).code, AnyOf(0, 3));
}

TEST(Vehicle, BesideTheLogIsUsedAndItsAbsenceIsSaid) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  EXPECT_THAT(quadsonde({"profile", "a.csv"}, folder.path()).out, HasSubstr("No vehicle file"));
  auto vehicle = ingest::published_vehicle();
  vehicle.name = "five-inch test quad", vehicle.method = "tunnel";
  write_text(folder / "vehicle.toml", ingest::to_toml(vehicle));
  EXPECT_THAT(quadsonde({"profile", "a.csv"}, folder.path()).out, HasSubstr("five-inch test quad"));
  EXPECT_EQ(quadsonde({"profile", "a.csv", "--vehicle", "none.toml"}, folder.path()).code, 1);
}

TEST(Simulate, WritesALogThatProfilesToTheWindOfItsTruth) {
  const support::TemporaryFolder folder;
  support::place_scenario(folder / "s.toml");
  ASSERT_EQ(quadsonde({"simulate", "s.toml", "-o", "s.mcap", "--truth", "t.csv"}, folder.path()).code, 0);
  const auto ended = quadsonde({"run", "s.mcap", "--reference", "t.csv", "-o", "out"}, folder.path());
  EXPECT_THAT(ended.code, AnyOf(0, 3)) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("Against t.csv"));
  const auto compare = nlohmann::json::parse(read_text(folder / "out/s/compare.json"));
  EXPECT_GT(compare["references"][0]["scores"]["n"], 500);
}

TEST(Convert, AndEstimateGiveTheSameTimesAndWindAsTheLogItself) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  EXPECT_THAT(quadsonde({"convert", "a.csv", "-o", "b.mcap"}, folder.path()).code, AnyOf(0, 3));
  quadsonde({"estimate", "a.csv", "-o", "a_wind.csv"}, folder.path());
  quadsonde({"estimate", "b.mcap", "-o", "b_wind.csv"}, folder.path());
  EXPECT_EQ(read_text(folder / "a_wind.csv"), read_text(folder / "b_wind.csv"));
}

TEST(Profile, GivesOnlyTheLegAskedForInTheChosenDatum) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  quadsonde({"profile", "a.csv", "-o", "up.csv", "--leg", "up", "--datum", "msl"}, folder.path());
  const auto text = read_text(folder / "up.csv");
  EXPECT_THAT(text, Not(HasSubstr("\ndown,")));
  EXPECT_THAT(text, HasSubstr("\nup,150.00,160.00,"));
}

TEST(Estimate, HasTheSameColumnsInEveryMode) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  std::string header;
  for (const std::string mode : {"smoothed", "causal", "classic"}) {
    quadsonde({"estimate", "a.csv", "--mode", mode, "-o", mode + ".csv"}, folder.path());
    const auto text = read_text(folder / (mode + ".csv"));
    if (header.empty()) header = text.substr(0, text.find('\n'));
    EXPECT_EQ(text.substr(0, text.find('\n')), header);
    EXPECT_THAT(text, HasSubstr("," + mode + ","));  // the columns behind it came later
  }
}

}  // namespace
}  // namespace quadsonde::cli
