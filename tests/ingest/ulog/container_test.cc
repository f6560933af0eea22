#include "ingest/ulog/container.h"

#include <gmock/gmock.h>

#include "tests/ingest/ulog/ulog_writer.h"
#include "tests/support/data.h"

namespace quadsonde::ingest::ulog {
namespace {

using support::UlogWriter;
using ::testing::HasSubstr;

/// A counter topic with `count` messages, a sync after every `sync_every` of them.
UlogWriter counters(int count, int sync_every = 0) {
  UlogWriter log;
  log.flags();
  log.format("counter:uint64_t timestamp;uint32_t value;float[3] xyz;");
  log.parameter("MAV_TYPE", 2);
  log.subscribe(7, "counter");
  for (int i = 0; i < count; ++i) {
    log.data(7, UlogWriter::raw(std::uint64_t(1000 + i)) + UlogWriter::raw(std::uint32_t(i)) + UlogWriter::raw(1.0F) +
                    UlogWriter::raw(2.0F) + UlogWriter::raw(float(i)));
    if (sync_every > 0 && (i + 1) % sync_every == 0) log.sync();
  }
  return log;
}

std::vector<std::int64_t> values(const Log& log, const std::string& path = "value") {
  std::vector<std::int64_t> all;
  const auto column = find_column(log.formats, log.topics.at(0).name, path);
  for (std::size_t i = 0; i < log.topics[0].payload_at.size(); ++i)
    all.push_back(integer(log.payload(log.topics[0], i), column.value()).value_or(-1));
  return all;
}

TEST(UlogContainer, ReadsTopicsParametersAndInformation) {
  auto log = counters(3);
  log.info("char[3] sys_name", "PX4");
  log.info_multi(false, "char[2] perf", "ab");
  log.info_multi(true, "char[2] perf", "cd");
  log.parameter("MPC_XY_VEL_MAX", 4.5F);
  log.text(1500, "armed");
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_TRUE(read.problems.empty());
  EXPECT_EQ(read.start_us, 1000U);
  EXPECT_EQ(values(read), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(read.info_text("sys_name"), "PX4");
  ASSERT_EQ(read.info_multi.size(), 1U);
  EXPECT_EQ(read.info_multi[0].second, "abcd");
  EXPECT_EQ(read.parameter("MAV_TYPE"), 2.0);
  ASSERT_EQ(read.parameter_changes.size(), 1U);
  EXPECT_EQ(read.parameter_changes[0].value.number(), 4.5);
  ASSERT_EQ(read.texts.size(), 1U);
  EXPECT_EQ(read.texts[0].text, "armed");
}

TEST(UlogContainer, FindsFieldsOfNestedTypesThatAreDefinedLater) {
  UlogWriter log;
  log.format("esc_status:uint64_t timestamp;uint8_t count;esc_report[2] esc;uint8_t[3] _padding0;");
  log.format("esc_report:int32_t rpm;float[2] volt;");
  log.subscribe(0, "esc_status");
  log.data(0, UlogWriter::raw(std::uint64_t(5)) + std::string(1, '\2') + UlogWriter::raw(std::int32_t(100)) +
                  UlogWriter::raw(1.0F) + UlogWriter::raw(2.0F) + UlogWriter::raw(std::int32_t(200)) +
                  UlogWriter::raw(3.0F) + UlogWriter::raw(4.5F));
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  const auto value = [&](const char* path) {
    return number(read.payload(read.topics[0], 0), find_column(read.formats, "esc_status", path).value());
  };
  EXPECT_EQ(value("esc[1].rpm"), 200.0);
  EXPECT_EQ(value("esc[1].volt[1]"), 4.5);
  EXPECT_EQ(value("_padding0[0]"), std::nullopt) << "a trailing padding is not written";
  EXPECT_FALSE(find_column(read.formats, "esc_status", "esc[2].rpm"));
  EXPECT_FALSE(find_column(read.formats, "esc_status", "esc.rpm"));
}

TEST(UlogContainer, RefusesTypesThatContainEachOther) {
  UlogWriter log;
  log.format("a:uint8_t x;b y;uint8_t z;");
  log.format("b:a[2] x;");
  log.subscribe(0, "a");
  log.data(0, "1234");
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_TRUE(find_column(read.formats, "a", "x"));
  EXPECT_FALSE(find_column(read.formats, "a", "z"));
}

TEST(UlogContainer, KeepsInstancesOfOneTopicApart) {
  UlogWriter log;
  log.format("t:uint64_t timestamp;");
  log.subscribe(3, "t", 0);
  log.subscribe(4, "t", 1);
  log.data(4, UlogWriter::raw(std::uint64_t(1)));
  log.data(4, UlogWriter::raw(std::uint64_t(2)));
  log.data(3, UlogWriter::raw(std::uint64_t(3)));
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  ASSERT_EQ(read.topics.size(), 2U);
  EXPECT_EQ(read.topics[0].messages, 1U);
  EXPECT_EQ(read.topics[1].multi_id, 1);
  EXPECT_EQ(read.topics[1].messages, 2U);
}

TEST(UlogContainer, RefusesAnUnknownIncompatibleExtension) {
  UlogWriter log;
  log.flags(2);
  const auto read = ulog::read(log.bytes, "x.ulg");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, Kind::unsupported);
}

TEST(UlogContainer, ReadsAppendedDataBehindACutMessage) {
  auto log = counters(3);
  auto appended = counters(0);
  // The flag bits come right behind the header: 3 bytes of head, 16 of flags, then the first offset.
  const std::size_t cut_at = log.bytes.size() - 5;
  log.bytes.resize(cut_at);
  log.text(9, "hardfault");
  log.bytes[16 + 3 + 8] = 1;
  const std::uint64_t offset = cut_at;
  std::memcpy(log.bytes.data() + 16 + 3 + 16, &offset, 8);
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_EQ(values(read), (std::vector<std::int64_t>{0, 1}));
  ASSERT_EQ(read.texts.size(), 1U);
  EXPECT_EQ(read.texts[0].text, "hardfault");
  EXPECT_TRUE(read.problems.empty());
}

TEST(UlogContainer, KeepsEveryCompleteMessageOfAFileCutAnywhere) {
  const auto whole = counters(20).bytes;
  const std::size_t first = whole.size() - 20 * 29;  // 3 of head, 2 of id, 24 of payload
  Settings strict;
  strict.mode = Reading::strict;
  EXPECT_EQ(ulog::read(Bytes(whole).first(whole.size() - 1), "cut.ulg", strict).error().kind, Kind::truncated);
  for (std::size_t cut = 16; cut <= whole.size(); ++cut) {
    const auto read = ulog::read(Bytes(whole).first(cut), "cut.ulg");
    ASSERT_TRUE(read) << cut;
    const auto complete = cut < first ? 0 : (cut - first) / 29;
    ASSERT_EQ(read->data_messages, complete) << cut;
    const bool between = cut == whole.size() || (cut >= first && (cut - first) % 29 == 0);
    if (cut > first) {
      EXPECT_EQ(read->problems.empty(), between) << cut;
    }
    for (const auto& problem : read->problems) EXPECT_EQ(problem.kind, Kind::truncated) << cut;
  }
}

TEST(UlogContainer, GoesOnAtTheNextSyncMessageAfterGarbage) {
  auto log = counters(10, 5);
  const auto tail = counters(10, 5).bytes;
  log.garbage(37);
  const auto garbage_at = log.bytes.size() - 37;
  log.sync();
  const auto data_from = tail.size() - 10 * 29 - 2 * 11;
  log.bytes.insert(log.bytes.end(), tail.begin() + static_cast<std::ptrdiff_t>(data_from), tail.end());
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_EQ(read.data_messages, 20U);
  EXPECT_EQ(read.salvaged, 10U);
  ASSERT_EQ(read.problems.size(), 1U);
  EXPECT_EQ(read.problems[0].kind, Kind::damaged);
  EXPECT_EQ(read.problems[0].where.byte, garbage_at);
}

TEST(UlogContainer, FindsSoundMessagesWithoutSyncOnlyWhenSalvaging) {
  auto log = counters(10);
  const auto more = counters(10).bytes;
  log.garbage(41);
  log.bytes.insert(log.bytes.end(), more.end() - 10 * 29, more.end());
  const auto tolerant = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_EQ(tolerant.data_messages, 9U) << "the message in front of garbage may have been cut itself";
  EXPECT_EQ(tolerant.problems.size(), 1U);
  Settings salvage;
  salvage.mode = Reading::salvage;
  const auto salvaged = ulog::read(log.bytes, "x.ulg", salvage).value();
  EXPECT_EQ(salvaged.data_messages, 19U);
  EXPECT_EQ(salvaged.salvaged, 10U);
  Settings strict;
  strict.mode = Reading::strict;
  EXPECT_FALSE(ulog::read(log.bytes, "x.ulg", strict));
}

TEST(UlogContainer, DoesNotUseAMessageWhoseTailWasLost) {
  // 11 bytes are missing inside message 4: its length covers a part of message 5.
  auto log = counters(12).bytes;
  const auto first = log.size() - 12 * 29;
  const auto hole = log.begin() + static_cast<std::ptrdiff_t>(first + 4 * 29 + 15);
  log.erase(hole, hole + 11);
  Settings salvage;
  salvage.mode = Reading::salvage;
  const auto read = ulog::read(log, "x.ulg", salvage).value();
  EXPECT_EQ(values(read), (std::vector<std::int64_t>{0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11}));
}

TEST(UlogContainer, SkipsMessageTypesOfTheFuture) {
  auto log = counters(2);
  log.message('Z', "whatever");
  log.data(7, std::string(24, '\0'));
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_EQ(read.data_messages, 3U);
  EXPECT_TRUE(read.problems.empty());
}

TEST(UlogContainer, TellsOfDataThatNoTopicAnnounced) {
  auto log = counters(2);
  log.data(99, "1234");
  log.data(99, "1234");
  log.data(7, std::string(24, '\0'));
  const auto read = ulog::read(log.bytes, "x.ulg").value();
  EXPECT_EQ(read.data_messages, 3U);
  ASSERT_EQ(read.problems.size(), 1U);
  EXPECT_THAT(read.problems[0].what, HasSubstr("id 99"));
}

TEST(UlogContainer, SaysThatOtherFilesAreNone) {
  const auto text = as_bytes("time_s,vn_m_s\n1,2\n");
  EXPECT_EQ(ulog::read(text, "x.ulg").error().kind, Kind::not_a_log);
  EXPECT_EQ(ulog::read({}, "x.ulg").error().kind, Kind::not_a_log);
  EXPECT_EQ(ulog::read(Bytes(magic), "x.ulg").error().kind, Kind::truncated);
}

}  // namespace
}  // namespace quadsonde::ingest::ulog
