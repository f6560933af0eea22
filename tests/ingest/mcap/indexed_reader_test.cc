#include "ingest/mcap/indexed_reader.h"

#include <algorithm>
#include <random>

#include "sample_logs.h"
#include "tests/support/data.h"

namespace quadsonde::ingest::mcap {
namespace {

/// Chunks of eight messages whose times jump about: within a chunk, over chunks, and with repeats.
std::vector<std::uint8_t> jumbled_log(const WriterSettings& writing, std::vector<Sample>& samples, std::uint64_t spread) {
  MemorySink sink;
  Writer writer(sink, writing);
  const auto one = *writer.add_channel(0, "/one", "json"), two = *writer.add_channel(0, "/two", "json");
  std::mt19937 random(7);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const auto time = 1000 + 10 * (i / 8) + random() % spread;
    const auto data = fmt::format("{}", i);
    (void)writer.write({i % 2 ? two : one, i, time, time, as_bytes(data)});
    samples.push_back({i % 2 ? "/two" : "/one", i, time, data});
    if (i % 8 == 7 && writing.chunked) (void)writer.add_metadata("end of a chunk", {});
  }
  (void)writer.close();
  return sink.bytes();
}

std::vector<Sample> taken(const IndexedReader& reader, const Selection& selection, Order order) {
  std::vector<Sample> samples;
  auto cursor = reader.messages(selection, order);
  for (Message m; cursor.next(m);)
    samples.push_back({cursor.registry().channel(m.channel_id)->topic, m.sequence, m.log_time, std::string(as_text(m.data))});
  EXPECT_TRUE(cursor.problems().empty());
  return samples;
}

std::vector<WriterSettings> kinds() {
  auto without_chunk_index = chunked(Compression::none);
  without_chunk_index.chunk_index = false;
  auto bare = chunked(Compression::lz4);
  bare.message_index = bare.repeat_channels = bare.statistics = false;
  return {unchunked(), chunked(Compression::none), chunked(Compression::zstd), without_chunk_index, bare};
}

TEST(McapIndexedReader, GivesTheOrderOfAStableSortByTime) {
  for (const auto& writing : kinds()) {
    for (const std::uint64_t spread : {1u, 7u, 60u, 1000u}) {
      std::vector<Sample> samples;
      const auto log = jumbled_log(writing, samples, spread);
      const auto reader = IndexedReader::open(log);
      ASSERT_TRUE(reader);
      EXPECT_EQ(taken(*reader, {}, Order::file), samples);
      std::ranges::stable_sort(samples, {}, &Sample::log_time);
      EXPECT_EQ(taken(*reader, {}, Order::log_time), samples) << spread;
    }
  }
}

TEST(McapIndexedReader, GivesOnlyTheTopicsAndTimesAskedFor) {
  for (const auto& writing : kinds()) {
    std::vector<Sample> samples;
    const auto log = jumbled_log(writing, samples, 60);
    const auto reader = IndexedReader::open(log);
    std::ranges::stable_sort(samples, {}, &Sample::log_time);
    std::erase_if(samples, [](const Sample& s) { return s.topic != "/two" || s.log_time < 1050 || s.log_time > 1150; });
    EXPECT_EQ(taken(*reader, {{"/two"}, 1050, 1150}, Order::log_time), samples);
    EXPECT_TRUE(taken(*reader, {{"/none"}, 0, UINT64_MAX}, Order::log_time).empty());
  }
}

TEST(McapIndexedReader, HoldsNoMoreThanTheChunksThatOverlap) {
  std::vector<Sample> samples;
  LogShape shape{chunked(Compression::zstd), 50, 1000, false};
  const auto log = make_log(shape, &samples);
  const auto reader = IndexedReader::open(log);
  std::uint64_t largest = 0;
  for (const auto& chunk : reader->summary().chunks) largest = std::max(largest, chunk.uncompressed_size);
  auto cursor = reader->messages();
  std::size_t count = 0;
  for (Message m; cursor.next(m);) ++count;
  EXPECT_EQ(count, samples.size());
  // One chunk that ends while the next begins.
  EXPECT_LE(cursor.peak_bytes(), 2 * largest);
}

TEST(McapIndexedReader, UnpacksOnlyChunksThatMayHoldWhatIsAskedFor) {
  std::vector<Sample> samples;
  auto log = make_log({chunked(Compression::zstd)}, &samples);
  const auto chunks = chunks_of(log, 12);
  // Damage in the third chunk is not met by who asks for the first two.
  log[chunks[2].end - 3] ^= 0xFF;
  const auto reader = IndexedReader::open(log);
  ASSERT_TRUE(reader);
  EXPECT_EQ(taken(*reader, {{}, 0, samples[23].log_time}, Order::log_time).size(), 24u);
  auto all = reader->messages();
  std::size_t count = 0;
  for (Message m; all.next(m);) ++count;
  EXPECT_EQ(count, 48u);
  ASSERT_EQ(all.problems().size(), 1u);
  EXPECT_EQ(all.problems()[0].where.byte, chunks[2].begin);
}

TEST(McapIndexedReader, ReadsACutFileByWalkingOverIt) {
  std::vector<Sample> samples;
  const auto log = make_log({chunked(Compression::lz4)}, &samples);
  const auto chunks = chunks_of(log, 12);
  const auto reader = IndexedReader::open(Bytes(log).first(chunks[4].begin + 20));
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->has_index());
  EXPECT_EQ(taken(*reader, {}, Order::log_time).size(), 48u);
  EXPECT_FALSE(reader->problems().empty());
}

TEST(McapIndexedReader, FindsWhatAFalseIndexEntryMissesAndSaysThatItIsFalse) {
  auto log = make_log({chunked(Compression::none)});
  // The summary's CRC is taken out, and the offset of the first metadata record is moved.
  const auto summary = read_summary(log);
  ASSERT_TRUE(summary);
  std::uint64_t at = summary->footer.summary_start;
  while (static_cast<Op>(log[at]) != Op::metadata_index) at = record_at(log, at)->end;
  log[at + kHeadSize] ^= 1;
  for (int i = 0; i < 4; ++i) log[log.size() - kMagic.size() - 4 + static_cast<std::size_t>(i)] = 0;
  const auto reader = IndexedReader::open(log);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->summary().metadata.size(), 5u);
  ASSERT_EQ(reader->problems().size(), 1u);
  EXPECT_EQ(reader->problems()[0].kind, Kind::doubtful);
}

TEST(McapIndexedReader, ChecksTheCrcOfAttachments) {
  auto log = make_log({chunked(Compression::none)});
  const auto intact = IndexedReader::open(log);
  ASSERT_EQ(intact->summary().attachments.size(), 1u);
  const auto index = intact->summary().attachments[0];
  EXPECT_EQ(as_text(intact->attachment(index)->data), "an attachment");
  auto damaged = log;
  damaged[index.offset + index.length - 6] ^= 1;
  EXPECT_EQ(IndexedReader::open(damaged)->attachment(index).error().kind, Kind::damaged);
}

TEST(McapIndexedReader, RefusesWhatIsNoMcap) {
  EXPECT_EQ(IndexedReader::open(as_bytes("no log at all")).error().kind, Kind::not_a_log);
}

}  // namespace
}  // namespace quadsonde::ingest::mcap
