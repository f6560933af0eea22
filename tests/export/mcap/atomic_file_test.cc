#include "export/atomic_file.h"

#include <fstream>

#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

std::string content_of(const std::filesystem::path& path) {
  const auto bytes = support::read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

TEST(AtomicFile, IsThereWholeAfterTheCommitAndNotBefore) {
  const support::TemporaryFolder folder;
  auto file = AtomicFile::create(folder / "a.csv");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write("one,"));
  ASSERT_TRUE(file->write("two"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(content_of(folder / "a.csv"), "one,two");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(AtomicFile, LeavesNothingWithoutACommit) {
  const support::TemporaryFolder folder;
  {
    auto file = AtomicFile::create(folder / "a.csv");
    ASSERT_TRUE(file->write("half"));
  }
  EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(AtomicFile, KeepsTheOldFileUntilTheNewOneIsWhole) {
  const support::TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a.csv", "old"));
  {
    auto file = AtomicFile::create(folder / "a.csv", true);
    ASSERT_TRUE(file->write("half"));
    EXPECT_EQ(content_of(folder / "a.csv"), "old");
  }
  EXPECT_EQ(content_of(folder / "a.csv"), "old");
  ASSERT_TRUE(write_file(folder / "a.csv", "new", true));
  EXPECT_EQ(content_of(folder / "a.csv"), "new");
}

TEST(AtomicFile, RefusesAnExistingTargetAsWrongUsage) {
  const support::TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a.csv", "old"));
  const auto refused = AtomicFile::create(folder / "a.csv");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
}

TEST(AtomicFile, RefusesATargetThatCameWhileItWasWritten) {
  const support::TemporaryFolder folder;
  auto file = AtomicFile::create(folder / "a.csv");
  ASSERT_TRUE(file->write("ours"));
  ASSERT_TRUE(write_file(folder / "a.csv", "theirs"));
  const auto refused = file->commit();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
  EXPECT_EQ(content_of(folder / "a.csv"), "theirs");
}

TEST(AtomicFile, RefusesAFolderAsTarget) {
  const support::TemporaryFolder folder;
  EXPECT_EQ(AtomicFile::create(folder.path(), true).error().kind, ingest::Kind::usage);
}

TEST(AtomicFile, ReplacesWhatALinkPointsToAndKeepsTheLink) {
  const support::TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "real.csv", "old"));
  std::filesystem::create_symlink(folder / "real.csv", folder / "link.csv");
  ASSERT_TRUE(write_file(folder / "link.csv", "new", true));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.csv"));
  EXPECT_EQ(content_of(folder / "real.csv"), "new");
}

TEST(AtomicFile, KeepsWhatALibraryWroteUnderItsTemporaryName) {
  const support::TemporaryFolder folder;
  auto file = AtomicFile::create(folder / "a.nc");
  std::ofstream(file->temporary_path(), std::ios::trunc) << "by a library";
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(content_of(folder / "a.nc"), "by a library");
}

TEST(AtomicFile, MovesWithItsTemporary) {
  const support::TemporaryFolder folder;
  auto first = AtomicFile::create(folder / "a.csv");
  AtomicFile second = std::move(*first);
  ASSERT_TRUE(second.write("moved"));
  ASSERT_TRUE(second.commit());
  EXPECT_EQ(content_of(folder / "a.csv"), "moved");
  EXPECT_FALSE(first->commit());
}

}  // namespace
}  // namespace quadsonde::product
