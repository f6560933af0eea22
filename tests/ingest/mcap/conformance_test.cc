// The conformance files of foxglove/mcap: every record with its fields, and our writer's bytes against theirs.
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "ingest/mcap/indexed_reader.h"
#include "ingest/mcap/reader.h"
#include "ingest/mcap/writer.h"
#include "tests/support/data.h"

namespace quadsonde::ingest::mcap {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kFolder = "logs/mcap-conformance";

std::vector<fs::path> conformance_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(support::data_file(kFolder)))
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

Json expected_of(fs::path file) {
  std::ifstream in(file.replace_extension(".json"));
  return Json::parse(in);
}

// The values as the .json files print them: integers as texts, bytes as lists of texts.
std::string value(std::uint64_t number) { return fmt::format("{}", number); }
std::string value(std::string_view text) { return std::string(text); }
Json value(Bytes bytes) {
  Json list = Json::array();
  for (const auto byte : bytes) list.push_back(value(byte));
  return list;
}
Json value(const StringPairs& pairs) {
  Json object = Json::object();
  for (const auto& [key, text] : pairs) object[std::string(key)] = text;
  return object;
}
template <class A, class B>
Json value(const std::vector<std::pair<A, B>>& pairs) {
  Json object = Json::object();
  for (const auto& [key, number] : pairs) object[value(key)] = value(number);
  return object;
}

struct Row {
  Json json;
  explicit Row(const char* type) : json{{"type", type}, {"fields", Json::array()}} {}
  template <class T>
  Row& operator()(const char* name, const T& field) {
    json["fields"].push_back({name, value(field)});
    return *this;
  }
};

Json statistics_row(const Statistics& r) {
  return Row("Statistics")("attachment_count", r.attachment_count)("channel_count", r.channel_count)(
             "channel_message_counts", r.channel_message_counts)("chunk_count", r.chunk_count)(
             "message_count", r.message_count)("message_end_time", r.message_end_time)(
             "message_start_time", r.message_start_time)("metadata_count", r.metadata_count)("schema_count",
                                                                                             r.schema_count)
      .json;
}

Json chunk_index_row(const ChunkIndex& r) {
  return Row("ChunkIndex")("chunk_length", r.chunk_length)("chunk_start_offset", r.chunk_start)(
             "compressed_size", r.compressed_size)("compression", r.compression)("message_end_time",
                                                                                 r.message_end_time)(
             "message_index_length", r.message_index_length)("message_index_offsets", r.message_index_offsets)(
             "message_start_time", r.message_start_time)("uncompressed_size", r.uncompressed_size)
      .json;
}

Json attachment_row(const Attachment& r) {
  return Row("Attachment")("create_time", r.create_time)("data", r.data)("log_time", r.log_time)(
             "media_type", r.media_type)("name", r.name)
      .json;
}

Json attachment_index_row(const AttachmentIndex& r) {
  return Row("AttachmentIndex")("create_time", r.create_time)("data_size", r.data_size)("length", r.length)(
             "log_time", r.log_time)("media_type", r.media_type)("name", r.name)("offset", r.offset)
      .json;
}

Json message_row(const Message& r) {
  return Row("Message")("channel_id", r.channel_id)("data", r.data)("log_time", r.log_time)(
             "publish_time", r.publish_time)("sequence", r.sequence)
      .json;
}

Json channel_row(const Channel& r) {
  return Row("Channel")("id", r.id)("message_encoding", r.message_encoding)("metadata", r.metadata)(
             "schema_id", r.schema_id)("topic", r.topic)
      .json;
}

Json footer_row(const Footer& r) {
  return Row("Footer")("summary_crc", r.summary_crc)("summary_offset_start", r.summary_offset_start)("summary_start",
                                                                                                     r.summary_start)
      .json;
}

Json row_of(const Record& record) {
  const auto c = record.content;
  switch (record.op) {
    case Op::header: {
      const auto r = *parse_header(c);
      return Row("Header")("library", r.library)("profile", r.profile).json;
    }
    case Op::footer:
      return footer_row(*parse_footer(c));
    case Op::schema: {
      const auto r = *parse_schema(c);
      return Row("Schema")("data", r.data)("encoding", r.encoding)("id", r.id)("name", r.name).json;
    }
    case Op::channel:
      return channel_row(*parse_channel(c));
    case Op::message:
      return message_row(record.message());
    case Op::chunk_index:
      return chunk_index_row(*parse_chunk_index(c));
    case Op::attachment:
      return attachment_row(*parse_attachment(c));
    case Op::attachment_index:
      return attachment_index_row(*parse_attachment_index(c));
    case Op::statistics:
      return statistics_row(*parse_statistics(c));
    case Op::metadata: {
      const auto r = *parse_metadata(c);
      return Row("Metadata")("metadata", r.metadata)("name", r.name).json;
    }
    case Op::metadata_index: {
      const auto r = *parse_metadata_index(c);
      return Row("MetadataIndex")("length", r.length)("name", r.name)("offset", r.offset).json;
    }
    case Op::summary_offset: {
      const auto r = *parse_summary_offset(c);
      return Row("SummaryOffset")("group_length", r.length)("group_opcode", static_cast<std::uint64_t>(r.group))(
                 "group_start", r.start)
          .json;
    }
    case Op::data_end:
      return Row("DataEnd")("data_section_crc", *parse_data_end(c)).json;
    default:
      return Row("unexpected").json;
  }
}

TEST(McapConformance, StreamsEveryRecordWithEveryFieldOfAllFiles) {
  QUADSONDE_NEEDS_DATA(kFolder);
  const auto files = conformance_files();
  EXPECT_EQ(files.size(), 416u);
  std::size_t agreed = 0;
  for (const auto& file : files) {
    const auto bytes = support::read_bytes(file);
    RecordReader reader(bytes, {Reading::strict, true, 1u << 20, file.string()});
    Json records = Json::array();
    Record record;
    // The .json files list no message indexes; ReadsEveryFileByItsIndex... uses them.
    while (reader.next(record))
      if (record.op != Op::message_index) records.push_back(row_of(record));
    EXPECT_TRUE(reader.complete()) << file;
    EXPECT_TRUE(reader.problems().empty()) << to_string(reader.problems().front());
    const bool same = records == expected_of(file)["records"];
    EXPECT_TRUE(same) << file << "\n" << records.dump(1);
    agreed += same;
  }
  EXPECT_EQ(agreed, files.size());
  RecordProperty("files", static_cast<int>(agreed));
}

/// Messages that the .json lists, in file order or by time.
std::vector<Json> expected_messages(const Json& expected, Order order) {
  std::vector<Json> messages;
  for (const auto& row : expected["records"])
    if (row["type"] == "Message") messages.push_back(row);
  const auto time = [](const Json& row) { return std::stoull(row["fields"][2][1].get<std::string>()); };
  if (order == Order::log_time)
    std::ranges::stable_sort(messages, [&](const Json& a, const Json& b) { return time(a) < time(b); });
  return messages;
}

TEST(McapConformance, ReadsEveryFileByItsIndexInBothOrders) {
  QUADSONDE_NEEDS_DATA(kFolder);
  std::size_t with_chunk_index = 0;
  for (const auto& file : conformance_files()) {
    const auto bytes = support::read_bytes(file);
    const auto reader = IndexedReader::open(bytes);
    ASSERT_TRUE(reader) << file;
    EXPECT_TRUE(reader->problems().empty()) << file << to_string(reader->problems().front());
    const auto expected = expected_of(file);
    for (const auto order : {Order::file, Order::log_time}) {
      auto cursor = reader->messages({}, order);
      std::vector<Json> messages;
      for (Message message; cursor.next(message);) messages.push_back(message_row(message));
      EXPECT_EQ(messages, expected_messages(expected, order)) << file;
      EXPECT_TRUE(cursor.problems().empty()) << file;
    }
    with_chunk_index += reader->has_index() && !reader->summary().chunks.empty();
  }
  EXPECT_GT(with_chunk_index, 0u);
  RecordProperty("files_with_chunk_index", static_cast<int>(with_chunk_index));
}

TEST(McapConformance, FindsAttachmentsAndMetadataOfEveryFile) {
  QUADSONDE_NEEDS_DATA(kFolder);
  for (const auto& file : conformance_files()) {
    const auto bytes = support::read_bytes(file);
    const auto reader = IndexedReader::open(bytes);
    ASSERT_TRUE(reader) << file;
    std::vector<Json> found, expected;
    for (const auto& index : reader->summary().attachments) found.push_back(attachment_row(*reader->attachment(index)));
    for (const auto& index : reader->summary().metadata) {
      const auto r = *reader->metadata(index);
      found.push_back(Row("Metadata")("metadata", r.metadata)("name", r.name).json);
    }
    const auto listed = expected_of(file);
    for (const auto& row : listed["records"])
      if (row["type"] == "Attachment" || row["type"] == "Metadata") expected.push_back(row);
    EXPECT_EQ(found, expected) << file;
  }
}

bool has_feature(const Json& expected, const char* feature) {
  const auto& features = expected["meta"]["variant"]["features"];
  return std::ranges::find(features, feature) != features.end();
}

WriterSettings settings_for(const Json& expected) {
  WriterSettings s;
  s.library = "";
  s.compression = Compression::none;
  s.chunked = has_feature(expected, "ch");
  s.message_index = has_feature(expected, "mx");
  s.statistics = has_feature(expected, "st");
  s.repeat_schemas = has_feature(expected, "rsh");
  s.repeat_channels = has_feature(expected, "rch");
  s.attachment_index = has_feature(expected, "ax");
  s.metadata_index = has_feature(expected, "mdx");
  s.chunk_index = has_feature(expected, "chx");
  s.summary_offsets = has_feature(expected, "sum");
  return s;
}

/// Writes what a file holds with our own writer.
std::vector<std::uint8_t> rewritten(Bytes file, const WriterSettings& settings) {
  MemorySink sink;
  Writer writer(sink, settings);
  RecordReader reader(file);
  Record record;
  while (reader.next(record) && record.op != Op::data_end) {
    if (record.op == Op::schema) {
      const auto r = *parse_schema(record.content);
      EXPECT_EQ(writer.add_schema(std::string(r.name), std::string(r.encoding), r.data), r.id);
    } else if (record.op == Op::channel) {
      const auto r = *parse_channel(record.content);
      EXPECT_EQ(writer.add_channel(r.schema_id, std::string(r.topic), std::string(r.message_encoding),
                                   {r.metadata.begin(), r.metadata.end()}),
                r.id);
    } else if (record.op == Op::message) {
      EXPECT_TRUE(writer.write(record.message()));
    } else if (record.op == Op::attachment) {
      const auto r = *parse_attachment(record.content);
      EXPECT_TRUE(writer.attach(r.log_time, r.create_time, std::string(r.name), std::string(r.media_type), r.data));
    } else if (record.op == Op::metadata) {
      const auto r = *parse_metadata(record.content);
      EXPECT_TRUE(writer.add_metadata(std::string(r.name), {r.metadata.begin(), r.metadata.end()}));
    }
  }
  EXPECT_TRUE(writer.close());
  return sink.bytes();
}

TEST(McapConformance, WritesEveryFileThatAWriterCanChooseByteForByte) {
  QUADSONDE_NEEDS_DATA(kFolder);
  std::size_t written = 0;
  for (const auto& file : conformance_files()) {
    const auto expected = expected_of(file);
    // Extra bytes behind the known fields are for readers to ignore; no writer of today's format makes them.
    if (has_feature(expected, "pad")) continue;
    const auto bytes = support::read_bytes(file);
    const bool same = rewritten(bytes, settings_for(expected)) == bytes;
    EXPECT_TRUE(same) << file;
    written += same;
  }
  EXPECT_EQ(written, 208u);
  RecordProperty("files", static_cast<int>(written));
}

}  // namespace
}  // namespace quadsonde::ingest::mcap
