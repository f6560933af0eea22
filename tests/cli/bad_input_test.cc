// Issue 2, point 10: each bad input gives one clear message with the next step and the exit code of CLI.md; nothing
// half-written stays behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::cli {
namespace {

using support::Ended;
using support::quadsonde;
using support::tree;
using support::write_text;
using testing::HasSubstr;

/// Runs `run LOG -o out` and expects no answer, one message, and a folder as it was.
Ended refused(const support::TemporaryFolder& folder, const std::string& log) {
  const auto before = tree(folder.path());
  const auto ended = quadsonde({"run", log, "-o", "out"}, folder.path());
  EXPECT_EQ(ended.code, 1) << ended.err;
  EXPECT_EQ(ended.out, "");
  EXPECT_THAT(ended.err, HasSubstr("error: " + log.substr(0, log.find(' '))));
  std::size_t errors = 0;
  for (auto at = ended.err.find("error:"); at != std::string::npos; at = ended.err.find("error:", at + 1)) ++errors;
  EXPECT_EQ(errors, 1u) << ended.err;
  for (const auto* forbidden : {"terminate", "what():", "std::", "Segmentation"})
    EXPECT_THAT(ended.err, testing::Not(HasSubstr(forbidden)));
  EXPECT_EQ(tree(folder.path()), before);
  return ended;
}

TEST(BadInput, AFileThatIsNotThere) {
  const support::TemporaryFolder folder;
  refused(folder, "nowhere.ulg");
}

TEST(BadInput, AnEmptyFile) {
  const support::TemporaryFolder folder;
  write_text(folder / "empty.ulg", "");
  EXPECT_THAT(refused(folder, "empty.ulg").err, HasSubstr("empty"));
}

TEST(BadInput, ATextFileNamedUlg) {
  const support::TemporaryFolder folder;
  write_text(folder / "notes.ulg", "Dear diary, today we flew.\n");
  EXPECT_THAT(refused(folder, "notes.ulg").err, HasSubstr("text"));
}

TEST(BadInput, ALogWithNoAttitude) {
  const support::TemporaryFolder folder;
  support::place_flight_without(folder / "log.csv", {"qw", "qx", "qy", "qz"});
  EXPECT_THAT(refused(folder, "log.csv").err, HasSubstr("attitude"));
}

TEST(BadInput, ALogWithNoPositionOrVelocity) {
  const support::TemporaryFolder folder;
  support::place_flight_without(folder / "log.csv", {"vn_m_s", "ve_m_s", "vd_m_s", "lat_deg", "lon_deg"});
  EXPECT_THAT(refused(folder, "log.csv").err, HasSubstr("velocity"));
}

TEST(BadInput, ACsvWithAMissingColumn) {
  const support::TemporaryFolder folder;
  support::place_flight_without(folder / "log.csv", {"qz"});
  EXPECT_THAT(refused(folder, "log.csv").err, HasSubstr("qz"));
  support::place_flight_without(folder / "log2.csv", {"time_s", "utc"});
  EXPECT_THAT(refused(folder, "log2.csv").err, HasSubstr("time"));
}

TEST(BadInput, NansInACsvCostThoseSamplesAndAreSaid) {
  const support::TemporaryFolder folder;
  support::place_changed_flight(folder / "log.csv", [](std::string line, std::size_t number) {
    if (number < 200 || number > 230) return line;
    // The first quaternion cell stands after time_s and utc.
    const auto second = line.find(',', line.find(',') + 1);
    return line.substr(0, second + 1) + "nan" + line.substr(line.find(',', second + 1));
  });
  const auto ended = quadsonde({"profile", "log.csv"}, folder.path());
  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("warning: "));
  EXPECT_THAT(ended.out, HasSubstr("quality"));
}

TEST(BadInput, AFixedWingLogIsRefusedByName) {
  QUADSONDE_NEEDS_DATA("logs/dataflash/pymavlink_test_plane.BIN");
  const support::TemporaryFolder folder;
  const auto log = support::data_file("logs/dataflash/pymavlink_test_plane.BIN");
  const auto ended = quadsonde({"run", log.string(), "-o", "out"}, folder.path());
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err, HasSubstr("fixed-wing"));
  EXPECT_TRUE(tree(folder.path()).empty());
}

TEST(BadInput, ALogCutInTheMiddleGivesWhatIsThereAndSaysWhereItEnds) {
  QUADSONDE_NEEDS_DATA("logs/ulog/esc_status_log.ulg");
  const support::TemporaryFolder folder;
  auto bytes = support::read_bytes(support::data_file("logs/ulog/esc_status_log.ulg"));
  bytes.resize(bytes.size() / 2);
  support::write_bytes(folder / "cut.ulg", bytes);
  const auto ended = quadsonde({"info", "cut.ulg"}, folder.path());
  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("byte"));
  EXPECT_THAT(ended.out, HasSubstr("ulog"));
}

TEST(BadInput, OneOfManyCostsOnlyItself) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "good.csv");
  write_text(folder / "empty.ulg", "");
  const auto ended = quadsonde({"run", "empty.ulg", "good.csv", "-o", "out"}, folder.path());
  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/good/profile.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/empty"));
}

/// One line, so that what is told can be looked for whatever its breaks.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::string plain;
  for (const char c : text)
    if (c != ' ' || plain.empty() || plain.back() != ' ') plain += c;
  return plain;
}

/// The flight of the tests on another path.
void place_path(const std::filesystem::path& csv, const std::string& path, bool from_ground = true) {
  auto toml = std::string(support::ascent_toml());
  toml = toml.substr(0, toml.find("[[path]]")) + path;
  if (!from_ground) toml.replace(toml.find("from_ground = true"), 18, "from_ground = false");
  write_text(csv, product::flight_csv(support::flown(toml).flight));
}
std::string climb_to(double height) {
  return "[[path]]\nkind = \"climb\"\nspeed_m_s = 1\nyaw_rate_deg_s = 20\nto_height_m = " + std::to_string(height) +
         "\n";
}
constexpr const char* hover = "[[path]]\nkind = \"hover\"\nduration_s = 30\nyaw_rate_deg_s = 20\n";

nlohmann::json json_of(const support::TemporaryFolder& folder, const std::string& log) {
  return nlohmann::json::parse(quadsonde({"profile", log, "--json", "--quiet"}, folder.path()).out);
}

TEST(BadProfile, OfAFlightThatNeverClimbsIsOneHeightAndSaysWhatWouldBeAProfile) {
  const support::TemporaryFolder folder;
  place_path(folder / "h.csv", hover);
  const auto ended = quadsonde({"profile", "h.csv"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err << "a hover is a sound flight";
  EXPECT_THAT(one_line(ended.out), HasSubstr("has no climb or descent of one bin (10 m)"));
  EXPECT_THAT(one_line(ended.out), HasSubstr("climb 100 m and more"));
  const auto json = json_of(folder, "h.csv");
  EXPECT_EQ(json["rows"].size(), 1u) << "no bin is invented";
  EXPECT_EQ(json["rows"][0]["leg"], "all");
  EXPECT_EQ(json["notes"].size(), 1u);
  const auto up = quadsonde({"profile", "h.csv", "--leg", "up"}, folder.path());
  EXPECT_EQ(up.code, 1);
  EXPECT_THAT(one_line(up.err), HasSubstr("never climbs or descends by one bin"));
}

TEST(BadProfile, OfAClimbOfFiveMetresNamesTheBinsThatWouldDo) {
  const support::TemporaryFolder folder;
  place_path(folder / "f.csv", climb_to(7) + hover + climb_to(2));
  const auto ended = quadsonde({"profile", "f.csv"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(one_line(ended.out), testing::ContainsRegex("stays between [0-2] and [78] m"));
  EXPECT_THAT(one_line(ended.out), HasSubstr("smaller bins with --bin-m 3"));
  EXPECT_EQ(json_of(folder, "f.csv")["rows"].size(), 1u);
  EXPECT_THAT(quadsonde({"profile", "f.csv", "--bin-m", "3"}, folder.path()).out, HasSubstr("ascent     descent"));
}

TEST(BadProfile, OfALogThatStartsInTheAirIsAboveTheSeaAndSaysHowToHaveItAboveTakeOff) {
  const support::TemporaryFolder folder;
  place_path(folder / "a.csv", climb_to(42) + climb_to(2), false);
  const auto ended = quadsonde({"profile", "a.csv"}, folder.path());
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(one_line(ended.err), HasSubstr("the height of the take-off point is not known"));
  EXPECT_THAT(one_line(ended.err), HasSubstr("--takeoff-msl"));
  const auto json = json_of(folder, "a.csv");
  EXPECT_EQ(json["datum"], "msl");
  for (const auto& row : json["rows"]) {
    EXPECT_TRUE(row["height_agl_m"].is_null());
    EXPECT_GE(row["bin_bottom_m"], 140);
  }
  EXPECT_TRUE(json["levels"]["winds"].empty()) << "10 m above what?";
  const auto told = quadsonde({"profile", "a.csv", "--takeoff-msl", "150"}, folder.path());
  EXPECT_THAT(told.out, HasSubstr("take-off, m"));
}

/// The flight of the tests, then 8 s on the ground, its height drifting evenly by so much over all of it.
void place_drifting_flight(const std::filesystem::path& csv, double metres) {
  support::place_flight(csv);
  std::istringstream lines(support::read_text(csv));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    auto& cells = rows.emplace_back();
    std::istringstream stream(line + ",");
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  }
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
  };
  const auto time = at("time_s"), utc = at("utc"), height = at("height_msl_m");
  for (int i = 1; i <= 80; ++i) {
    auto row = rows.back();
    row.at(time) = std::to_string(std::stod(row.at(time)) + 0.1);
    row.at(utc).clear();
    rows.push_back(row);
  }
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    auto& cell = rows[i].at(height);
    if (i > 0 && !cell.empty())
      cell = std::to_string(std::stod(cell) + metres * static_cast<double>(i) / static_cast<double>(rows.size()));
    for (std::size_t k = 0; k < rows[i].size(); ++k) text += (k ? "," : "") + rows[i][k];
    text += "\n";
  }
  write_text(csv, text);
}

TEST(BadProfile, OfABarometerThatDriftsMetresIsCorrectedAndSaysSo) {
  const support::TemporaryFolder folder;
  place_drifting_flight(folder / "clean.csv", 0);
  place_drifting_flight(folder / "drift.csv", 7);
  const auto ended = quadsonde({"profile", "drift.csv"}, folder.path());
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(one_line(ended.err), testing::ContainsRegex("height drift of \\+[567]\\.[0-9] m by the landing"));
  EXPECT_THAT(one_line(ended.err), HasSubstr("trust heights"));
  const auto json = json_of(folder, "drift.csv"), clean = json_of(folder, "clean.csv");
  ASSERT_TRUE(json["source"].contains("heights"));
  EXPECT_THAT(json["source"]["heights"].get<std::string>(), HasSubstr("taken off"));
  EXPECT_EQ(json["rows"].size(), clean["rows"].size()) << "no bin is invented above or below";
  EXPECT_EQ(json["rows"].back()["bin_top_m"], clean["rows"].back()["bin_top_m"]);
  for (const auto& row : json["rows"]) {
    if (row["samples"] > 0) {
      EXPECT_THAT(row["reasons"], testing::Contains("height_drift"));
    }
  }
}

TEST(BadProfile, OfTwoSitesInOneMergeIsRefusedWithTheirDistance) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "here.csv");
  support::place_changed_flight(folder / "there.csv", [](std::string line, std::size_t) {
    const auto at = line.find(",43.");
    return at == std::string::npos ? line : line.replace(at, 4, ",44.");
  });
  for (const auto* how : {"--merge", "--section"}) {
    const auto ended = quadsonde({"profile", "here.csv", "there.csv", how}, folder.path());
    EXPECT_EQ(ended.code, 2) << how;
    EXPECT_EQ(ended.out, "") << how;
    EXPECT_THAT(one_line(ended.err), HasSubstr("the flights are 111 km apart: that is two sites")) << how;
    EXPECT_THAT(one_line(ended.err), HasSubstr("merge the flights of one site")) << how;
  }
}

}  // namespace
}  // namespace quadsonde::cli
