#include "tests/fuzz/mcap/targets.h"

#include <google/protobuf/stubs/logging.h>

#include <cstdlib>

#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/mcap/indexed_reader.h"
#include "ingest/mcap/message_decoder.h"
#include "ingest/mcap/recover.h"

namespace quadsonde::fuzz {
namespace {

using namespace ingest;        // NOLINT: a test
using namespace ingest::mcap;  // NOLINT

constexpr std::uint64_t kMaxChunk = 1u << 20;

void must(bool promise) {
  if (!promise) std::abort();
}

/// Touches every byte that a reader gives.
std::uint64_t touch(Bytes bytes) {
  std::uint64_t sum = 0;
  for (const auto byte : bytes) sum += byte;
  return sum;
}

std::uint64_t read_through(Bytes bytes, Reading mode, bool check_crc, std::uint64_t& sum) {
  RecordReader reader(bytes, {mode, check_crc, kMaxChunk, "fuzz.mcap"});
  std::uint64_t messages = 0, unsound = 0;
  for (Record record; reader.next(record);) {
    sum += touch(record.content);
    if (record.op != Op::message) continue;
    must(record.content.size() >= kMessageHead);
    must(reader.registry().channel(record.message().channel_id) != nullptr);
    ++messages;
    unsound += !record.sound;
  }
  must(messages == reader.counts().messages && unsound == reader.counts().salvaged);
  must(reader.complete() || !reader.problems().empty());
  must(mode != Reading::strict || reader.problems().size() <= 1 || !reader.complete());
  return messages;
}

}  // namespace

void mcap_reader(Bytes bytes) {
  std::uint64_t sum = 0;
  for (const bool check_crc : {true, false})
    for (const auto mode : {Reading::strict, Reading::tolerant, Reading::salvage}) read_through(bytes, mode, check_crc, sum);
  MemorySink sink;
  RecoverSettings settings;
  settings.max_chunk = kMaxChunk;
  const auto recovered = recover(bytes, sink, settings);
  if (!recovered) return;
  // What recover() writes is clean and holds all that it says.
  RecordReader again(sink.bytes(), {Reading::strict, true, UINT64_MAX, ""});
  for (Record record; again.next(record);) sum += touch(record.content);
  must(again.complete() && again.problems().empty());
  must(again.counts().messages == recovered->counts.messages);
  must(sum != UINT64_MAX);
}

void mcap_indexed(Bytes bytes) {
  std::uint64_t sum = 0;
  for (const bool check_crc : {true, false}) {
    const auto reader = IndexedReader::open(bytes, {Reading::tolerant, check_crc, kMaxChunk, "fuzz.mcap"});
    if (!reader) return;
    std::uint64_t counts[2] = {0, 0};
    bool sound = reader->problems().empty();
    for (const auto order : {Order::file, Order::log_time}) {
      auto cursor = reader->messages({}, order);
      for (Message message; cursor.next(message); ++counts[order == Order::file]) sum += touch(message.data);
      sound = sound && cursor.problems().empty();
    }
    // Where definitions are missing, the order decides which messages come before theirs.
    must(!sound || counts[0] == counts[1]);
    auto some = reader->messages({{"/one", "example"}, 100, 1'000'000}, Order::log_time);
    for (Message message; some.next(message);) must(message.log_time >= 100 && message.log_time <= 1'000'000);
    for (const auto& index : reader->summary().attachments)
      if (const auto attachment = reader->attachment(index)) sum += touch(attachment->data);
    for (const auto& index : reader->summary().metadata) sum += reader->metadata(index).has_value();
  }
  must(sum != UINT64_MAX);
}

void mcap_flight(Bytes bytes) {
  McapReadSettings settings;
  settings.max_chunk = kMaxChunk;
  for (const auto mode : {Reading::strict, Reading::tolerant, Reading::salvage}) {
    settings.mode = mode;
    settings.check_crc = mode == Reading::strict;
    const auto content = read_mcap(bytes, "fuzz.mcap", settings);
    if (!content) continue;
    std::uint64_t messages = 0;
    for (const auto& topic : content->topics) messages += topic.messages;
    must(messages == content->messages && content->salvaged <= content->messages);
  }
}

/// The first byte picks an encoding; the second tells how much of the rest is the schema, the rest is a message.
void mcap_schema(Bytes bytes) {
  google::protobuf::LogSilencer quiet;
  if (bytes.size() < 2) return;
  constexpr const char* kEncodings[][2] = {{"protobuf", "protobuf"}, {"cdr", "ros2msg"}, {"ros1", "ros1msg"}, {"json", "jsonschema"}};
  const auto& encoding = kEncodings[bytes[0] % 4];
  const auto rest = bytes.subspan(2);
  const auto cut = rest.size() * bytes[1] / 255;
  const KnownSchema schema{bytes[0] % 4 == 0 ? "a.B" : "a/B", encoding[1], {rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(cut)}, true};
  const auto decoder = decoder_for({1, "/a", encoding[0], {}, true}, &schema);
  Json out;
  if (decoder && decoder->decode(rest.subspan(cut), out)) must(out.is_object());
}

}  // namespace quadsonde::fuzz
