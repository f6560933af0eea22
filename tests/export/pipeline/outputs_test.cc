#include "export/pipeline/outputs.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

using support::read_text;
namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(Outputs, AppearTogetherAndOnlyAtTheCommit) {
  const support::TemporaryFolder folder;
  Outputs outputs(false, {});
  ASSERT_TRUE(outputs.make_folder(folder / "a/b"));
  ASSERT_TRUE(outputs.add(folder / "a/b/one.txt", "1"));
  ASSERT_TRUE(outputs.add(folder / "a/b/two.txt", "2"));
  EXPECT_FALSE(fs::exists(folder / "a/b/one.txt"));
  ASSERT_TRUE(outputs.commit());
  EXPECT_EQ(read_text(folder / "a/b/one.txt"), "1");
  EXPECT_EQ(read_text(folder / "a/b/two.txt"), "2");
  EXPECT_EQ(entries(folder / "a/b"), 2u) << "no temporary file stays";
}

TEST(Outputs, WithoutACommitLeaveNeitherFilesNorFolders) {
  const support::TemporaryFolder folder;
  {
    Outputs outputs(false, {});
    ASSERT_TRUE(outputs.make_folder(folder / "a/b"));
    ASSERT_TRUE(outputs.add(folder / "a/b/one.txt", std::string(3 << 20, 'x')));
  }
  EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(Outputs, NeverReplaceAFileUnlessAllowed) {
  const support::TemporaryFolder folder;
  support::write_text(folder / "one.txt", "old");
  {
    Outputs outputs(false, {});
    const auto refused = outputs.add(folder / "one.txt", "new");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
  }
  EXPECT_EQ(read_text(folder / "one.txt"), "old");
  Outputs outputs(true, {});
  ASSERT_TRUE(outputs.add(folder / "one.txt", "new"));
  EXPECT_EQ(read_text(folder / "one.txt"), "old") << "until the commit";
  ASSERT_TRUE(outputs.commit());
  EXPECT_EQ(read_text(folder / "one.txt"), "new");
}

TEST(Outputs, BeginNothingOnceStopped) {
  const support::TemporaryFolder folder;
  const std::atomic<bool> stop{true};
  std::atomic<int> writing{0};
  const Control control{{}, &stop, &writing};
  {
    Outputs outputs(false, control);
    EXPECT_EQ(writing, 1);
    EXPECT_FALSE(outputs.make_folder(folder / "a"));
    EXPECT_FALSE(outputs.add(folder / "one.txt", "1"));
    EXPECT_FALSE(outputs.add_flight(folder / "flight.mcap", support::flown().flight));
    EXPECT_FALSE(outputs.commit());
  }
  EXPECT_EQ(writing, 0);
  EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(Outputs, StoppedAfterTheyBeganTakeEverythingBack) {
  const support::TemporaryFolder folder;
  std::atomic<bool> stop{false};
  const Control control{{}, &stop, nullptr};
  {
    Outputs outputs(false, control);
    ASSERT_TRUE(outputs.add(folder / "one.txt", "1"));
    stop = true;
    EXPECT_FALSE(outputs.commit());
  }
  EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(Outputs, SayWhichFolderCannotBeWritten) {
  const support::TemporaryFolder folder;
  support::write_text(folder / "file", "");
  Outputs outputs(false, {});
  const auto refused = outputs.make_folder(folder / "file");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where.file, (folder / "file").string());
  EXPECT_FALSE(outputs.make_folder(folder / "file/below"));
  EXPECT_FALSE(outputs.add("/proc/nothing/x", "1"));
}

}  // namespace
}  // namespace quadsonde::product
