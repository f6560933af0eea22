#include "ingest/flight/bytes.h"

#include <gtest/gtest.h>

#include <limits>

#include "ingest/flight/problem.h"

namespace quadsonde::ingest {
namespace {

TEST(Cursor, MovesOnlyWhenTheBytesAreThere) {
  const std::uint8_t raw[] = {1, 0, 0, 0, 2};
  Cursor cursor{Bytes(raw)};
  std::uint32_t word = 0;
  ASSERT_TRUE(cursor.get(word));
  EXPECT_EQ(word, 1u);
  std::uint16_t half = 7;
  EXPECT_FALSE(cursor.get(half));
  EXPECT_EQ(half, 7) << "nothing is written where nothing was read";
  EXPECT_EQ(cursor.at(), 4u);
  std::uint8_t last = 0;
  EXPECT_TRUE(cursor.get(last));
  EXPECT_EQ(cursor.left(), 0u);
}

TEST(Cursor, RefusesLengthsThatNoFileCanHold) {
  const std::uint8_t raw[] = {1, 2, 3};
  Cursor cursor{Bytes(raw)};
  Bytes out;
  EXPECT_FALSE(cursor.get_bytes(std::numeric_limits<std::uint64_t>::max(), out));
  EXPECT_FALSE(cursor.skip(4));
  EXPECT_TRUE(cursor.skip(3));
  EXPECT_EQ(Cursor(Bytes(raw), 99).left(), 0u);
}

TEST(Problem, IsOneSentenceWithItsPlace) {
  const Problem p{Kind::damaged, "the chunk is cut off", {"a.mcap", 17, {}, "velocity"}, "use --recover"};
  EXPECT_EQ(to_string(p), "a.mcap, byte 17, velocity: the chunk is cut off. use --recover.");
  EXPECT_EQ(to_string(Problem{Kind::usage, "nothing given", {}, {}}), "nothing given.");
  EXPECT_EQ(to_string(Where{"a.csv", {}, 3, {}}), "a.csv, line 3");
}

}  // namespace
}  // namespace quadsonde::ingest
