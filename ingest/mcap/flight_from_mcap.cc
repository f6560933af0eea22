#include "ingest/mcap/flight_from_mcap.h"

#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>

#include <map>

#include "ingest/mcap/foreign_topics.h"
#include "ingest/mcap/own_messages.h"
#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/reader.h"

namespace quadsonde::ingest {
namespace {

/// MCAP's log times are UTC by convention only: they are believed if they lie between 2001 and 2100.
Clock foreign_clock(const Flight& flight) {
  constexpr std::int64_t k2001 = 978'307'200'000'000'000, k2100 = 4'102'444'800'000'000'000;
  const auto span = time_span(flight);
  const auto first = span ? span->first.ns : flight.position.empty() ? 0 : flight.position.time.front().ns;
  if (first < k2001 || first > k2100) return {};
  // Nobody says how well the recording computer's clock was set.
  return {Duration(0), 1.0, "MCAP log time"};
}

/// One pass over a file: every channel gets its handler when its first message comes.
class FlightCollector {
 public:
  FlightCollector(Bytes bytes, const std::string& file_name, const McapReadSettings& settings)
      : file_name_(file_name),
        settings_(settings),
        reader_(bytes, {settings.mode, settings.check_crc, settings.max_chunk, file_name}) {}

  void run() {
    mcap::Record record;
    while (reader_.next(record)) {
      if (record.op == mcap::Op::message)
        take_message(record.message());
      else if (record.op == mcap::Op::metadata)
        take_metadata(record);
      else if (record.op == mcap::Op::header)
        take_header(*mcap::parse_header(record.content));
      else if (record.op == mcap::Op::attachment)
        ++attachments_;
    }
    own::apply_clock(own_);
  }

  Truth& truth() { return own_.truth; }
  const mcap::RecordReader& reader() const { return reader_; }
  LogContent content();

 private:
  struct Topic {
    std::unique_ptr<TopicHandler> handler;
    std::uint64_t messages = 0, undecodable = 0;
  };

  void take_header(const mcap::Header& header) {
    written_by_us_ = header.profile == "quadsonde";
    if (!header.profile.empty()) details_.emplace_back("profile", header.profile);
    if (!header.library.empty()) details_.emplace_back("library", header.library);
  }

  void take_metadata(const mcap::Record& record) {
    const auto metadata = mcap::parse_metadata(record.content);
    if (!own::take_metadata(*metadata, own_))
      problems_.push_back({Kind::damaged, fmt::format("a value of the metadata record {} is no number", metadata->name),
                           {file_name_, record.offset, {}, {}}, "it counts as unknown"});
  }

  void take_message(const mcap::Message& message) {
    auto [found, is_new] = topics_.try_emplace(message.channel_id);
    auto& topic = found->second;
    if (is_new) topic.handler = handler(message.channel_id);
    ++topic.messages;
    if (topic.handler && !topic.handler->take({static_cast<std::int64_t>(message.log_time)}, message.data))
      ++topic.undecodable;
  }

  std::unique_ptr<TopicHandler> handler(std::uint16_t id) {
    const auto& channel = *reader_.registry().channel(id);
    const auto* schema = reader_.registry().schema(channel.schema_id);
    if (auto ours = own::handler_for(channel, schema, own_)) return ours;
    // Foxglove's schemas beside ours are for viewers, and what we computed is no measurement, also where another
    // program copied our topics.
    if (schema && schema->name.starts_with(own::kPackage) && !settings_.topics) return nullptr;
    if (written_by_us_ && !settings_.topics) return nullptr;
    return foreign_.handler_for(channel, schema, settings_.topics ? &*settings_.topics : nullptr);
  }

  void list_topics(LogContent& content) const;

  std::string file_name_;
  McapReadSettings settings_;
  mcap::RecordReader reader_;
  own::Collected own_;
  foreign::Parts foreign_;
  bool written_by_us_ = false;
  std::map<std::uint16_t, Topic> topics_;
  std::uint64_t attachments_ = 0;
  std::vector<std::pair<std::string, std::string>> details_;
  std::vector<Problem> problems_;
};

/// Channels that share a topic are one.
void FlightCollector::list_topics(LogContent& content) const {
  std::map<std::string, std::size_t> places;
  for (const auto& [id, channel] : reader_.registry().channels()) {
    const auto [place, is_new] = places.try_emplace(channel.topic, content.topics.size());
    if (is_new) content.topics.push_back({channel.topic, 0});
    const auto topic = topics_.find(id);
    if (topic == topics_.end()) continue;
    content.topics[place->second].messages += topic->second.messages;
    if (topic->second.undecodable > 0)
      content.problems.push_back({Kind::damaged,
                                  fmt::format("{} of {} messages do not follow their schema", topic->second.undecodable,
                                              topic->second.messages),
                                  {file_name_, {}, {}, channel.topic}, "they are left out"});
  }
}

LogContent FlightCollector::content() {
  LogContent content;
  content.format = "mcap";
  content.messages = reader_.counts().messages;
  content.salvaged = reader_.counts().salvaged;
  content.details = std::move(details_);
  if (attachments_ > 0) content.details.emplace_back("attachments", std::to_string(attachments_));
  content.problems = reader_.problems();
  content.problems.insert(content.problems.end(), problems_.begin(), problems_.end());
  list_topics(content);
  const auto has_flight = [](const Flight& f) {
    return !f.attitude.empty() || !f.velocity.empty() || !f.position.empty() || !f.local_position.empty();
  };
  const bool ours = own_.any && has_flight(own_.flight) && !settings_.topics;
  Flight flight = ours ? std::move(own_.flight) : foreign_.join(content.problems, file_name_);
  if (!has_flight(flight)) return content;
  tidy(flight);
  if (!ours) flight.clock = foreign_clock(flight);
  content.flights.push_back(std::move(flight));
  return content;
}

}  // namespace

bool looks_like_mcap(Bytes head) { return mcap::has_magic(head, 0); }

Result<LogContent> read_mcap(Bytes bytes, const std::string& file_name, const McapReadSettings& settings) {
  // What protobuf would print to standard error is counted as undecodable messages.
  google::protobuf::LogSilencer quiet;
  FlightCollector collector(bytes, file_name, settings);
  collector.run();
  const auto& problems = collector.reader().problems();
  const bool no_log = !problems.empty() && problems.front().kind == Kind::not_a_log &&
                      collector.reader().registry().channels().empty();
  if (no_log || (settings.mode == Reading::strict && !problems.empty())) return fail(problems.front());
  return collector.content();
}

Result<Truth> read_truth(Bytes bytes, const std::string& file_name) {
  google::protobuf::LogSilencer quiet;
  FlightCollector collector(bytes, file_name, {});
  collector.run();
  const auto& problems = collector.reader().problems();
  if (!problems.empty() && problems.front().kind == Kind::not_a_log) return fail(problems.front());
  return std::move(collector.truth());
}

}  // namespace quadsonde::ingest
