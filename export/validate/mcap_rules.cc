#include "export/validate/mcap_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>

#include "ingest/mcap/message_decoder.h"
#include "ingest/mcap/reader.h"
#include "ingest/mcap/summary.h"

namespace quadsonde::product {
namespace {

namespace mcap = ingest::mcap;
using ingest::Bytes;
using ingest::Kind;
using ingest::Problem;

std::string at_byte(std::uint64_t byte) { return fmt::format("byte {}", byte); }

/// The record that a problem is about, by what stands at its byte; the rest by what kind of problem it is.
const Rule* rule_of(const Problem& problem, Bytes file) {
  if (problem.kind == Kind::not_a_log) return rule("mcap.start");
  if (problem.kind == Kind::truncated) return rule("mcap.end");
  if (problem.what.find("CRC over all data") != std::string::npos) return rule("mcap.data-end");
  if (problem.what.find("CRC of the summary") != std::string::npos) return rule("mcap.summary-crc");
  if (problem.what.find("CRC of this chunk") != std::string::npos) return rule("mcap.chunk-crc");
  if (problem.what.find("CRC of this attachment") != std::string::npos) return rule("mcap.attachment");
  if (problem.what.find("never defined") != std::string::npos) return rule("mcap.message-channel");
  if (problem.what.find("differs from the one") != std::string::npos ||
      problem.what.find("contradicts") != std::string::npos)
    return rule("mcap.redefined");
  const auto byte = problem.where.byte.value_or(file.size());
  if (byte >= file.size()) return rule("mcap.record");
  switch (static_cast<mcap::Op>(file[byte])) {
    case mcap::Op::chunk:
      return rule("mcap.chunk");
    case mcap::Op::attachment:
      return rule("mcap.attachment");
    case mcap::Op::footer:
      return rule("mcap.footer");
    case mcap::Op::data_end:
      return rule("mcap.data-end");
    case mcap::Op::statistics:
      return rule("mcap.statistics");
    case mcap::Op::schema:
      return rule("mcap.schema");
    case mcap::Op::message:
      return rule("mcap.message");
    default:
      return rule("mcap.record");
  }
}

/// What the messages of a file are, in one pass.
struct Content {
  struct PerChannel {
    std::uint64_t messages = 0, undecoded = 0, first_undecoded = 0;
    std::unique_ptr<ingest::MessageDecoder> decoder;
    bool decodable = true;
  };
  std::map<std::uint16_t, PerChannel> channels;
  std::uint64_t messages = 0, last_time = 0, earlier = 0;
  std::uint64_t start = std::numeric_limits<std::uint64_t>::max(), end = 0;
};

class McapChecker {
 public:
  McapChecker(Bytes file, Findings& found) : file_(file), found_(found) {}

  void run() {
    check_header();
    read_records();
    check_channels();
    check_summary();
  }

 private:
  void check_header() {
    const auto first = mcap::record_at(file_, mcap::kMagic.size());
    if (!first || first->op != mcap::Op::header || !mcap::parse_header(first->content))
      found_.add(rule("mcap.header"), at_byte(mcap::kMagic.size()), "no header stands here");
  }

  void read_records() {
    mcap::RecordReader reader(file_);
    mcap::Record record;
    while (reader.next(record))
      if (record.op == mcap::Op::message) take(record.message(), reader.registry(), record.offset);
    for (const auto& problem : reader.problems()) {
      const auto where = problem.where.byte ? at_byte(*problem.where.byte) : problem.where.topic;
      found_.add(rule_of(problem, file_), where, problem.what);
    }
    whole_ = reader.problems().empty();
    registry_ = reader.registry();
    if (content_.earlier > 0)
      found_.add(rule("mcap.order"), "", fmt::format("{} messages stand behind a later one", content_.earlier));
  }

  void take(const mcap::Message& message, const mcap::Registry& registry, std::uint64_t offset) {
    ++content_.messages;
    content_.earlier += message.log_time < content_.last_time;
    content_.last_time = std::max(content_.last_time, message.log_time);
    content_.start = std::min(content_.start, message.log_time);
    content_.end = std::max(content_.end, message.log_time);
    auto& channel = content_.channels[message.channel_id];
    if (channel.messages++ == 0) {
      const auto* known = registry.channel(message.channel_id);
      channel.decoder = known ? ingest::decoder_for(*known, registry.schema(known->schema_id)) : nullptr;
    }
    // A schema that fits a thousand messages fits; decoding all would take longer than reading them.
    constexpr std::uint64_t enough = 1000;
    if (!channel.decoder || channel.messages > enough || message.data.size() > ingest::kLargestDecoded) return;
    if (!channel.decoder->decode(message.data, tree_) && channel.undecoded++ == 0) channel.first_undecoded = offset;
  }

  void check_channels() {
    for (const auto& [id, known] : registry_.channels()) {
      const auto where = "channel " + known.topic;
      const auto* schema = registry_.schema(known.schema_id);
      if (known.schema_id != 0 && !schema)
        found_.add(rule("mcap.channel-schema"), where, fmt::format("its schema {} was never defined", known.schema_id));
      const auto seen = content_.channels.find(id);
      const bool decodes = seen != content_.channels.end() && seen->second.decoder;
      const bool ours = known.message_encoding == "protobuf" || known.message_encoding == "json" ||
                        known.message_encoding == "cdr" || known.message_encoding == "ros1";
      if (!ours)
        found_.add(rule("mcap.encoding"), where, "messages are encoded as \"" + known.message_encoding + "\"");
      else if (seen != content_.channels.end() && !decodes)
        found_.add(rule("mcap.schema"), where, "its schema cannot be used");
      if (decodes && seen->second.undecoded > 0)
        found_.add(rule("mcap.message"), where,
                   fmt::format("{} messages do not follow the schema, the first near byte {}", seen->second.undecoded,
                               seen->second.first_undecoded));
    }
  }

  void check_summary() {
    const auto summary = mcap::read_summary(file_);
    if (!summary) {
      const auto& problem = summary.error();
      if (problem.kind == Kind::missing)
        found_.add(rule("mcap.no-summary"), "", problem.what);
      else if (whole_)  // else the reader has told the damage that keeps the summary from being read
        found_.add(rule("mcap.footer"), problem.where.byte ? at_byte(*problem.where.byte) : "", problem.what);
      return;
    }
    for (const auto& index : summary->chunks) check_chunk_index(index);
    if (summary->statistics && whole_) check_statistics(*summary->statistics);
  }

  void check_chunk_index(const mcap::ChunkIndex& index) {
    const auto record = mcap::record_at(file_, index.chunk_start);
    const auto chunk = record && record->op == mcap::Op::chunk ? mcap::parse_chunk(record->content) : std::nullopt;
    const auto where = at_byte(index.chunk_start);
    if (!chunk)
      found_.add(rule("mcap.chunk-index"), where, "no chunk stands where the index says");
    else if (record->end - index.chunk_start != index.chunk_length ||
             chunk->message_start_time != index.message_start_time ||
             chunk->message_end_time != index.message_end_time || chunk->uncompressed_size != index.uncompressed_size)
      found_.add(rule("mcap.chunk-index"), where, "length, size or times differ from those of the chunk");
  }

  void check_statistics(const mcap::Statistics& said) {
    const auto differ = [&](const char* what, std::uint64_t there, std::uint64_t counted) {
      if (there != counted)
        found_.add(rule("mcap.statistics"), "", fmt::format("{}: {} said, {} there", what, there, counted));
    };
    differ("messages", said.message_count, content_.messages);
    differ("channels", said.channel_count, registry_.channels().size());
    if (content_.messages > 0) {
      differ("first time", said.message_start_time, content_.start);
      differ("last time", said.message_end_time, content_.end);
    }
    for (const auto& [id, count] : said.channel_message_counts)
      differ("messages of a channel", count, content_.channels.contains(id) ? content_.channels[id].messages : 0);
  }

  Bytes file_;
  Findings& found_;
  Content content_;
  mcap::Registry registry_;
  ingest::Json tree_;
  bool whole_ = false;
};

}  // namespace

void check_mcap(Bytes file, Findings& found) { McapChecker(file, found).run(); }

}  // namespace quadsonde::product
