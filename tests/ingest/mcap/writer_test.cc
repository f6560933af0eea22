#include "ingest/mcap/writer.h"

#include "ingest/mcap/mapped_file.h"
#include "sample_logs.h"
#include "tests/support/data.h"

namespace quadsonde::ingest::mcap {
namespace {

TEST(McapWriter, IsReadBackUnderEveryCompressionAndWithoutChunks) {
  for (const auto& writing : {unchunked(), chunked(Compression::none), chunked(Compression::lz4), chunked(Compression::zstd)}) {
    std::vector<Sample> samples;
    const auto read = read_all(make_log({writing}, &samples), Reading::strict);
    EXPECT_TRUE(read.problems.empty()) << to_string(read.problems.front());
    EXPECT_TRUE(read.complete);
    EXPECT_EQ(read.sound, samples);
    EXPECT_EQ(read.attachments, 1u);
  }
}

TEST(McapWriter, IsReadBackWithoutAnyOfTheOptionalParts) {
  for (int part = 0; part < 12; ++part) {
    auto s = chunked(Compression::zstd);
    bool* const parts[] = {&s.message_index,   &s.chunk_index,     &s.attachment_index, &s.metadata_index,
                           &s.statistics,      &s.repeat_schemas,  &s.repeat_channels,  &s.summary_offsets,
                           &s.chunk_crc,       &s.data_crc,        &s.summary_crc,      &s.attachment_crc};
    *parts[part] = false;
    std::vector<Sample> samples;
    const auto read = read_all(make_log({s}, &samples), Reading::strict);
    EXPECT_TRUE(read.complete && read.problems.empty()) << part;
    EXPECT_EQ(read.sound, samples) << part;
  }
}

TEST(McapWriter, ClosesAChunkWhenItsRecordsReachTheSize) {
  WriterSettings settings;
  settings.chunk_size = 200;
  MemorySink sink;
  Writer writer(sink, settings);
  const auto channel = *writer.add_channel(0, "/a", "json");
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_TRUE(writer.write({channel, i, i, i, as_bytes("{}")}));
  ASSERT_TRUE(writer.close());
  std::size_t chunks = 0;
  for (std::uint64_t at = kMagic.size(); const auto raw = record_at(sink.bytes(), at);) {
    if (raw->op == Op::footer) break;
    if (raw->op == Op::chunk) {
      ++chunks;
      EXPECT_LT(parse_chunk(raw->content)->uncompressed_size, 200u + 33u);
    }
    at = raw->end;
  }
  EXPECT_GT(chunks, 10u);
}

TEST(McapWriter, RefusesChannelsAndSchemasThatWereNeverAdded) {
  MemorySink sink;
  Writer writer(sink, {});
  EXPECT_EQ(writer.write({1, 0, 0, 0, {}}).error().kind, Kind::usage);
  EXPECT_EQ(writer.add_channel(1, "/a", "json").error().kind, Kind::usage);
}

class FullDisk : public Sink {
 public:
  bool write(Bytes bytes) override { return (room_ -= static_cast<long>(bytes.size())) >= 0; }

 private:
  long room_ = 300;
};

TEST(McapWriter, SaysThatTheSinkIsFullAndStaysFailed) {
  FullDisk disk;
  WriterSettings settings;
  settings.chunk_size = 100;
  settings.compression = Compression::none;
  Writer writer(disk, settings);
  const auto channel = *writer.add_channel(0, "/a", "json");
  bool failed = false;
  for (std::uint32_t i = 0; i < 50 && !failed; ++i) failed = !writer.write({channel, i, i, i, as_bytes("{}")});
  EXPECT_TRUE(failed);
  EXPECT_EQ(writer.close().error().kind, Kind::write_failed);
}

TEST(Crc32, OfTwoPartsIsJoinedFromThoseOfEach) {
  std::vector<std::uint8_t> bytes(70'001);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 7919 >> 5);
  for (const std::size_t cut : {0u, 1u, 17u, 65'536u, 70'000u, 70'001u}) {
    const auto a = Bytes(bytes).first(cut), b = Bytes(bytes).subspan(cut);
    EXPECT_EQ(joined_crc32(crc32(a), crc32(b), b.size()), crc32(bytes)) << cut;
  }
}

TEST(MappedFile, HoldsTheBytesOfAFileAndNamesOneThatIsNotThere) {
  const support::TemporaryFolder folder;
  support::write_bytes(folder / "a", {1, 2, 3});
  support::write_bytes(folder / "empty", {});
  const auto file = MappedFile::open(folder / "a");
  ASSERT_TRUE(file);
  EXPECT_EQ(std::vector<std::uint8_t>(file->bytes().begin(), file->bytes().end()), (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_TRUE(MappedFile::open(folder / "empty")->bytes().empty());
  EXPECT_EQ(MappedFile::open(folder / "none").error().kind, Kind::unreadable);
  EXPECT_EQ(MappedFile::open(folder.path()).error().kind, Kind::unreadable);
}

}  // namespace
}  // namespace quadsonde::ingest::mcap
