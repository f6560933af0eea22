// The sample logs against counts that npm's @mcap/core found in them.
#include <fstream>
#include <nlohmann/json.hpp>

#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/mcap/indexed_reader.h"
#include "tests/support/data.h"

namespace quadsonde::ingest::mcap {
namespace {

using Json = nlohmann::json;

const char* const kSamples[] = {"esc_flight_json_lz4.mcap", "esc_flight_json_lz4_truncated.mcap",
                                "esc_flight_json_nochunk.mcap", "esc_flight_protobuf_zstd.mcap"};

Json expected_of(const std::string& sample) {
  std::ifstream in(support::data_file("logs/EXPECTED_COUNTS.json"));
  return Json::parse(in)["mcap/" + sample];
}

const char* name_of(Op op) {
  constexpr const char* kNames[] = {"", "Header", "Footer", "Schema", "Channel", "Message", "Chunk", "MessageIndex",
                                    "ChunkIndex", "Attachment", "AttachmentIndex", "Statistics", "Metadata",
                                    "MetadataIndex", "SummaryOffset", "DataEnd"};
  return kNames[static_cast<int>(op)];
}

TEST(McapSamples, HoldTheExpectedRecordsTopicsAndTimes) {
  QUADSONDE_NEEDS_DATA("logs/mcap");
  for (const auto* sample : kSamples) {
    const auto expected = expected_of(sample);
    const auto bytes = support::read_bytes(support::data_file("logs/mcap") / sample);
    RecordReader reader(bytes);
    std::map<std::string, int> records, topics;
    std::uint64_t first = UINT64_MAX, last = 0;
    for (Record record; reader.next(record);) {
      if (!record.sound) continue;  // messages of the cut chunk are told apart
      ++records[name_of(record.op)];
      if (record.op != Op::message) continue;
      ++topics[reader.registry().channel(record.message().channel_id)->topic];
      first = std::min(first, record.message().log_time);
      last = std::max(last, record.message().log_time);
    }
    EXPECT_EQ(Json(topics), expected["messages_per_topic"]) << sample;
    EXPECT_EQ(Json(records), expected["record_counts"]) << sample;
    EXPECT_EQ(std::to_string(first), expected["first_log_time_ns"].get<std::string>()) << sample;
    EXPECT_EQ(std::to_string(last), expected["last_log_time_ns"].get<std::string>()) << sample;
    EXPECT_EQ(reader.complete(), expected["done"].get<bool>()) << sample;
    EXPECT_EQ(reader.counts().messages - reader.counts().salvaged, expected["total"].get<std::uint64_t>()) << sample;
    EXPECT_EQ(reader.problems().empty(), reader.complete()) << sample;
  }
}

TEST(McapSamples, GiveTheSameMessagesByIndexInTheOrderOfTheirTimes) {
  QUADSONDE_NEEDS_DATA("logs/mcap");
  for (const auto* sample : kSamples) {
    const auto expected = expected_of(sample);
    const auto bytes = support::read_bytes(support::data_file("logs/mcap") / sample);
    const auto reader = IndexedReader::open(bytes);
    ASSERT_TRUE(reader);
    auto cursor = reader->messages();
    std::map<std::string, int> topics;
    std::uint64_t last = 0;
    for (Message message; cursor.next(message);) {
      EXPECT_GE(message.log_time, last);
      last = message.log_time;
      ++topics[cursor.registry().channel(message.channel_id)->topic];
    }
    EXPECT_EQ(Json(topics), expected["messages_per_topic"]) << sample;
    for (const auto& problem : cursor.problems()) ADD_FAILURE() << to_string(problem);
  }
}

TEST(McapSamples, GiveOneTopicAlone) {
  QUADSONDE_NEEDS_DATA("logs/mcap");
  const auto bytes = support::read_bytes(support::data_file("logs/mcap/esc_flight_json_lz4.mcap"));
  const auto reader = IndexedReader::open(bytes);
  auto cursor = reader->messages({{"/velocity"}, 0, UINT64_MAX}, Order::log_time);
  int count = 0;
  for (Message message; cursor.next(message); ++count)
    EXPECT_EQ(cursor.registry().channel(message.channel_id)->topic, "/velocity");
  EXPECT_EQ(count, 315);
}

TEST(McapSamples, KeepTheTopicsAndCountsOfALogWithoutAFlight) {
  QUADSONDE_NEEDS_DATA("logs/mcap-conformance");
  const auto bytes = support::read_bytes(support::data_file("logs/mcap-conformance/TenMessages/TenMessages-ch-mx.mcap"));
  const auto content = read_mcap(bytes, "ten.mcap");
  ASSERT_TRUE(content);
  EXPECT_TRUE(content->flights.empty());
  ASSERT_EQ(content->topics.size(), 1u);
  EXPECT_EQ(content->topics[0].name, "example");
  EXPECT_EQ(content->topics[0].messages, 10u);
  EXPECT_EQ(content->messages, 10u);
}

}  // namespace
}  // namespace quadsonde::ingest::mcap
