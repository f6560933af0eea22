// `quadsonde archive` as its users meet it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "tests/export/archive/made_up_netcdf.h"
#include "tests/support/data.h"

namespace quadsonde::cli {
namespace {

using testing::HasSubstr;

struct Ended {
  int code = -1;
  std::string out, err;
};

Ended archive(const support::TemporaryFolder& folder, const std::string& arguments) {
  const auto text_of = [&](const char* name) {
    const auto bytes = support::read_bytes(folder / name);
    return std::string(bytes.begin(), bytes.end());
  };
  const int status = std::system(
      ("cd '" + folder.path().string() + "' && '" QUADSONDE_PROGRAM "' archive " + arguments + " > .out 2> .err")
          .c_str());
  return {WEXITSTATUS(status), text_of(".out"), text_of(".err")};
}

void place(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(ArchiveVerb, AddsListsQueriesExportsVerifiesAndRebuilds) {
  const support::TemporaryFolder folder;
  place(folder / "out/flight-1/profile.nc", support::made_up_netcdf({1}));
  place(folder / "out/flight-2/profile.nc", support::made_up_netcdf({2}));
  place(folder / "x.nc", support::made_up_netcdf({3}));
  const auto added = archive(folder, "add a out x.nc");
  EXPECT_EQ(added.code, 0) << added.err;
  EXPECT_EQ(std::count(added.out.begin(), added.out.end(), '\n'), 3);
  EXPECT_THAT(archive(folder, "add a x.nc").out, HasSubstr("already there"));
  EXPECT_THAT(archive(folder, "list a").out, HasSubstr("3 profiles of 3 flights"));
  EXPECT_THAT(archive(folder, "query a --from 2025-06-15T18:00Z --json").out, HasSubstr("quadsonde.archive_list/1"));
  EXPECT_EQ(archive(folder, "query a --near 43.59,1.48 --within-km 1 -o q.csv").code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "q.csv"));
  EXPECT_EQ(archive(folder, "export a -o b --max-height-m 100").code, 0);
  EXPECT_EQ(archive(folder, "verify b").code, 0);
  EXPECT_EQ(archive(folder, "export a -o all.nc").code, 0);
  EXPECT_EQ(archive(folder, "export a -o all.nc").code, 2) << "nothing is overwritten unasked";
  place(folder / "a/note.txt", "x");
  const auto verified = archive(folder, "verify a");
  EXPECT_EQ(verified.code, 3);
  EXPECT_THAT(verified.out, HasSubstr("foreign     note.txt"));
  EXPECT_EQ(archive(folder, "rebuild a").code, 0);
}

TEST(ArchiveVerb, SaysWhatIsWrongWithAnInputAndTakesTheOthers) {
  const support::TemporaryFolder folder;
  place(folder / "good.nc", support::made_up_netcdf({1}));
  place(folder / "bad.nc", support::made_up_netcdf({2}).substr(0, 3000));
  place(folder / "text.nc", "no netCDF at all");
  std::filesystem::create_directory(folder / "empty");
  const auto ended = archive(folder, "add a text.nc bad.nc empty nowhere.nc good.nc");
  EXPECT_EQ(ended.code, 3);
  EXPECT_EQ(std::count(ended.out.begin(), ended.out.end(), '\n'), 1);
  for (const auto* file : {"text.nc", "bad.nc", "empty", "nowhere.nc"}) EXPECT_THAT(ended.err, HasSubstr(file));
  EXPECT_EQ(archive(folder, "add b text.nc").code, 1);
  EXPECT_EQ(archive(folder, "add good.nc good.nc").code, 2) << "a file is no archive";
  EXPECT_EQ(archive(folder, "list nowhere").code, 2);
  EXPECT_EQ(archive(folder, "query a --box 1,2").code, 2);
  EXPECT_EQ(archive(folder, "fly a").code, 2);
  EXPECT_EQ(archive(folder, "").code, 2);
}

TEST(ArchiveVerb, EveryHelpFitsIn80Columns) {
  const support::TemporaryFolder folder;
  for (const auto* action : {"", "add", "list", "query", "export", "verify", "rebuild"}) {
    const auto help = archive(folder, std::string(action) + " --help");
    EXPECT_EQ(help.code, 0) << action;
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  }
}

}  // namespace
}  // namespace quadsonde::cli
