#include "ingest/mcap/writer.h"

#include <fmt/format.h>

#include <algorithm>

namespace quadsonde::ingest::mcap {
namespace {

using Buffer = WriteBuffer;
constexpr std::size_t kIndexEntry = 16;  // log time and offset

template <class T>
  requires std::is_arithmetic_v<T>
void put(Buffer& out, T number) {
  std::memcpy(out.grow(sizeof(T)), &number, sizeof(T));
}
void put(Buffer& out, Op op) { put(out, static_cast<std::uint8_t>(op)); }
void put(Buffer& out, Bytes bytes) { out.put(bytes); }
void put(Buffer& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  put(out, as_bytes(text));
}
void put(Buffer& out, const Writer::Pairs& pairs) {
  std::uint32_t size = 0;
  for (const auto& [key, value] : pairs) size += static_cast<std::uint32_t>(8 + key.size() + value.size());
  put(out, size);
  for (const auto& [key, value] : pairs) {
    put(out, std::string_view(key));
    put(out, std::string_view(value));
  }
}

/// A record whose length is set when its scope ends.
class Open {
 public:
  Open(Buffer& out, Op op) : out_(out) {
    put(out_, op);
    put(out_, std::uint64_t{0});
    start_ = out_.size();
  }
  ~Open() {
    const std::uint64_t length = out_.size() - start_;
    std::memcpy(out_.data() + start_ - sizeof(length), &length, sizeof(length));
  }

 private:
  Buffer& out_;
  std::size_t start_;
};

}  // namespace

void WriteBuffer::reserve(std::size_t least) {
  capacity_ = std::max(least, 2 * capacity_);
  auto larger = std::make_unique_for_overwrite<std::uint8_t[]>(capacity_);
  if (size_ > 0) std::memcpy(larger.get(), bytes_.get(), size_);
  bytes_ = std::move(larger);
}

Writer::Writer(Sink& sink, WriterSettings settings) : sink_(sink), settings_(std::move(settings)) {
  put(direct_, Bytes(kMagic));
  Open record(direct_, Op::header);
  put(direct_, std::string_view(settings_.profile));
  put(direct_, std::string_view(settings_.library));
}

Result<std::uint16_t> Writer::add_schema(std::string name, std::string encoding, Bytes data) {
  if (schemas_.size() >= 65535) return fail(Kind::limit, "more than 65535 schemas");
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  Definition schema;
  {
    Open record(schema.record, Op::schema);
    put(schema.record, id);
    put(schema.record, std::string_view(name));
    put(schema.record, std::string_view(encoding));
    put(schema.record, static_cast<std::uint32_t>(data.size()));
    put(schema.record, data);
  }
  schemas_.push_back(std::move(schema));
  return id;
}

Result<std::uint16_t> Writer::add_channel(std::uint16_t schema_id, std::string topic, std::string message_encoding,
                                          Pairs metadata) {
  if (channels_.size() >= 65535) return fail(Kind::limit, "more than 65535 channels");
  if (schema_id > schemas_.size()) return fail(Kind::usage, fmt::format("schema {} was never added", schema_id));
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  ChannelState channel;
  auto& definition = channel.definition;
  definition.schema_id = schema_id;
  {
    Open record(definition.record, Op::channel);
    put(definition.record, id);
    put(definition.record, schema_id);
    put(definition.record, std::string_view(topic));
    put(definition.record, std::string_view(message_encoding));
    put(definition.record, metadata);
  }
  channels_.push_back(std::move(channel));
  return id;
}

void Writer::define(Definition& channel) {
  if (channel.schema_id != 0 && !schemas_[channel.schema_id - 1].written) {
    put(target(), Bytes(schemas_[channel.schema_id - 1].record));
    schemas_[channel.schema_id - 1].written = true;
  }
  put(target(), Bytes(channel.record));
  channel.written = true;
}

void Writer::count(const Message& message, ChannelState& channel) {
  const auto time = message.log_time;
  first_ = messages_ ? std::min(first_, time) : time;
  last_ = messages_ ? std::max(last_, time) : time;
  ++messages_;
  ++channel.messages;
  if (!settings_.chunked) return;
  chunk_first_ = chunk_messages_ ? std::min(chunk_first_, time) : time;
  chunk_last_ = chunk_messages_ ? std::max(chunk_last_, time) : time;
  ++chunk_messages_;
  if (!settings_.message_index) return;
  const std::uint64_t offset = chunk_.size();
  auto* const entry = channel.entries.grow(kIndexEntry);
  std::memcpy(entry, &time, sizeof(time));
  std::memcpy(entry + sizeof(time), &offset, sizeof(offset));
}

void Writer::put_message(const Message& message, WriteBuffer& out) {
  auto* const head = out.grow(kHeadSize + kMessageHead + message.data.size());
  const auto set = [head](std::size_t at, auto number) { std::memcpy(head + at, &number, sizeof(number)); };
  set(0, Op::message);
  set(1, std::uint64_t{kMessageHead + message.data.size()});
  set(9, message.channel_id);
  set(11, message.sequence);
  set(15, message.log_time);
  set(23, message.publish_time);
  if (!message.data.empty()) std::memcpy(head + kHeadSize + kMessageHead, message.data.data(), message.data.size());
}

Result<void> Writer::write(const Message& message) {
  if (message.channel_id == 0 || message.channel_id > channels_.size())
    return fail(Kind::usage, fmt::format("channel {} was never added", message.channel_id));
  auto& channel = channels_[message.channel_id - 1];
  if (!channel.definition.written) define(channel.definition);
  count(message, channel);
  auto& out = target();
  put_message(message, out);
  if (out.size() >= settings_.chunk_size) return settings_.chunked ? end_chunk() : flush_direct();
  // Not `return {}`: it fills the room of a Problem with zeros, which takes longer than all of the above.
  Result<void> done;
  return done;
}

/// @param crc  of the bytes, where it is known already
Result<void> Writer::emit(Bytes bytes, std::optional<std::uint32_t> crc) {
  if (failed_ || closed_) return fail(Kind::write_failed, "this log is already closed");
  failed_ = !sink_.write(bytes);
  if (failed_) return fail(Kind::write_failed, "the log cannot be written", {}, "check that the disk has room");
  if (settings_.data_crc) data_crc_ = crc ? joined_crc32(data_crc_, *crc, bytes.size()) : crc32(bytes, data_crc_);
  position_ += bytes.size();
  return {};
}

Result<void> Writer::flush_direct() {
  auto done = emit(direct_);
  direct_.clear();
  return done;
}

Result<void> Writer::end_chunk() {
  if (auto flushed = flush_direct(); !flushed) return flushed;
  if (chunk_.empty()) return {};
  Bytes records = chunk_;
  if (settings_.compression != Compression::none) {
    if (!compressor_.run(settings_.compression, settings_.level, chunk_, packed_))
      return fail(Kind::write_failed, "a chunk cannot be compressed");
    records = packed_;
  }
  auto done = emit_chunk(records);
  chunk_.clear();
  for (auto& channel : channels_) channel.entries.clear();
  chunk_first_ = chunk_last_ = chunk_messages_ = 0;
  return done;
}

Result<void> Writer::emit_chunk(Bytes records) {
  const auto name = name_of(settings_.compression);
  Buffer head;
  constexpr std::size_t kFixed = 3 * 8 + 4 + 4 + 8;
  put(head, Op::chunk);
  put(head, std::uint64_t{kFixed + name.size() + records.size()});
  put(head, chunk_first_);
  put(head, chunk_last_);
  put(head, std::uint64_t{chunk_.size()});
  const auto crc = settings_.chunk_crc ? crc32(chunk_) : std::uint32_t{0};
  put(head, crc);
  put(head, name);
  put(head, std::uint64_t{records.size()});
  const auto start = position_;
  if (auto done = emit(head); !done) return done;
  const bool same_bytes = settings_.chunk_crc && settings_.compression == Compression::none;
  if (auto done = emit(records, same_bytes ? std::optional(crc) : std::nullopt); !done) return done;
  ++chunks_;
  return emit_message_indexes(start, position_ - start, records.size());
}

Result<void> Writer::emit_message_indexes(std::uint64_t chunk_start, std::uint64_t chunk_length,
                                          std::uint64_t compressed) {
  Buffer indexes;
  const auto base = position_;
  std::vector<std::pair<std::uint16_t, std::uint64_t>> offsets;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto& entries = channels_[i].entries;
    if (entries.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    offsets.emplace_back(id, base + indexes.size());
    Open record(indexes, Op::message_index);
    put(indexes, id);
    put(indexes, static_cast<std::uint32_t>(entries.size()));
    put(indexes, Bytes(entries));
  }
  if (settings_.chunk_index) {
    Open record(chunk_index_, Op::chunk_index);
    for (const auto number : {chunk_first_, chunk_last_, chunk_start, chunk_length}) put(chunk_index_, number);
    put(chunk_index_, static_cast<std::uint32_t>(offsets.size() * 10));
    for (const auto& [id, offset] : offsets) {
      put(chunk_index_, id);
      put(chunk_index_, offset);
    }
    put(chunk_index_, std::uint64_t{indexes.size()});
    put(chunk_index_, name_of(settings_.compression));
    put(chunk_index_, compressed);
    put(chunk_index_, std::uint64_t{chunk_.size()});
  }
  return emit(indexes);
}

Result<void> Writer::attach(std::uint64_t log_time, std::uint64_t create_time, const std::string& name,
                            const std::string& media_type, Bytes data) {
  if (auto done = end_chunk(); !done) return done;
  const auto start = position_;
  Buffer out;
  put(out, Op::attachment);
  put(out, std::uint64_t{8 + 8 + 4 + name.size() + 4 + media_type.size() + 8 + data.size() + 4});
  put(out, log_time);
  put(out, create_time);
  put(out, std::string_view(name));
  put(out, std::string_view(media_type));
  put(out, std::uint64_t{data.size()});
  const auto crc = settings_.attachment_crc ? crc32(data, crc32(Bytes(out).subspan(kHeadSize))) : 0;
  if (auto done = emit(out); !done) return done;
  if (auto done = emit(data); !done) return done;
  out.clear();
  put(out, crc);
  if (auto done = emit(out); !done) return done;
  ++attachments_;
  Open record(attachment_index_, Op::attachment_index);
  for (const auto number : {start, position_ - start, log_time, create_time, std::uint64_t{data.size()}})
    put(attachment_index_, number);
  put(attachment_index_, std::string_view(name));
  put(attachment_index_, std::string_view(media_type));
  return {};
}

Result<void> Writer::add_metadata(const std::string& name, const Pairs& pairs) {
  if (auto done = end_chunk(); !done) return done;
  const auto start = position_;
  {
    Open record(direct_, Op::metadata);
    put(direct_, std::string_view(name));
    put(direct_, pairs);
  }
  if (auto done = flush_direct(); !done) return done;
  ++metadata_;
  Open record(metadata_index_, Op::metadata_index);
  put(metadata_index_, start);
  put(metadata_index_, position_ - start);
  put(metadata_index_, std::string_view(name));
  return {};
}

void Writer::summarise_statistics(Buffer& out) const {
  Open record(out, Op::statistics);
  const auto used = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  put(out, messages_);
  put(out, static_cast<std::uint16_t>(schemas_.size()));
  for (const auto number : {used(channels_), attachments_, metadata_, chunks_}) put(out, number);
  put(out, first_);
  put(out, last_);
  const auto counted = std::ranges::count_if(channels_, [](const auto& channel) { return channel.messages > 0; });
  put(out, static_cast<std::uint32_t>(counted * 10));
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].messages == 0) continue;
    put(out, static_cast<std::uint16_t>(i + 1));
    put(out, channels_[i].messages);
  }
}

Result<void> Writer::emit_summary() {
  Buffer schemas, channels, statistics, out, offsets;
  for (const auto& schema : schemas_) put(schemas, Bytes(schema.record));
  for (const auto& channel : channels_) put(channels, Bytes(channel.definition.record));
  if (settings_.statistics) summarise_statistics(statistics);
  const auto start = position_;
  const auto group = [&](bool wanted, Op op, const Buffer& records) {
    if (!wanted || records.empty()) return;
    const auto group_start = start + out.size();
    put(out, Bytes(records));
    Open record(offsets, Op::summary_offset);
    put(offsets, static_cast<std::uint8_t>(op));
    put(offsets, group_start);
    put(offsets, std::uint64_t{records.size()});
  };
  group(settings_.repeat_schemas, Op::schema, schemas);
  group(settings_.repeat_channels, Op::channel, channels);
  group(settings_.statistics, Op::statistics, statistics);
  group(settings_.metadata_index, Op::metadata_index, metadata_index_);
  group(settings_.attachment_index, Op::attachment_index, attachment_index_);
  group(settings_.chunk_index, Op::chunk_index, chunk_index_);
  const bool any = !out.empty(), any_offsets = any && settings_.summary_offsets;
  const auto offsets_start = start + out.size();
  if (any_offsets) put(out, Bytes(offsets));
  put(out, Op::footer);
  put(out, std::uint64_t{kFooterSize});
  put(out, any ? start : 0);
  put(out, any_offsets ? offsets_start : 0);
  put(out, settings_.summary_crc ? crc32(out) : std::uint32_t{0});
  put(out, Bytes(kMagic));
  return emit(out);
}

Result<void> Writer::close() {
  for (auto& channel : channels_)
    if (!channel.definition.written) define(channel.definition);
  for (auto& schema : schemas_) {
    if (!schema.written) put(target(), Bytes(schema.record));
    schema.written = true;
  }
  if (auto done = end_chunk(); !done) return done;
  {
    Open record(direct_, Op::data_end);
    put(direct_, data_crc_);
  }
  if (auto done = flush_direct(); !done) return done;
  auto done = emit_summary();
  closed_ = true;
  return done;
}

}  // namespace quadsonde::ingest::mcap
