#pragma once
// The records of an MCAP file as views into its bytes. Source: MCAP specification, version 0.
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "ingest/flight/bytes.h"

namespace quadsonde::ingest::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kHeadSize = 9;     ///< opcode and length before the content of a record
inline constexpr std::size_t kFooterSize = 20;  ///< content of a footer; it never grows
inline constexpr std::size_t kTailSize = kHeadSize + kFooterSize + kMagic.size();

enum class Op : std::uint8_t {
  none = 0,
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F
};

/// Pairs in file order; views into the record.
using StringPairs = std::vector<std::pair<std::string_view, std::string_view>>;

struct Header {
  std::string_view profile, library;
};
struct Footer {
  std::uint64_t summary_start = 0, summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
};
struct Schema {
  std::uint16_t id = 0;
  std::string_view name, encoding;
  Bytes data;
};
struct Channel {
  std::uint16_t id = 0, schema_id = 0;
  std::string_view topic, message_encoding;
  StringPairs metadata;
};
struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;
  Bytes data;
};
struct Chunk {
  std::uint64_t message_start_time = 0, message_end_time = 0, uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string_view compression;
  Bytes records;  ///< as they stand in the file
};
struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  ///< log_time, offset in the uncompressed records
};
struct ChunkIndex {
  std::uint64_t message_start_time = 0, message_end_time = 0, chunk_start = 0, chunk_length = 0;
  std::vector<std::pair<std::uint16_t, std::uint64_t>> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string_view compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
};
struct Attachment {
  std::uint64_t log_time = 0, create_time = 0;
  std::string_view name, media_type;
  Bytes data;
  std::uint32_t crc = 0;
  Bytes covered;  ///< what the CRC is over
};
struct AttachmentIndex {
  std::uint64_t offset = 0, length = 0, log_time = 0, create_time = 0, data_size = 0;
  std::string_view name, media_type;
};
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0, attachment_count = 0, metadata_count = 0, chunk_count = 0;
  std::uint64_t message_start_time = 0, message_end_time = 0;
  std::vector<std::pair<std::uint16_t, std::uint64_t>> channel_message_counts;
};
struct Metadata {
  std::string_view name;
  StringPairs metadata;
};
struct MetadataIndex {
  std::uint64_t offset = 0, length = 0;
  std::string_view name;
};
struct SummaryOffset {
  Op group = Op::none;
  std::uint64_t start = 0, length = 0;
};

/// Each takes the content of a record and gives its fields, or nothing if a length does not fit. Bytes behind the
/// known fields are ignored, as newer writers may append fields.
std::optional<Header> parse_header(Bytes content);
std::optional<Footer> parse_footer(Bytes content);
std::optional<Schema> parse_schema(Bytes content);
std::optional<Channel> parse_channel(Bytes content);
std::optional<Chunk> parse_chunk(Bytes content);
std::optional<MessageIndex> parse_message_index(Bytes content);
std::optional<ChunkIndex> parse_chunk_index(Bytes content);
std::optional<Attachment> parse_attachment(Bytes content);
std::optional<AttachmentIndex> parse_attachment_index(Bytes content);
std::optional<Statistics> parse_statistics(Bytes content);
std::optional<Metadata> parse_metadata(Bytes content);
std::optional<MetadataIndex> parse_metadata_index(Bytes content);
std::optional<SummaryOffset> parse_summary_offset(Bytes content);
std::optional<std::uint32_t> parse_data_end(Bytes content);

inline constexpr std::size_t kMessageHead = 22;  ///< fields of a message before its data

/// The caller has checked that content has kMessageHead bytes.
inline Message load_message(Bytes content) {
  const auto* at = content.data();
  return {load<std::uint16_t>(at), load<std::uint32_t>(at + 2), load<std::uint64_t>(at + 6),
          load<std::uint64_t>(at + 14), content.subspan(kMessageHead)};
}
inline std::optional<Message> parse_message(Bytes content) {
  if (content.size() < kMessageHead) return std::nullopt;
  return load_message(content);
}

/// Opcode and content at an offset; nothing if the record does not fit into the bytes or its opcode is 0.
struct RawRecord {
  Op op = Op::none;
  Bytes content;
  std::uint64_t end = 0;  ///< offset behind the record
};
inline std::optional<RawRecord> record_at(Bytes bytes, std::uint64_t at) {
  if (at > bytes.size() || bytes.size() - at < kHeadSize) return std::nullopt;
  const auto length = load<std::uint64_t>(bytes.data() + at + 1);
  if (bytes[at] == 0 || length > bytes.size() - at - kHeadSize) return std::nullopt;
  return RawRecord{static_cast<Op>(bytes[at]), bytes.subspan(at + kHeadSize, length), at + kHeadSize + length};
}

inline bool has_magic(Bytes bytes, std::uint64_t at) {
  return at <= bytes.size() && bytes.size() - at >= kMagic.size() &&
         std::memcmp(bytes.data() + at, kMagic.data(), kMagic.size()) == 0;
}

/// CRC-32 of zlib, starting from or going on with a value of it.
std::uint32_t crc32(Bytes bytes, std::uint32_t so_far = 0);
/// The CRC-32 of bytes A and B behind each other, from those of each and the length of B: no byte is looked at.
std::uint32_t joined_crc32(std::uint32_t crc_a, std::uint32_t crc_b, std::uint64_t length_b);

}  // namespace quadsonde::ingest::mcap
