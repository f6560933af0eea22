// Issue 2, point 10: each bad input gives one clear message with the next step and the exit code of CLI.md; nothing
// half-written stays behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace quadsonde::cli
