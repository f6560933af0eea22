// Outputs: never half-written, never overwritten unasked, the same every time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

#include "tests/cli/program.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::cli {
namespace {

using support::quadsonde;
using support::read_text;
using support::tree;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(Outputs, AreNeverOverwrittenWithoutForce) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  support::place_scenario(folder / "s.toml");
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"profile", "a.csv", "-o", "x.csv"},
                                             {"estimate", "a.csv", "-o", "x.json"},
                                             {"convert", "a.csv", "-o", "x.mcap"},
                                             {"simulate", "s.toml", "-o", "y.mcap", "--truth", "t.csv"},
                                             {"info", "a.csv", "-o", "i.json"}}) {
    support::write_text(folder / arguments[3], "mine");
    const auto refused = quadsonde(arguments, folder.path());
    EXPECT_EQ(refused.code, 2) << arguments[0] << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("--force"));
    EXPECT_EQ(read_text(folder / arguments[3]), "mine") << arguments[0];
    auto forced = arguments;
    forced.push_back("--force");
    const auto done = quadsonde(forced, folder.path());
    EXPECT_THAT(done.code, testing::AnyOf(0, 3)) << arguments[0] << done.err;
    EXPECT_NE(read_text(folder / arguments[3]), "mine") << arguments[0];
  }
  EXPECT_EQ(tree(folder.path()),
            (std::vector<std::string>{"a.csv", "i.json", "s.toml", "t.csv", "x.csv", "x.json", "x.mcap", "y.mcap"}));
}

TEST(Outputs, OfTwoRunsAreEqualByteForByte) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  support::place_scenario(folder / "s.toml");
  for (const auto* out : {"1", "2"}) {
    fs::create_directory(folder / out);
    const std::string at = out;
    EXPECT_NE(quadsonde({"run", "a.csv", "-o", at + "/run"}, folder.path()).code, 1);
    EXPECT_NE(quadsonde({"profile", "a.csv", "-o", at + "/p.json"}, folder.path()).code, 1);
    EXPECT_NE(quadsonde({"profile", "a.csv", "-o", at + "/p.html"}, folder.path()).code, 1);
    EXPECT_NE(quadsonde({"estimate", "a.csv", "-o", at + "/w.svg"}, folder.path()).code, 1);
    EXPECT_NE(quadsonde({"convert", "a.csv", "-o", at + "/c.csv"}, folder.path()).code, 1);
    EXPECT_NE(quadsonde({"simulate", "s.toml", "-o", at + "/s.mcap", "--truth", at + "/t.csv"}, folder.path()).code, 1);
  }
  const auto files = tree(folder / "1");
  EXPECT_EQ(files, tree(folder / "2"));
  EXPECT_GE(files.size(), 12u);
  for (const auto& file : files) {
    if (fs::is_directory(folder / "1" / file)) continue;
    EXPECT_EQ(read_text(folder / "1" / file), read_text(folder / "2" / file)) << file;
  }
}

TEST(Outputs, IntoAFolderThatCannotBeWrittenLeaveNothing) {
  if (::geteuid() == 0) GTEST_SKIP() << "nothing is forbidden to root";
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  fs::create_directory(folder / "locked");
  fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  const auto ended = quadsonde({"run", "a.csv", "-o", "locked"}, folder.path());
  EXPECT_EQ(ended.code, 1);
  EXPECT_EQ(tree(folder.path()), (std::vector<std::string>{"a.csv", "locked"}));
}

TEST(Outputs, WhereNothingCanBeMadeAreAProblemThatNamesThePlace) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  const auto file = quadsonde({"profile", "a.csv", "-o", "/proc/x.csv"}, folder.path());
  EXPECT_EQ(file.code, 1) << file.err;
  EXPECT_THAT(file.err, HasSubstr("/proc/x.csv"));
  const auto run = quadsonde({"run", "a.csv", "-o", "/proc/x"}, folder.path());
  EXPECT_EQ(run.code, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("/proc/x"));
  EXPECT_EQ(tree(folder.path()), std::vector<std::string>{"a.csv"});
}

TEST(Outputs, OnADiskThatFillsUpInTheMiddleLeaveNothing) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  support::place_scenario(folder / "s.toml");
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"run", "a.csv", "-o", "out"},
                                             {"estimate", "a.csv", "-o", "w.csv"},
                                             {"convert", "a.csv", "-o", "c.mcap"},
                                             {"simulate", "s.toml", "-o", "s.csv", "--truth", "t.csv"}}) {
    const auto ended = support::quadsonde_on_full_disk(arguments, folder.path(), 20'000);
    EXPECT_EQ(ended.code, 1) << arguments[0] << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("cannot write")) << arguments[0];
    EXPECT_EQ(tree(folder.path()), (std::vector<std::string>{"a.csv", "s.toml"})) << arguments[0];
  }
}

TEST(Interrupt, EndsWith130WithinASecondAndLeavesNothing) {
  const support::TemporaryFolder folder;
  // Two hours at 10 Hz: minutes of work, so the interrupt meets it at work.
  support::write_text(folder / "long.toml",
                      "start_height_m = 10\n[wind]\nspeed_m_s = 4\nfrom_deg = 20\n[[path]]\nkind = "
                      "\"hover\"\nduration_s = 7200\nyaw_rate_deg_s = 20\n");
  ASSERT_EQ(quadsonde({"simulate", "long.toml", "-o", "long.mcap"}, folder.path()).code, 0);
  const auto before = tree(folder.path());
  for (const double after : {0.05, 0.3, 1.0}) {
    const auto started = std::chrono::steady_clock::now();
    const auto ended = quadsonde({"run", "long.mcap", "-o", "out"}, folder.path(), after);
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    EXPECT_EQ(ended.code, 130) << after << ended.err;
    EXPECT_LT(took - after, 10) << "within a second where the machine is not busy with other tests";
    EXPECT_EQ(tree(folder.path()), before) << after;
  }
}

// Standard error into a pipe that nobody reads ended the program with SIGABRT: fmt throws where stdio only says no.
TEST(Output, IntoAClosedPipeEndsWithTheExitCodeOfTheAnswer) {
  const support::TemporaryFolder folder;
  support::write_text(folder / "run.sh", "{ '" QUADSONDE_PROGRAM "' info missing.ulg 2>&1; echo $? > code; } | true\n");
  const std::string command = "cd '" + folder.path().string() + "' && bash run.sh";
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(support::read_bytes(folder / "code"), (std::vector<std::uint8_t>{'1', '\n'}));
  }
}

}  // namespace
}  // namespace quadsonde::cli
