#pragma once
// Writes an MCAP file, front to back, into any sink.
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/mcap/compression.h"
#include "ingest/mcap/records.h"
#include "ingest/mcap/sink.h"

namespace quadsonde::ingest::mcap {

struct WriterSettings {
  std::string profile, library = "quadsonde";
  bool chunked = true;
  std::uint64_t chunk_size = 1u << 20;  ///< a chunk is closed when its records reach this [bytes, uncompressed]
  Compression compression = Compression::zstd;
  int level = 1;
  bool message_index = true, chunk_index = true, attachment_index = true, metadata_index = true;
  bool statistics = true, repeat_schemas = true, repeat_channels = true, summary_offsets = true;
  bool chunk_crc = true, data_crc = true, summary_crc = true, attachment_crc = true;
};

/// Bytes at the end of which the writer puts more; unlike a vector it does not fill what it grows by.
class WriteBuffer {
 public:
  /// Room for `count` more bytes, which the caller fills.
  std::uint8_t* grow(std::size_t count) {
    if (capacity_ - size_ < count) reserve(size_ + count);
    auto* at = bytes_.get() + size_;
    size_ += count;
    return at;
  }
  void put(Bytes bytes) {
    if (!bytes.empty()) std::memcpy(grow(bytes.size()), bytes.data(), bytes.size());
  }
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::uint8_t* data() { return bytes_.get(); }
  operator Bytes() const { return {bytes_.get(), size_}; }

 private:
  void reserve(std::size_t least);
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Same calls, same bytes. Schemas and channels are written before the first message on them, in the same chunk; those
/// without messages at the end of the data. Once a call fails, all later ones fail.
class Writer {
 public:
  using Pairs = std::vector<std::pair<std::string, std::string>>;

  /// @param sink  must outlive the writer
  Writer(Sink& sink, WriterSettings settings);

  /// @return the id, from 1 upwards; fails with limit after 65535
  Result<std::uint16_t> add_schema(std::string name, std::string encoding, Bytes data);
  /// @param schema_id  of add_schema, or 0 for none
  Result<std::uint16_t> add_channel(std::uint16_t schema_id, std::string topic, std::string message_encoding,
                                    Pairs metadata = {});
  Result<void> write(const Message& message);
  /// Attachments and metadata stand between chunks, where they come.
  Result<void> attach(std::uint64_t log_time, std::uint64_t create_time, const std::string& name,
                      const std::string& media_type, Bytes data);
  Result<void> add_metadata(const std::string& name, const Pairs& pairs);
  /// Ends the file. Without it the file is cut, and reads as such.
  Result<void> close();

 private:
  struct Definition {
    std::uint16_t schema_id = 0;
    WriteBuffer record;
    bool written = false;
  };
  struct ChannelState {
    Definition definition;
    std::uint64_t messages = 0;
    WriteBuffer entries;  // of the chunk's message index, as they stand in the file
  };

  WriteBuffer& target() { return settings_.chunked ? chunk_ : direct_; }
  void define(Definition& channel);
  void put_message(const Message& message, WriteBuffer& out);
  Result<void> emit(Bytes bytes, std::optional<std::uint32_t> crc = std::nullopt);
  Result<void> flush_direct();
  Result<void> end_chunk();
  Result<void> emit_chunk(Bytes records);
  Result<void> emit_message_indexes(std::uint64_t chunk_start, std::uint64_t chunk_length, std::uint64_t compressed);
  Result<void> emit_summary();
  void count(const Message& message, ChannelState& channel);
  void summarise_statistics(WriteBuffer& out) const;

  Sink& sink_;
  WriterSettings settings_;
  Compressor compressor_;
  bool failed_ = false, closed_ = false;
  std::uint64_t position_ = 0;
  std::uint32_t data_crc_ = 0;

  std::vector<Definition> schemas_;     // by id - 1
  std::vector<ChannelState> channels_;  // by id - 1
  WriteBuffer chunk_, direct_;
  std::vector<std::uint8_t> packed_;
  std::uint64_t chunk_first_ = 0, chunk_last_ = 0, chunk_messages_ = 0;

  std::uint64_t messages_ = 0, first_ = 0, last_ = 0;
  std::uint32_t attachments_ = 0, metadata_ = 0, chunks_ = 0;
  WriteBuffer chunk_index_, attachment_index_, metadata_index_;
};

}  // namespace quadsonde::ingest::mcap
