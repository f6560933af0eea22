#pragma once
// Small MCAP logs that the tests make, and ways to compare what comes out of them.
#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <ostream>
#include <string>
#include <vector>

#include "ingest/mcap/reader.h"
#include "ingest/mcap/writer.h"

namespace quadsonde::ingest::mcap {

/// A message by value.
struct Sample {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::string data;
  friend auto operator<=>(const Sample&, const Sample&) = default;
};

inline void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.topic << '#' << sample.sequence; }

struct LogShape {
  WriterSettings writing{};
  int chunks = 5, messages_per_chunk = 12;
  bool extras = true;         ///< an attachment and a metadata record
  std::uint64_t start = 1000;
};

inline WriterSettings chunked(Compression compression) {
  WriterSettings writing;
  writing.compression = compression;
  writing.chunk_size = 1u << 30;  // the maker ends chunks itself
  return writing;
}

inline WriterSettings unchunked() {
  WriterSettings writing;
  writing.chunked = false;
  return writing;
}

/// Messages on three topics, times 7 apart, their data telling their number. A metadata record, which ends a chunk,
/// stands behind each of them.
inline std::vector<std::uint8_t> make_log(const LogShape& shape, std::vector<Sample>* samples = nullptr) {
  MemorySink sink;
  Writer writer(sink, shape.writing);
  const std::string schema_text = "{\"type\":\"object\"}";
  const auto schema = *writer.add_schema("sample", "jsonschema", as_bytes(schema_text));
  const char* const topics[] = {"/one", "/two", "/three"};
  std::vector<std::uint16_t> channels;
  for (const auto* topic : topics) channels.push_back(*writer.add_channel(schema, topic, "json", {{"key", "value"}}));
  std::uint32_t number = 0;
  for (int c = 0; c < shape.chunks; ++c) {
    for (int i = 0; i < shape.messages_per_chunk; ++i, ++number) {
      const auto data = fmt::format("{{\"n\":{},\"x\":\"{}\"}}", number, std::string(number % 5, 'y'));
      const auto time = shape.start + 7 * number;
      (void)writer.write({channels[number % 3], number, time, time, as_bytes(data)});
      if (samples) samples->push_back({topics[number % 3], number, time, data});
    }
    if (shape.writing.chunked || c == 1) (void)writer.add_metadata(fmt::format("part {}", c), {{"c", fmt::format("{}", c)}});
  }
  if (shape.extras) (void)writer.attach(5, 6, "note.txt", "text/plain", as_bytes("an attachment"));
  (void)writer.close();
  return sink.bytes();
}

/// All that a reader gives.
struct AllRead {
  std::vector<Sample> sound, unsound;
  std::size_t attachments = 0, metadata = 0;
  std::vector<Problem> problems;
  ReadCounts counts;
  bool complete = false;
  std::vector<Sample> all() const {
    auto both = sound;
    both.insert(both.end(), unsound.begin(), unsound.end());
    std::ranges::sort(both);
    return both;
  }
};

inline AllRead read_all(Bytes bytes, Reading mode, bool check_crc = true) {
  AllRead result;
  RecordReader reader(bytes, {mode, check_crc, 1u << 24, "log.mcap"});
  for (Record record; reader.next(record);) {
    if (record.op == Op::attachment) ++result.attachments;
    if (record.op == Op::metadata) ++result.metadata;
    if (record.op != Op::message) continue;
    const auto m = record.message();
    auto& list = record.sound ? result.sound : result.unsound;
    list.push_back({reader.registry().channel(m.channel_id)->topic, m.sequence, m.log_time, std::string(as_text(m.data))});
  }
  result.problems = reader.problems();
  result.counts = reader.counts();
  result.complete = reader.complete();
  return result;
}

/// Where the chunks of an intact log are: offset of the record, of its end, and the messages in it.
struct ChunkSpan {
  std::uint64_t begin = 0, end = 0;
  std::size_t first_message = 0, messages = 0;
};

inline std::vector<ChunkSpan> chunks_of(Bytes log, int messages_per_chunk) {
  std::vector<ChunkSpan> spans;
  std::uint64_t at = kMagic.size();
  while (const auto raw = record_at(log, at)) {
    if (raw->op == Op::footer) break;
    if (raw->op == Op::chunk) {
      const auto n = static_cast<std::size_t>(messages_per_chunk);
      spans.push_back({at, raw->end, spans.size() * n, n});
    }
    at = raw->end;
  }
  return spans;
}

}  // namespace quadsonde::ingest::mcap
