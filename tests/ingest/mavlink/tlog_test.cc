#include <gtest/gtest.h>

#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/mavlink/tlog_reader.h"
#include "tests/ingest/mavlink/mavlink_writer.h"

namespace quadsonde::ingest {
namespace {

using support::TlogWriter;

std::vector<std::uint8_t> sequences(Bytes bytes) {
  TlogReader reader(bytes);
  TlogRecord record;
  std::vector<std::uint8_t> all;
  while (reader.next(record)) all.push_back(record.frame.sequence);
  return all;
}

TEST(TlogReader, KeepsEveryCompleteFrameOfACutFile) {
  TlogWriter log;
  log.fly();
  std::vector<std::size_t> ends;
  TlogReader whole(log.bytes);
  TlogRecord record;
  while (whole.next(record)) ends.push_back(whole.at());
  ASSERT_EQ(ends.size(), 151u);
  for (std::size_t cut = 0; cut <= log.bytes.size(); ++cut) {
    TlogReader reader(Bytes(log.bytes).first(cut));
    while (reader.next(record)) {
    }
    const auto complete = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), cut) - ends.begin());
    ASSERT_EQ(reader.frames(), complete) << "cut at " << cut;
    ASSERT_EQ(reader.trailing_partial_bytes(), cut - (complete == 0 ? 0 : ends[complete - 1]));
    ASSERT_EQ(reader.skipped_bytes(), 0u);
  }
}

TEST(TlogReader, LosesNoFrameToGarbageBetweenThem) {
  TlogWriter log;
  log.fly();
  const auto clean = sequences(log.bytes);
  TlogReader reader(log.bytes);
  TlogRecord record;
  for (int i = 0; i < 60; ++i) reader.next(record);
  auto bytes = log.bytes;
  std::vector<std::uint8_t> garbage;
  for (int i = 0; i < 333; ++i) garbage.push_back(static_cast<std::uint8_t>(i * 29 + 3));
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(reader.at()), garbage.begin(), garbage.end());
  EXPECT_EQ(sequences(bytes), clean);
}

TEST(TlogReader, StepsOverAFrameWhoseDialectItDoesNotKnow) {
  TlogWriter log;
  log.heartbeat();
  auto foreign = support::mavlink_frame("ATTITUDE", {{"yaw", 1}});
  foreign[7] = 3;
  log.record(foreign);
  log.heartbeat();
  TlogReader reader(log.bytes);
  TlogRecord record;
  while (reader.next(record)) {
  }
  EXPECT_EQ(reader.frames(), 2u);
  EXPECT_EQ(reader.rejected(), 1u);
  EXPECT_EQ(reader.skipped_bytes(), 0u);
}

TEST(TlogReader, IsRecognisedBehindAFrameOfAForeignDialect) {
  TlogWriter log;
  auto foreign = support::mavlink_frame("ATTITUDE", {{"yaw", 1}});
  foreign[7] = 3;
  log.record(foreign);
  EXPECT_FALSE(looks_like_tlog(log.bytes));
  log.heartbeat();
  EXPECT_TRUE(looks_like_tlog(log.bytes));
}

TEST(TlogReader, LosesOnlyTheFrameThatIsDamaged) {
  TlogWriter log;
  log.fly();
  const auto clean = sequences(log.bytes);
  TlogReader reader(log.bytes);
  TlogRecord record;
  for (int i = 0; i < 60; ++i) reader.next(record);
  const std::size_t from = reader.at();
  reader.next(record);
  const auto lost = record.frame.sequence;
  // Whichever of its bytes behind the host's time is wrong: the checksum covers them all.
  for (std::size_t at = from + 8; at < reader.at(); ++at) {
    auto bytes = log.bytes;
    bytes[at] ^= 0x21;
    auto expected = clean;
    expected.erase(std::find(expected.begin(), expected.end(), lost));
    ASSERT_EQ(sequences(bytes), expected) << "byte " << at - from;
  }
}

TEST(TlogReader, IsRecognisedByAFrameWithARightChecksum) {
  TlogWriter log;
  log.heartbeat();
  EXPECT_TRUE(looks_like_tlog(log.bytes));
  EXPECT_FALSE(looks_like_tlog(Bytes(log.bytes).first(12)));
  log.bytes[12] ^= 1;
  EXPECT_FALSE(looks_like_tlog(log.bytes));
  EXPECT_FALSE(read_mavlink(log.bytes, "x.tlog"));
  EXPECT_FALSE(looks_like_tlog({}));
}

}  // namespace
}  // namespace quadsonde::ingest
