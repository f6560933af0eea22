// The parts of RecordReader that meet compressed, cut and damaged bytes.
#include <fmt/format.h>

#include <algorithm>

#include "ingest/mcap/reader.h"

namespace quadsonde::ingest::mcap {
namespace {

// The search behind damage looks at no more than this many times the file; only a malicious file needs more.
constexpr std::uint64_t kSearchEffort = 16;

bool parses(const RawRecord& raw) {
  switch (raw.op) {
    case Op::schema:
      return parse_schema(raw.content).has_value();
    case Op::channel:
      return parse_channel(raw.content).has_value();
    case Op::message:
      return raw.content.size() >= kMessageHead;
    case Op::chunk:
      return parse_chunk(raw.content).has_value();
    case Op::message_index:
      return parse_message_index(raw.content).has_value();
    case Op::attachment:
      return parse_attachment(raw.content).has_value();
    case Op::metadata:
      return parse_metadata(raw.content).has_value();
    case Op::data_end:
      return raw.content.size() == 4;
    default:
      return false;
  }
}

/// The compression that the first bytes of a chunk show, whatever its damaged name says.
std::optional<Compression> sniff(Bytes records) {
  if (records.size() < 4) return std::nullopt;
  const auto magic = load<std::uint32_t>(records.data());
  if (magic == 0x184D2204) return Compression::lz4;
  if (magic == 0xFD2FB528) return Compression::zstd;
  return std::nullopt;
}

}  // namespace

/// @param cut  the records end before the chunk says: what is there is taken, unverified
void RecordReader::open_chunk(const Chunk& chunk, std::uint64_t offset, bool cut) {
  chunk_offset_ = offset;
  chunk_first_ = chunk.message_start_time;
  chunk_last_ = chunk.message_end_time;
  chunk_sound_ = true;
  chunk_at_ = 0;
  chunk_ = {};
  if (chunk.uncompressed_size > settings_.max_chunk) {
    complain(Kind::limit, fmt::format("a chunk of {} bytes says that it unpacks to {}; the limit is {}",
                                      chunk.records.size(), chunk.uncompressed_size, settings_.max_chunk),
             offset, {}, "the chunk is left out");
    counts_.bytes_given_up += chunk.records.size();
    return;
  }
  unpack(chunk, offset, cut);
}

void RecordReader::unpack(const Chunk& chunk, std::uint64_t offset, bool cut) {
  auto compression = compression_named(chunk.compression);
  if (!compression) {
    complain(Kind::unsupported, fmt::format("a chunk is compressed with \"{}\", which is not known here",
                                            chunk.compression.substr(0, 40)),
             offset, {}, fmt::format("{} bytes are left out", chunk.records.size()));
    compression = settings_.mode == Reading::salvage ? sniff(chunk.records) : std::nullopt;
    if (!compression) {
      counts_.bytes_given_up += chunk.records.size();
      return;
    }
  }
  bool whole;
  if (*compression == Compression::none) {
    whole = chunk.records.size() == chunk.uncompressed_size;
    chunk_ = chunk.records.first(std::min<std::uint64_t>(chunk.records.size(), chunk.uncompressed_size));
  } else {
    whole = decompressor_.run(*compression, chunk.records, chunk.uncompressed_size, buffer_);
    chunk_ = buffer_;
  }
  chunk_checked_ = settings_.check_crc && chunk.uncompressed_crc != 0 && whole && crc32(chunk_) == chunk.uncompressed_crc;
  if (cut)
    distrust_chunk("the file ends inside this chunk", true);
  else if (!whole)
    distrust_chunk("this chunk does not unpack to the size that it says", settings_.mode == Reading::salvage);
  else if (settings_.check_crc && chunk.uncompressed_crc != 0 && !chunk_checked_)
    distrust_chunk("the CRC of this chunk differs", settings_.mode == Reading::salvage);
  else
    // Behind lost structure only the chunk's own CRC can vouch for it.
    chunk_sound_ = !behind_loss_ || chunk_checked_;
}

/// @param keep  true: its records come, not sound, up to the first implausible one; false: they are only counted
void RecordReader::distrust_chunk(const std::string& what, bool keep) {
  chunk_sound_ = false;
  if (settings_.mode == Reading::strict) {
    complain(Kind::damaged, what, chunk_offset_, {}, "");
    return close_chunk();
  }
  const auto seen = count_left();
  if (keep) {
    complain(Kind::damaged, what, chunk_offset_, {},
             fmt::format("{} messages in it look whole and are kept, unverified", seen));
    return;
  }
  counts_.lost += seen;
  counts_.bytes_given_up += chunk_.size();
  complain(Kind::damaged, what, chunk_offset_, {},
           fmt::format("{} messages are left out; recover them with convert --recover", seen));
  close_chunk();
}

/// In bytes that no CRC vouches for, a record that cannot be is the end of what is believed.
bool RecordReader::implausible(const RawRecord& raw) const {
  if (raw.op == Op::schema || raw.op == Op::channel) return !parses(raw);
  if (raw.op != Op::message || raw.content.size() < kMessageHead) return true;
  const auto message = load_message(raw.content);
  if (message.log_time < chunk_first_ || message.log_time > chunk_last_) return true;
  return !registry_.has_channel(message.channel_id) &&
         !(summary_ && summary_->registry.channel(message.channel_id));
}

/// Counts the plausible messages from here on, and learns the channels that stand among them.
std::uint64_t RecordReader::count_left() {
  std::uint64_t messages = 0;
  for (auto at = chunk_at_; const auto raw = record_at(chunk_, at);) {
    if (!chunk_sound_ && implausible(*raw)) break;
    if (raw->op == Op::message) ++messages;
    learn_unsound(*raw);
    at = raw->end;
  }
  return messages;
}

std::uint64_t RecordReader::next_start_after(std::uint64_t at) const {
  const auto found = std::ranges::upper_bound(starts_, at);
  return found == starts_.end() ? file_.size() : *found;
}

bool RecordReader::straddles_start(const RawRecord& raw) const {
  return !in_summary_ && next_start_after(at_) < raw.end;
}

/// A chunk whose record does not fit: cut by the end of the file, or with a damaged length and whole content.
bool RecordReader::open_cut_chunk() {
  if (settings_.mode == Reading::strict || in_summary_) return false;
  const auto limit = next_start_after(at_);
  if (file_[at_] != static_cast<std::uint8_t>(Op::chunk) || limit - at_ < kHeadSize) return false;
  auto rest = file_.subspan(at_ + kHeadSize, limit - at_ - kHeadSize);
  constexpr std::size_t kFixed = 3 * 8 + 4;
  Cursor cursor(rest, kFixed);
  std::uint32_t name = 0;
  std::uint64_t length = 0;
  if (rest.size() < kFixed || !cursor.get(name) || name > 16 || !cursor.skip(name) || !cursor.get(length)) return false;
  const auto end = at_ + kHeadSize + cursor.at() + std::min<std::uint64_t>(length, cursor.left());
  const bool cut = length > cursor.left();
  // A length that fits after all must lead to a record, else it is as damaged as the outer one.
  if (cut ? limit != file_.size() : end != limit && !is_plausible(end, limit, 1)) return false;
  Chunk chunk{load<std::uint64_t>(rest.data()), load<std::uint64_t>(rest.data() + 8),
              load<std::uint64_t>(rest.data() + 16), load<std::uint32_t>(rest.data() + 24),
              as_text(rest.subspan(kFixed + 4, name)), cursor.left() ? rest.subspan(cursor.at(), end - at_ - kHeadSize - cursor.at()) : Bytes{}};
  const auto offset = at_;
  if (!cut) complain(Kind::damaged, "the length of this chunk's record is damaged", at_, {}, "its content says it, too");
  at_ = end;
  if (cut) chunk.uncompressed_size = std::min(chunk.uncompressed_size, settings_.max_chunk);
  open_chunk(chunk, offset, cut);
  return true;
}

/// Goes on at the next place that the index knows or, in salvage mode, that looks like records.
void RecordReader::structure_lost(const std::string& what) {
  const auto from = at_;
  const auto start = in_summary_ ? file_.size() : next_start_after(from);
  auto to = start;
  if (settings_.mode == Reading::salvage && !in_summary_)
    to = find_plausible(from + 1, start, start);
  const bool at_end = to >= file_.size();
  if (settings_.mode == Reading::strict || at_end) to = file_.size();
  counts_.bytes_given_up += to - from;
  complain(at_end && !has_magic(file_, file_.size() - std::min(file_.size(), kMagic.size())) ? Kind::truncated
                                                                                             : Kind::damaged,
           fmt::format("{}: {} bytes are given up", what, to - from), from, {},
           at_end ? settings_.mode == Reading::salvage || in_summary_
                        ? ""
                        : "everything before is used; convert --recover searches behind it"
                  : fmt::format("reading goes on at byte {}", to));
  behind_loss_ = true;
  at_ = to;
  if (at_end) done_ = true;
}

/// The first place in [from, to) where records seem to go on, seen up to end; `to` if there is none.
std::uint64_t RecordReader::find_plausible(std::uint64_t from, std::uint64_t to, std::uint64_t end) {
  constexpr int kInARow = 3;
  while (from < to && !is_plausible(from, end, kInARow)) ++from;
  return from;
}

/// In salvage mode: a record that leads nowhere, with records inside it, has a length that grew.
bool RecordReader::swallows_others(const RawRecord& raw) {
  if (settings_.mode != Reading::salvage || in_summary_) return false;
  if (raw.op == Op::chunk || raw.op == Op::data_end || raw.op == Op::footer) return false;
  const auto limit = next_start_after(at_);
  if (raw.end >= limit || is_plausible(raw.end, limit, 1)) return false;
  return find_plausible(at_ + 1, raw.end, limit) < raw.end;
}

/// @param depth  how many records in a row have to look right
bool RecordReader::is_plausible(std::uint64_t at, std::uint64_t end, int depth) {
  const auto raw = record_at(file_.first(end), at);
  if (!raw) return false;
  // Messages, chunks and attachments are looked at in a few bytes, whatever their size.
  const bool cheap = raw->op == Op::message || raw->op == Op::chunk || raw->op == Op::attachment;
  search_cost_ += cheap ? kHeadSize : raw->content.size();
  if (search_cost_ / kSearchEffort > file_.size() + (1u << 20) || !parses(*raw)) return false;
  if (raw->op == Op::message) {
    const auto id = load<std::uint16_t>(raw->content.data());
    if (!registry_.has_channel(id) && !(summary_ && summary_->registry.channel(id))) return false;
  }
  if (raw->op == Op::data_end || raw->end == end || depth <= 1) return true;
  if (end - raw->end < kHeadSize) return end == file_.size();
  return is_plausible(raw->end, end, depth - 1);
}

}  // namespace quadsonde::ingest::mcap
