// What comes out of cut, flipped and malicious files.
#include <malloc.h>

#include <algorithm>

#include "ingest/mcap/indexed_reader.h"
#include "ingest/mcap/recover.h"
#include "sample_logs.h"
#include "tests/support/data.h"

namespace quadsonde::ingest::mcap {
namespace {

/// Whether every message of `some` is in `all`.
bool holds(std::vector<Sample> all, std::vector<Sample> some) {
  std::ranges::sort(all);
  std::ranges::sort(some);
  return std::ranges::includes(all, some);
}

Bytes front_of(const std::vector<std::uint8_t>& log, std::size_t size) { return Bytes(log).first(size); }

/// Ends of the message records of an unchunked log, or of the chunks' insides where they are not compressed.
std::vector<std::uint64_t> message_ends(Bytes log) {
  std::vector<std::uint64_t> ends;
  std::uint64_t at = kMagic.size();
  while (const auto raw = record_at(log, at)) {
    if (raw->op == Op::footer) break;
    if (raw->op == Op::message) ends.push_back(raw->end);
    if (raw->op == Op::chunk) {
      const auto chunk = parse_chunk(raw->content);
      const auto base = static_cast<std::uint64_t>(chunk->records.data() - log.data());
      std::uint64_t inner = 0;
      while (const auto record = record_at(chunk->records, inner)) {
        if (record->op == Op::message) ends.push_back(base + record->end);
        inner = record->end;
      }
    }
    at = raw->end;
  }
  return ends;
}

TEST(McapDamage, KeepsEveryCompleteMessageOfAnUncompressedLogCutAnywhere) {
  for (const auto& writing : {unchunked(), chunked(Compression::none)}) {
    std::vector<Sample> samples;
    const auto log = make_log({writing}, &samples);
    const auto ends = message_ends(log);
    ASSERT_EQ(ends.size(), samples.size());
    for (const auto mode : {Reading::tolerant, Reading::salvage}) {
      for (std::size_t size = 0; size < log.size(); ++size) {
        const auto read = read_all(front_of(log, size), mode);
        const auto whole = static_cast<std::size_t>(std::ranges::upper_bound(ends, size) - ends.begin());
        const std::vector<Sample> expected(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(whole));
        auto got = read.sound;  // what comes from the cut chunk comes last
        got.insert(got.end(), read.unsound.begin(), read.unsound.end());
        ASSERT_EQ(got, expected) << "cut at " << size;
        ASSERT_FALSE(read.problems.empty()) << "cut at " << size;
        ASSERT_FALSE(read.complete);
      }
    }
  }
}

TEST(McapDamage, KeepsEveryCompleteChunkOfACompressedLogCutAnywhere) {
  for (const auto compression : {Compression::lz4, Compression::zstd}) {
    std::vector<Sample> samples;
    const auto log = make_log({chunked(compression)}, &samples);
    const auto chunks = chunks_of(log, 12);
    ASSERT_EQ(chunks.size(), 5u);
    for (std::size_t size = 0; size < log.size(); ++size) {
      const auto read = read_all(front_of(log, size), Reading::tolerant);
      std::size_t whole = 0;
      for (const auto& chunk : chunks) whole += chunk.end <= size ? chunk.messages : 0;
      const std::vector<Sample> expected(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(whole));
      ASSERT_EQ(read.sound, expected) << "cut at " << size;
      ASSERT_TRUE(holds(samples, read.unsound)) << "cut at " << size;
      ASSERT_FALSE(read.problems.empty()) << "cut at " << size;
    }
  }
}

TEST(McapDamage, UnpacksTheFrontOfACutCompressedChunk) {
  for (const auto compression : {Compression::lz4, Compression::zstd}) {
    LogShape shape{chunked(compression), 1, 30000, false};
    std::vector<Sample> samples;
    const auto log = make_log(shape, &samples);
    const auto chunk = chunks_of(log, 30000).front();
    const auto read = read_all(front_of(log, chunk.begin + (chunk.end - chunk.begin) * 3 / 4), Reading::tolerant);
    EXPECT_TRUE(read.sound.empty());
    EXPECT_GT(read.unsound.size(), 10000u);
    EXPECT_EQ(read.counts.salvaged, read.unsound.size());
    EXPECT_TRUE(std::ranges::equal(read.unsound, std::span(samples).first(read.unsound.size())));
  }
}

/// The index of the chunk that holds a byte, or -1.
int chunk_at(const std::vector<ChunkSpan>& chunks, std::size_t byte) {
  for (std::size_t i = 0; i < chunks.size(); ++i)
    if (byte >= chunks[i].begin && byte < chunks[i].end) return static_cast<int>(i);
  return -1;
}

/// The messages that a flipped byte must not touch: those of the other chunks.
std::vector<Sample> outside(const std::vector<Sample>& samples, const std::vector<ChunkSpan>& chunks, int damaged) {
  std::vector<Sample> rest;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool inside = damaged >= 0 && i >= chunks[static_cast<std::size_t>(damaged)].first_message &&
                        i < chunks[static_cast<std::size_t>(damaged)].first_message + 12;
    if (!inside) rest.push_back(samples[i]);
  }
  return rest;
}

struct FlipCase {
  Compression compression;
  Reading mode;
  std::uint8_t mask;
};

class McapFlips : public ::testing::TestWithParam<FlipCase> {};

TEST_P(McapFlips, AtAnyByteOfAChunkedLogCostNothingOutsideTheDamagedChunkAndAreTold) {
  const auto [compression, mode, mask] = GetParam();
  std::vector<Sample> samples;
  auto log = make_log({chunked(compression)}, &samples);
  const auto chunks = chunks_of(log, 12);
  for (std::size_t byte = 0; byte < log.size(); ++byte) {
    log[byte] ^= mask;
    const auto read = read_all(log, mode);
    const auto all = read.all();
    ASSERT_TRUE(holds(all, outside(samples, chunks, chunk_at(chunks, byte)))) << "byte " << byte;
    // What is called sound is what was written.
    ASSERT_TRUE(holds(samples, read.sound)) << "byte " << byte;
    ASSERT_FALSE(read.problems.empty()) << "byte " << byte;
    ASSERT_TRUE(read.problems.front().where.byte) << "byte " << byte;
    // No message is lost without being counted.
    ASSERT_GE(all.size() + read.counts.lost, samples.size()) << "byte " << byte;
    log[byte] ^= mask;
  }
}

std::vector<FlipCase> flip_cases() {
  std::vector<FlipCase> cases;
  for (const auto compression : {Compression::none, Compression::lz4, Compression::zstd})
    for (const auto mode : {Reading::tolerant, Reading::salvage})
      for (const std::uint8_t mask : {0x01, 0x80, 0xFF}) cases.push_back({compression, mode, mask});
  return cases;
}

std::string flip_name(const ::testing::TestParamInfo<FlipCase>& info) {
  return fmt::format("{}{}{:02x}", info.param.compression == Compression::none ? "none" : name_of(info.param.compression),
                     info.param.mode == Reading::tolerant ? "tolerant" : "salvage", info.param.mask);
}

INSTANTIATE_TEST_SUITE_P(Every, McapFlips, ::testing::ValuesIn(flip_cases()), flip_name);

TEST(McapDamage, FlipsAtAnyByteOfAnUnchunkedLogCostFewMessagesInSalvageMode) {
  std::vector<Sample> samples;
  auto log = make_log({unchunked()}, &samples);
  std::ranges::sort(samples);
  const auto ends = message_ends(log);
  const auto last_data_byte = ends.back();
  for (std::size_t byte = 8; byte < last_data_byte; ++byte) {
    log[byte] ^= 0xFF;
    const auto read = read_all(log, Reading::salvage);
    std::size_t kept = 0;
    for (const auto& sample : read.all()) kept += std::ranges::binary_search(samples, sample);
    // The damaged message, and at most the two that a search needs to see in a row near the end.
    ASSERT_GE(kept + 3, samples.size()) << "byte " << byte;
    ASSERT_FALSE(read.problems.empty()) << "byte " << byte;
    log[byte] ^= 0xFF;
  }
}

/// Damages the data of one message in a chunk.
std::vector<std::uint8_t> with_damaged_message(std::vector<std::uint8_t> log, std::size_t message) {
  const auto ends = message_ends(log);
  log[ends[message] - 2] ^= 0x55;
  return log;
}

TEST(McapDamage, KeepsAChunkWhoseCrcFailsOnlyInSalvageModeAndUnverified) {
  std::vector<Sample> samples;
  const auto log = with_damaged_message(make_log({chunked(Compression::none)}, &samples), 15);
  const auto tolerant = read_all(log, Reading::tolerant);
  EXPECT_EQ(tolerant.all().size(), 48u);
  EXPECT_EQ(tolerant.counts.lost, 12u);
  const auto salvage = read_all(log, Reading::salvage);
  EXPECT_EQ(salvage.sound.size(), 48u);
  EXPECT_EQ(salvage.unsound.size(), 12u);
  EXPECT_EQ(salvage.counts.salvaged, 12u);
  EXPECT_EQ(salvage.problems.front().where.byte, chunks_of(log, 12)[1].begin);
}

TEST(McapDamage, EndsAnUnverifiedChunkAtItsFirstImplausibleRecord) {
  std::vector<Sample> samples;
  auto log = make_log({chunked(Compression::none)}, &samples);
  const auto ends = message_ends(log);
  log[ends[14] + 1 + 4] = 0xFF;  // the length of message 15, the fourth of the second chunk
  const auto read = read_all(log, Reading::salvage);
  EXPECT_EQ(read.sound.size(), 48u);
  EXPECT_EQ(read.unsound, std::vector<Sample>(samples.begin() + 12, samples.begin() + 15));
}

TEST(McapDamage, StopsAtTheFirstProblemInStrictMode) {
  const auto read = read_all(with_damaged_message(make_log({chunked(Compression::none)}), 15), Reading::strict);
  EXPECT_EQ(read.sound.size(), 12u);
  EXPECT_EQ(read.problems.size(), 1u);
}

TEST(McapDamage, GoesUnnoticedOnlyWhereCrcChecksAreSwitchedOff) {
  std::vector<Sample> samples;
  const auto log = with_damaged_message(make_log({chunked(Compression::none)}, &samples), 15);
  const auto read = read_all(log, Reading::strict, false);
  EXPECT_EQ(read.sound.size(), samples.size());
  EXPECT_TRUE(read.problems.empty());
}

/// A chunk that claims a size, with the bytes given.
std::vector<std::uint8_t> claiming_chunk(std::uint64_t size, std::string_view compression, Bytes records) {
  std::vector<std::uint8_t> log(kMagic.begin(), kMagic.end());
  const auto put = [&](auto number) {
    const auto* at = reinterpret_cast<const std::uint8_t*>(&number);
    log.insert(log.end(), at, at + sizeof(number));
  };
  put(std::uint8_t{1}), put(std::uint64_t{8}), put(std::uint64_t{0});
  put(std::uint8_t{6}), put(std::uint64_t{28 + 4 + compression.size() + 8 + records.size()});
  put(std::uint64_t{0}), put(std::uint64_t{0}), put(size), put(std::uint32_t{0});
  put(static_cast<std::uint32_t>(compression.size()));
  log.insert(log.end(), compression.begin(), compression.end());
  put(std::uint64_t{records.size()});
  log.insert(log.end(), records.begin(), records.end());
  return log;
}

TEST(McapDamage, RefusesAChunkThatUnpacksBeyondTheLimitAndSaysSo) {
  const std::vector<std::uint8_t> zeros(4u << 20, 0);
  std::vector<std::uint8_t> packed;
  Compressor().run(Compression::zstd, 1, zeros, packed);
  const auto log = claiming_chunk(zeros.size(), "zstd", packed);
  RecordReader reader(log, {Reading::tolerant, true, 1u << 20, "bomb.mcap"});
  Record record;
  while (reader.next(record)) EXPECT_NE(record.op, Op::message);
  ASSERT_FALSE(reader.problems().empty());
  EXPECT_EQ(reader.problems().front().kind, Kind::limit);
}

TEST(McapDamage, UnpacksNoMoreThanAChunkClaims) {
  const std::vector<std::uint8_t> zeros(64u << 20, 0);
  for (const auto compression : {Compression::lz4, Compression::zstd}) {
    std::vector<std::uint8_t> packed, out;
    Compressor().run(compression, 1, zeros, packed);
    Decompressor decompressor;
    EXPECT_FALSE(decompressor.run(compression, packed, 1000, out));
    EXPECT_LE(out.capacity(), 1u << 20);
  }
}

TEST(McapDamage, TakesNoMemoryForAClaimedSizeAlone) {
  for (const auto* compression : {"lz4", "zstd", ""}) {
    std::vector<std::uint8_t> out;
    Decompressor decompressor;
    const std::vector<std::uint8_t> few{0x28, 0xB5, 0x2F, 0xFD, 0, 0};
    EXPECT_FALSE(decompressor.run(*compression_named(compression), few, std::uint64_t{1} << 40, out));
    EXPECT_LE(out.capacity(), 1u << 20);
  }
}

TEST(McapDamage, TakesNoMemoryForAClaimedWindowAlone) {
  // A zstd frame with a window of 128 MiB and one damaged block.
  const std::vector<std::uint8_t> few{0x28, 0xB5, 0x2F, 0xFD, 0x00, 17 << 3, 0x45, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<std::uint8_t> out;
  Decompressor decompressor;
  const auto before = mallinfo2().hblkhd;
  EXPECT_FALSE(decompressor.run(Compression::zstd, few, 1000, out));
  EXPECT_LE(mallinfo2().hblkhd, before + (32u << 20));
}

TEST(McapDamage, UnpacksWhatIsLargerThanTheUsualWindowIfTheBlocksCanHoldIt) {
  // Was called damaged: a frame of one segment went the way of pieces if it unpacks to more than 64 times its size, and
  // there a window of more than 128 MiB is refused.
  constexpr std::uint32_t kBlocks = 1040, kBlock = 1 << 17;
  constexpr std::uint32_t kSize = kBlocks * kBlock;
  std::vector<std::uint8_t> packed{0x28, 0xB5, 0x2F, 0xFD, 0xA0}, out;
  const auto put = [&](std::uint32_t number, int bytes) {
    for (; bytes > 0; --bytes, number >>= 8) packed.push_back(static_cast<std::uint8_t>(number));
  };
  put(kSize, 4);
  for (std::uint32_t i = 1; i <= kBlocks; ++i) put(kBlock << 3 | 1 << 1 | (i == kBlocks), 3), put(7, 1);
  EXPECT_TRUE(Decompressor().run(Compression::zstd, packed, kSize, out));
  EXPECT_EQ(out.size(), kSize);
  EXPECT_EQ(out.back(), 7);
}

TEST(McapDamage, InsideAChunkWithoutCrcIsToldWithTheBytesThatItCosts) {
  auto writing = chunked(Compression::none);
  writing.chunk_crc = writing.data_crc = false;
  auto log = make_log({writing});
  const auto chunk = chunks_of(log, 12)[1];
  const auto raw = record_at(log, chunk.begin);
  const auto records = parse_chunk(raw->content)->records;
  std::uint64_t at = 0;
  for (int i = 0; i < 5; ++i) at = record_at(records, at)->end;
  log[static_cast<std::size_t>(records.data() - log.data()) + at] = 0;
  const auto read = read_all(log, Reading::tolerant);
  EXPECT_EQ(read.sound.size(), 12u * 4 + 5);
  EXPECT_EQ(read.counts.lost, 7u);
  EXPECT_EQ(read.counts.bytes_given_up, records.size() - at);
  EXPECT_EQ(read.problems.front().where.byte, chunk.begin);
  const auto reader = IndexedReader::open(log);
  for (const auto order : {Order::file, Order::log_time}) {
    auto cursor = reader->messages({}, order);
    std::size_t messages = 0;
    for (Message m; cursor.next(m);) ++messages;
    EXPECT_EQ(messages, read.sound.size());
    ASSERT_EQ(cursor.problems().size(), 1u);
    EXPECT_EQ(cursor.problems()[0].where.byte, chunk.begin);
    EXPECT_NE(cursor.problems()[0].what.find(fmt::format("{} bytes", records.size() - at)), std::string::npos);
  }
}

TEST(McapDamage, SkipsAChunkOfUnknownCompressionAndGoesOn) {
  std::vector<Sample> samples;
  auto log = make_log({chunked(Compression::zstd)}, &samples);
  const auto chunk = chunks_of(log, 12)[2];
  log[chunk.begin + kHeadSize + 28 + 4] = 'Z';
  const auto read = read_all(log, Reading::tolerant);
  EXPECT_EQ(read.sound.size(), 48u);
  EXPECT_EQ(read.problems.front().kind, Kind::unsupported);
}

TEST(McapDamage, IsNoLogIfNothingInItIsMcap) {
  const std::string text = "time_s,qw,qx\n1,2,3\n";
  const auto read = read_all(as_bytes(text), Reading::salvage);
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_EQ(read.problems.front().kind, Kind::not_a_log);
  EXPECT_EQ(read_all({}, Reading::tolerant).problems.front().kind, Kind::not_a_log);
}

TEST(McapRecover, WritesACleanFileWithEverythingThatIsWhole) {
  std::vector<Sample> samples;
  const auto log = make_log({chunked(Compression::zstd)}, &samples);
  const auto chunk = chunks_of(log, 12)[3];
  MemorySink sink;
  const auto recovered = recover(front_of(log, chunk.end), sink);
  ASSERT_TRUE(recovered);
  EXPECT_EQ(recovered->counts.messages, 48u);
  EXPECT_FALSE(recovered->problems.empty());
  const auto read = read_all(sink.bytes(), Reading::strict);
  EXPECT_TRUE(read.complete);
  EXPECT_EQ(read.sound, std::vector<Sample>(samples.begin(), samples.begin() + 48));
  EXPECT_EQ(read.metadata, recovered->metadata);
  EXPECT_EQ(IndexedReader::open(sink.bytes())->summary().chunks.empty(), false);
}

TEST(McapRecover, LosesNothingOfAnIntactFile) {
  std::vector<Sample> samples;
  const auto log = make_log({chunked(Compression::lz4)}, &samples);
  MemorySink sink;
  const auto recovered = recover(log, sink);
  ASSERT_TRUE(recovered);
  EXPECT_TRUE(recovered->problems.empty());
  const auto read = read_all(sink.bytes(), Reading::strict);
  EXPECT_EQ(read.sound, samples);
  EXPECT_EQ(read.attachments, 1u);
  EXPECT_EQ(read.metadata, 5u);
}

TEST(McapRecover, RefusesWhatIsNoMcap) {
  MemorySink sink;
  const auto refused = recover(as_bytes("no log"), sink);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, Kind::not_a_log);
  EXPECT_TRUE(sink.bytes().empty());
}

TEST(McapDamage, InStrictModeGivesTheFirstProblemAlone) {
  // Found by fuzzing: a message turned into a record of an unknown kind was told twice, as a loss that the statistics
  // show and as a record that was ignored.
  auto writing = unchunked();
  writing.data_crc = false;
  auto log = make_log({writing});
  std::uint64_t at = kMagic.size();
  while (record_at(log, at)->op != Op::message) at = record_at(log, at)->end;
  log[at] = 0x7F;
  const auto read = read_all(log, Reading::strict);
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_EQ(read.problems[0].where.byte, at);
  EXPECT_EQ(read_all(log, Reading::tolerant).problems.size(), 2u);
}

}  // namespace
}  // namespace quadsonde::ingest::mcap
