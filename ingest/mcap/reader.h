#pragma once
// An MCAP file from front to back, record by record, as far as it is whole and (in salvage mode) beyond.
#include <string>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/mcap/compression.h"
#include "ingest/mcap/problem_list.h"
#include "ingest/mcap/registry.h"
#include "ingest/mcap/summary.h"

namespace quadsonde::ingest::mcap {

struct ReadSettings {
  Reading mode = Reading::tolerant;
  bool check_crc = true;                  ///< false: no CRC is computed
  std::uint64_t max_chunk = 256u << 20;   ///< larger uncompressed chunks are refused (decompression bombs) [bytes]
  std::string file_name;                  ///< for Problems only
};

/// A record and where it came from. content is valid until the next call of next().
struct Record {
  Op op = Op::none;
  Bytes content;
  std::uint64_t offset = 0;  ///< in the file: of the record, or of the chunk that holds it
  bool in_chunk = false;
  /// False for what no intact CRC and no intact structure vouches for: a chunk whose CRC failed, the front of a cut
  /// chunk, records found behind damage.
  bool sound = true;
  /// For op message; content has been checked.
  Message message() const { return load_message(content); }
};

struct ReadCounts {
  std::uint64_t messages = 0;  ///< given out, salvaged ones included
  std::uint64_t salvaged = 0;  ///< of them, not sound
  std::uint64_t lost = 0;      ///< known to have been there and not given out
  std::uint64_t bytes_given_up = 0;
};

/// Reads forward. Records inside a chunk come in its place; chunk records themselves do not come. Private and unknown
/// records are skipped. Schemas, channels, attachments and metadata come only if they parse, messages only if their
/// channel is known. In strict mode the first Problem ends the reading.
/// Memory: one uncompressed chunk and the registry. Times as stored, nanoseconds.
class RecordReader {
 public:
  /// @param file  must outlive the reader and everything it gives
  explicit RecordReader(Bytes file, ReadSettings settings = {});

  /// @return false at the end, whatever that is; look at problems() then
  bool next(Record& record) {
    const auto left = chunk_.size() - chunk_at_;
    if (left >= kHeadSize + kMessageHead && chunk_[chunk_at_] == static_cast<std::uint8_t>(Op::message)) {
      const auto* at = chunk_.data() + chunk_at_;
      const auto length = load<std::uint64_t>(at + 1);
      if (chunk_sound_ && length >= kMessageHead && length <= left - kHeadSize &&
          registry_.has_channel(load<std::uint16_t>(at + kHeadSize))) {
        record = {Op::message, {at + kHeadSize, static_cast<std::size_t>(length)}, chunk_offset_, true, true};
        chunk_at_ += kHeadSize + static_cast<std::size_t>(length);
        ++counts_.messages;
        return true;
      }
    }
    if (left == 0 && next_loose(record)) return true;
    return next_slow(record);
  }

  const Registry& registry() const { return registry_; }
  const std::vector<Problem>& problems() const { return problems_.list(); }
  const ReadCounts& counts() const { return counts_; }
  /// True once the footer and the end mark were met where they belong.
  bool complete() const { return complete_; }

 private:
  enum class Step { give, skip, lost };

  /// A message outside of chunks in an undamaged place; false if anything needs a closer look.
  bool next_loose(Record& record) {
    if (!loose_is_plain_ || at_ + kHeadSize + kMessageHead > plain_until_) return false;
    const auto* at = file_.data() + at_;
    const auto length = load<std::uint64_t>(at + 1);
    if (*at != static_cast<std::uint8_t>(Op::message) || length < kMessageHead ||
        length > plain_until_ - at_ - kHeadSize || !registry_.has_channel(load<std::uint16_t>(at + kHeadSize)))
      return false;
    if (settings_.check_crc && at_ - data_crc_at_ >= kCrcStride) advance_data_crc(at_, true);
    record = {Op::message, {at + kHeadSize, static_cast<std::size_t>(length)}, at_, false, true};
    at_ += kHeadSize + length;
    ++counts_.messages;
    return true;
  }

  bool next_slow(Record& record);
  bool next_in_chunk(Record& record);
  bool next_at_top(Record& record);
  void start();
  Step take(const RawRecord& raw, Record& record);
  Step take_message(Record& record);
  Step take_attachment(Record& record);
  Step take_data_end(const RawRecord& raw);
  Step take_footer(const RawRecord& raw);
  template <class T>
  Step take_definition(const std::optional<T>& parsed, const Record& record, const char* what);
  template <class T>
  bool contradicts_summary(const T& definition);
  template <class T>
  void learn_unsound(const std::optional<T>& definition);
  void learn_unsound(const RawRecord& raw);
  bool define_channel(std::uint16_t id);

  void open_chunk(const Chunk& chunk, std::uint64_t offset, bool cut);
  void unpack(const Chunk& chunk, std::uint64_t offset, bool cut);
  void distrust_chunk(const std::string& what, bool keep);
  bool implausible(const RawRecord& raw) const;
  std::uint64_t count_left();
  void close_chunk() { chunk_ = {}, chunk_at_ = 0; }

  void structure_lost(const std::string& what);
  bool open_cut_chunk();
  bool is_plausible(std::uint64_t at, std::uint64_t end, int depth);
  std::uint64_t next_start_after(std::uint64_t at) const;
  std::uint64_t find_plausible(std::uint64_t from, std::uint64_t to, std::uint64_t end);
  bool swallows_others(const RawRecord& raw);
  bool straddles_start(const RawRecord& raw) const;

  void complain(Kind kind, std::string what, std::uint64_t byte, std::string topic = {}, std::string hint = {});
  void note_end();
  void advance_data_crc(std::uint64_t to, bool last);

  static constexpr std::uint64_t kCrcStride = 1 << 18;  // in the cache still, and long enough to be fast

  Bytes file_;
  ReadSettings settings_;
  std::optional<Summary> summary_;
  std::vector<std::uint64_t> starts_;

  std::uint64_t at_ = 0;             // of the next record at the top
  bool done_ = false, complete_ = false, in_summary_ = false;
  // Messages at the top need no closer look up to here; in salvage mode all do.
  std::uint64_t plain_until_ = 0;
  bool loose_is_plain_ = false;
  bool behind_loss_ = false;         // structure was lost; only a chunk's own CRC vouches for anything now
  std::uint64_t data_crc_at_ = 0;
  std::uint32_t data_crc_ = 0;

  Bytes chunk_;                      // uncompressed records being read
  std::size_t chunk_at_ = 0;
  std::uint64_t chunk_offset_ = 0, chunk_first_ = 0, chunk_last_ = 0;
  bool chunk_sound_ = true, chunk_checked_ = false;
  std::vector<std::uint8_t> buffer_;
  Decompressor decompressor_;

  Registry registry_;
  std::optional<Statistics> statistics_;
  ProblemList problems_;
  std::uint64_t search_cost_ = 0;
  std::uint64_t ignored_records_ = 0, first_ignored_ = 0;
  ReadCounts counts_;
};

}  // namespace quadsonde::ingest::mcap
