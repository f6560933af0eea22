#include "export/isolated.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <vector>

#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

TEST(Isolated, HandsBackWhatTheWorkSays) {
  const auto long_text = isolated([] { return std::string(3'000'000, 'x'); });
  ASSERT_TRUE(long_text);
  EXPECT_EQ(long_text->size(), 3'000'000u);
}

TEST(Isolated, ACrashAHangAndAFloodStayOutside) {
  EXPECT_EQ(isolated([] { return ::raise(SIGSEGV), std::string("x"); }).error().kind, ingest::Kind::damaged);
  EXPECT_EQ(isolated([]() -> std::string { std::abort(); }).error().kind, ingest::Kind::damaged);
  EXPECT_EQ(isolated([]() -> std::string { throw 1; }).error().kind, ingest::Kind::damaged);
  IsolationLimits limits;
  limits.seconds = 0.2, limits.answer_bytes = 1000;
  EXPECT_EQ(isolated([]() -> std::string { return ::pause(), ""; }, limits).error().kind, ingest::Kind::limit);
  EXPECT_EQ(isolated([] { return std::string(5000, 'x'); }, limits).error().kind, ingest::Kind::limit);
}

#if !defined(__SANITIZE_ADDRESS__)
TEST(Isolated, MemoryHasALimit) {
  IsolationLimits limits;
  limits.memory_bytes = 64 << 20;
  const auto want = [](std::size_t bytes) { return std::string(std::to_string(std::vector<char>(bytes, 'x').size())); };
  EXPECT_FALSE(isolated([&] { return want(std::size_t{512} << 20); }, limits));
  EXPECT_TRUE(isolated([&] { return want(1 << 20); }, limits));
}
#endif

TEST(Isolated, WritesNoFile) {
  const support::TemporaryFolder folder;
  const auto target = folder / "x";
  (void)isolated([&] {
    std::ofstream(target) << "something" << std::flush;
    return std::string("done");
  });
  EXPECT_TRUE(!std::filesystem::exists(target) || std::filesystem::file_size(target) == 0);
}

}  // namespace
}  // namespace quadsonde::product
