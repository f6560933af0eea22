#include "ingest/mcap/records.h"

#include <libdeflate.h>

namespace quadsonde::ingest::mcap {
namespace {

/// A cursor whose first miss makes every later get fail too, so that a record reads as one line.
class Fields {
 public:
  explicit Fields(Bytes content) : cursor_(content) {}
  template <class T>
  Fields& operator()(T& number) {
    ok_ = ok_ && cursor_.get(number);
    return *this;
  }
  Fields& operator()(std::string_view& text) {
    Bytes bytes;
    if (sized<std::uint32_t>(bytes)) text = as_text(bytes);
    return *this;
  }
  Fields& operator()(StringPairs& pairs) {
    Bytes body;
    if (!sized<std::uint32_t>(body)) return *this;
    Fields inner(body);
    while (inner.ok_ && inner.cursor_.left() > 0) {
      std::pair<std::string_view, std::string_view> pair;
      inner(pair.first)(pair.second);
      if (inner.ok_) pairs.push_back(pair);
    }
    ok_ = inner.ok_;
    return *this;
  }
  template <class A, class B>
  Fields& operator()(std::vector<std::pair<A, B>>& pairs) {
    Bytes body;
    constexpr std::size_t kSize = sizeof(A) + sizeof(B);
    if (!sized<std::uint32_t>(body)) return *this;
    ok_ = body.size() % kSize == 0;
    if (!ok_) return *this;
    pairs.reserve(body.size() / kSize);
    for (std::size_t at = 0; at < body.size(); at += kSize)
      pairs.emplace_back(load<A>(body.data() + at), load<B>(body.data() + at + sizeof(A)));
    return *this;
  }
  /// Bytes after their own length of type Length.
  template <class Length>
  bool sized(Bytes& bytes) {
    Length length = 0;
    ok_ = ok_ && cursor_.get(length) && cursor_.get_bytes(length, bytes);
    return ok_;
  }
  bool ok() const { return ok_; }
  std::size_t at() const { return cursor_.at(); }

 private:
  Cursor cursor_;
  bool ok_ = true;
};

constexpr std::uint32_t kPolynomial = 0xEDB88320;  // of CRC-32, its bits in the order of the value's

/// Product of two polynomials over GF(2), modulo the CRC's; the top bit is x to the power of 0.
std::uint32_t multiply(std::uint32_t a, std::uint32_t b) {
  std::uint32_t product = 0;
  for (std::uint32_t bit = 1u << 31; bit != 0; bit >>= 1) {
    if (a & bit) product ^= b;
    b = b & 1 ? (b >> 1) ^ kPolynomial : b >> 1;
  }
  return product;
}

}  // namespace

std::optional<Header> parse_header(Bytes content) {
  Header r;
  if (!Fields(content)(r.profile)(r.library).ok()) return std::nullopt;
  return r;
}

std::optional<Footer> parse_footer(Bytes content) {
  Footer r;
  if (content.size() != kFooterSize) return std::nullopt;
  Fields fields(content);
  fields(r.summary_start)(r.summary_offset_start)(r.summary_crc);
  return r;
}

std::optional<Schema> parse_schema(Bytes content) {
  Schema r;
  Fields fields(content);
  fields(r.id)(r.name)(r.encoding);
  if (!fields.sized<std::uint32_t>(r.data)) return std::nullopt;
  return r;
}

std::optional<Channel> parse_channel(Bytes content) {
  Channel r;
  if (!Fields(content)(r.id)(r.schema_id)(r.topic)(r.message_encoding)(r.metadata).ok()) return std::nullopt;
  return r;
}

std::optional<Chunk> parse_chunk(Bytes content) {
  Chunk r;
  Fields fields(content);
  fields(r.message_start_time)(r.message_end_time)(r.uncompressed_size)(r.uncompressed_crc)(r.compression);
  if (!fields.sized<std::uint64_t>(r.records)) return std::nullopt;
  return r;
}

std::optional<MessageIndex> parse_message_index(Bytes content) {
  MessageIndex r;
  if (!Fields(content)(r.channel_id)(r.entries).ok()) return std::nullopt;
  return r;
}

std::optional<ChunkIndex> parse_chunk_index(Bytes content) {
  ChunkIndex r;
  if (!Fields(content)(r.message_start_time)(r.message_end_time)(r.chunk_start)(r.chunk_length)(
           r.message_index_offsets)(r.message_index_length)(r.compression)(r.compressed_size)(r.uncompressed_size)
           .ok())
    return std::nullopt;
  return r;
}

std::optional<Attachment> parse_attachment(Bytes content) {
  Attachment r;
  Fields fields(content);
  fields(r.log_time)(r.create_time)(r.name)(r.media_type);
  if (!fields.sized<std::uint64_t>(r.data)) return std::nullopt;
  r.covered = content.first(fields.at());
  if (!fields(r.crc).ok()) return std::nullopt;
  return r;
}

std::optional<AttachmentIndex> parse_attachment_index(Bytes content) {
  AttachmentIndex r;
  if (!Fields(content)(r.offset)(r.length)(r.log_time)(r.create_time)(r.data_size)(r.name)(r.media_type).ok())
    return std::nullopt;
  return r;
}

std::optional<Statistics> parse_statistics(Bytes content) {
  Statistics r;
  if (!Fields(content)(r.message_count)(r.schema_count)(r.channel_count)(r.attachment_count)(r.metadata_count)(
           r.chunk_count)(r.message_start_time)(r.message_end_time)(r.channel_message_counts)
           .ok())
    return std::nullopt;
  return r;
}

std::optional<Metadata> parse_metadata(Bytes content) {
  Metadata r;
  if (!Fields(content)(r.name)(r.metadata).ok()) return std::nullopt;
  return r;
}

std::optional<MetadataIndex> parse_metadata_index(Bytes content) {
  MetadataIndex r;
  if (!Fields(content)(r.offset)(r.length)(r.name).ok()) return std::nullopt;
  return r;
}

std::optional<SummaryOffset> parse_summary_offset(Bytes content) {
  SummaryOffset r;
  if (!Fields(content)(r.group)(r.start)(r.length).ok()) return std::nullopt;
  return r;
}

std::optional<std::uint32_t> parse_data_end(Bytes content) {
  std::uint32_t crc = 0;
  if (content.size() < sizeof(crc)) return std::nullopt;
  return load<std::uint32_t>(content.data());
}

std::uint32_t crc32(Bytes bytes, std::uint32_t so_far) {
  // The library takes a null pointer as "start anew".
  return bytes.empty() ? so_far : libdeflate_crc32(so_far, bytes.data(), bytes.size());
}

std::uint32_t joined_crc32(std::uint32_t crc_a, std::uint32_t crc_b, std::uint64_t length_b) {
  // A's polynomial moves up by the bits of B: times x to the power of 8 length_b, by squaring.
  std::uint32_t shift = 1u << 31, square = 1u << 23;  // x^0, x^8
  for (auto left = length_b; left != 0; left >>= 1) {
    if (left & 1) shift = multiply(shift, square);
    square = multiply(square, square);
  }
  return multiply(shift, crc_a) ^ crc_b;
}

}  // namespace quadsonde::ingest::mcap
