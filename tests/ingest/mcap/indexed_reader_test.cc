#include "ingest/mcap/indexed_reader.h"

#include <malloc.h>

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

TEST(McapIndexedReader, HoldsNothingForEachMessageOutsideOfChunksWhileTimesRise) {
  const auto held_by_reader = [](std::uint64_t late_by) {
    MemorySink sink;
    Writer writer(sink, unchunked());
    const auto channel = *writer.add_channel(0, "/one", "json");
    for (std::uint32_t i = 0; i < 50'000; ++i) {
      const std::uint64_t time = i == 10'000 ? 10'000 - late_by : i;
      (void)writer.write({channel, i, time, time, {}});
    }
    (void)writer.close();
    const auto held = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };
    const auto before = held();
    const auto reader = IndexedReader::open(sink.bytes());
    const auto after = held();
    auto cursor = reader->messages();
    std::uint64_t count = 0, last = 0;
    for (Message m; cursor.next(m); last = m.log_time, ++count) EXPECT_GE(m.log_time, last);
    EXPECT_EQ(count, 50'000u);
    return after - std::min(before, after);
  };
  EXPECT_LT(held_by_reader(0), 50'000u);
  // 16 bytes from the first inversion on, in a list that grows twofold.
  EXPECT_LT(held_by_reader(5), 2 * 16 * 40'000u + 50'000u);
}

TEST(McapIndexedReader, TakesAChunkAsItIsIfNoCrcIsAskedFor) {
  auto log = make_log({chunked(Compression::none)});
  log[chunks_of(log, 12)[2].end - 3] ^= 0x01;
  for (const bool check_crc : {true, false}) {
    const auto reader = IndexedReader::open(log, {Reading::tolerant, check_crc, 1u << 20, "log.mcap"});
    auto cursor = reader->messages();
    std::size_t count = 0;
    for (Message m; cursor.next(m);) ++count;
    EXPECT_EQ(count, check_crc ? 48u : 60u);
    EXPECT_EQ(cursor.problems().size(), check_crc ? 1u : 0u);
  }
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

/// Takes the CRC out of the footer.
void drop_summary_crc(std::vector<std::uint8_t>& log) {
  std::fill_n(log.end() - static_cast<std::ptrdiff_t>(kMagic.size()) - 4, 4, std::uint8_t{0});
}

TEST(McapIndexedReader, FindsWhatAFalseIndexEntryMissesAndSaysThatItIsFalse) {
  auto log = make_log({chunked(Compression::none)});
  // The summary's CRC is taken out, and the offset of the first metadata record is moved.
  const auto summary = read_summary(log);
  ASSERT_TRUE(summary);
  std::uint64_t at = summary->footer.summary_start;
  while (static_cast<Op>(log[at]) != Op::metadata_index) at = record_at(log, at)->end;
  log[at + kHeadSize] ^= 1;
  drop_summary_crc(log);
  const auto reader = IndexedReader::open(log);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->summary().metadata.size(), 5u);
  ASSERT_EQ(reader->problems().size(), 1u);
  EXPECT_EQ(reader->problems()[0].kind, Kind::doubtful);
}

TEST(McapIndexedReader, FindsWhatStandsWhereAFalseLengthPutsMessageIndexes) {
  auto writing = chunked(Compression::none);
  writing.attachment_index = false;
  auto log = make_log({writing});
  const auto summary = read_summary(log);
  std::uint64_t at = summary->footer.summary_start, last = 0;
  for (; at < log.size() - kTailSize; at = record_at(log, at)->end)
    if (static_cast<Op>(log[at]) == Op::chunk_index) last = at;
  const auto index = *parse_chunk_index(record_at(log, last)->content);
  const auto length = last + kHeadSize + 4 * 8 + 4 + 10 * index.message_index_offsets.size();
  log[length + 2] = 1;  // 64 KiB more, beyond the attachment
  EXPECT_TRUE(IndexedReader::open(log)->problems().size() == 1u) << "the CRC is believed, and differs";
  drop_summary_crc(log);
  const auto reader = IndexedReader::open(log);
  EXPECT_TRUE(reader->has_index());
  EXPECT_EQ(reader->summary().attachments.size(), 1u);
}

TEST(McapIndexedReader, GivesAChunkOnceThatTheIndexNamesTwice) {
  std::vector<Sample> samples;
  auto log = make_log({chunked(Compression::none)}, &samples);
  const auto summary = read_summary(log);
  std::vector<std::uint64_t> entries;
  for (auto at = summary->footer.summary_start; at < log.size() - kTailSize; at = record_at(log, at)->end)
    if (static_cast<Op>(log[at]) == Op::chunk_index) entries.push_back(at);
  // The second entry becomes the third once more; the chunk that it meant is found by the walk.
  std::copy_n(log.begin() + static_cast<std::ptrdiff_t>(entries[2]), entries[2] - entries[1],
              log.begin() + static_cast<std::ptrdiff_t>(entries[1]));
  drop_summary_crc(log);
  const auto reader = IndexedReader::open(log);
  ASSERT_TRUE(reader->has_index());
  EXPECT_EQ(taken(*reader, {}, Order::file), samples);
  EXPECT_EQ(reader->problems().size(), 1u);
}

TEST(McapIndexedReader, TellsWhereADamagedRecordStandsThatNoIndexCovers) {
  auto writing = unchunked();
  writing.metadata_index = false;
  auto log = make_log({writing});
  std::uint64_t at = kMagic.size();
  while (record_at(log, at)->op != Op::metadata) at = record_at(log, at)->end;
  log[at + kHeadSize + 3] = 0xFF;  // of the length of its name
  const auto reader = IndexedReader::open(log);
  ASSERT_EQ(reader->problems().size(), 1u);
  EXPECT_EQ(reader->problems()[0].where.byte, at);
  EXPECT_EQ(taken(*reader, {}, Order::file).size(), 60u);
}

TEST(McapIndexedReader, TellsWhereAMessageStandsThatIsOnNoChannel) {
  for (const bool rising : {true, false}) {
    auto log = make_log({unchunked()});
    std::uint64_t at = kMagic.size();
    for (int i = 0; i < 40; at = record_at(log, at)->end) i += record_at(log, at)->op == Op::message;
    log[at + kHeadSize + 1] = 0xFF;
    if (!rising) log[record_at(log, at)->end + kHeadSize + 6 + 1] = 0;  // the next one is early
    const auto reader = IndexedReader::open(log);
    for (const auto order : {Order::file, Order::log_time}) {
      auto cursor = reader->messages({}, order);
      std::size_t messages = 0;
      std::uint64_t time = 0;
      for (Message m; cursor.next(m); ++messages) {
        EXPECT_TRUE(order == Order::file || m.log_time >= time);
        time = m.log_time;
      }
      EXPECT_EQ(messages, 59u);
      ASSERT_EQ(cursor.problems().size(), 1u);
      EXPECT_EQ(cursor.problems()[0].where.byte, at);
    }
  }
}

TEST(McapIndexedReader, TellsOfAMessageShorterThanItsHeadInAChunkOutOfOrder) {
  std::vector<std::uint8_t> log;
  const auto put = [&log](auto number) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
    log.insert(log.end(), bytes, bytes + sizeof(number));
  };
  const auto put_op = [&](Op op, std::uint64_t length) { put(op), put(length); };
  constexpr std::uint64_t kChannel = 2 + 2 + 4 + 4 + 4, kRecords = 4 * kHeadSize + kChannel + 2 * kMessageHead + 3;
  log.assign(kMagic.begin(), kMagic.end());
  put_op(Op::header, 8), put(std::uint64_t{0});
  const auto chunk = log.size();
  put_op(Op::chunk, 3 * 8 + 4 + 4 + 8 + kRecords);
  put(std::uint64_t{10}), put(std::uint64_t{20}), put(kRecords), put(std::uint64_t{0}), put(kRecords);
  put_op(Op::channel, kChannel), put(std::uint16_t{1}), put(std::uint16_t{0}), put(std::uint64_t{0}), put(0);
  for (const std::uint64_t time : {20u, 10u})
    put_op(Op::message, kMessageHead), put(std::uint16_t{1}), put(0), put(time), put(time);
  put_op(Op::message, 3), put(std::uint16_t{1}), put(std::uint8_t{0});
  const auto reader = IndexedReader::open(log);
  auto cursor = reader->messages();
  std::vector<std::uint64_t> times;
  for (Message m; cursor.next(m);) times.push_back(m.log_time);
  EXPECT_EQ(times, (std::vector<std::uint64_t>{10, 20}));
  ASSERT_EQ(cursor.problems().size(), 1u);
  EXPECT_EQ(cursor.problems()[0].where.byte, chunk);
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
