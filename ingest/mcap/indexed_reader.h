#pragma once
// An MCAP file by topic and time: messages in file order or in the order of their log times.
#include <memory>
#include <string>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/mcap/problem_list.h"
#include "ingest/mcap/reader.h"

namespace quadsonde::ingest::mcap {

struct Selection {
  std::vector<std::string> topics;  ///< empty: all
  std::uint64_t from = 0;           ///< first log time wanted
  std::uint64_t to = UINT64_MAX;    ///< last log time wanted
};

enum class Order {
  file,     ///< as they stand
  log_time  ///< by log_time; messages of one time as they stand
};

/// Where messages are: one chunk, or some messages outside of chunks that stand behind each other.
struct Place {
  std::uint64_t offset = 0, first_time = 0, last_time = 0;
  bool is_chunk = true;
  std::uint64_t end = 0;                ///< of messages outside of chunks: offset behind the last one
  std::vector<std::uint16_t> channels;  ///< that the index names; empty: not known
};

/// A message that does not stand in the order of times.
struct LooseMessage {
  std::uint64_t time = 0, offset = 0;
};

class MessageCursor;

/// Opens by the summary where there is one, and walks over the records that it does not cover; without one it walks
/// over all of them once, without unpacking chunks. Damage is met as in tolerant reading: what cannot be read is left
/// out and told in problems(); use RecordReader to salvage.
/// Memory: 40 bytes for each chunk; 16 for each message outside of chunks from the first one on that is earlier than
/// the one before it; a cursor holds the chunks that overlap in time, unpacked.
class IndexedReader {
 public:
  /// @param file  must outlive the reader and everything it gives
  static Result<IndexedReader> open(Bytes file, ReadSettings settings = {});

  const Summary& summary() const { return summary_; }
  /// False if there was no usable summary, and summary() holds what the walk found.
  bool has_index() const { return has_index_; }
  const std::vector<Place>& places() const { return places_; }
  const std::vector<Problem>& problems() const { return problems_.list(); }

  MessageCursor messages(Selection selection = {}, Order order = Order::log_time) const;
  /// @return fails with damaged if no such record is there or its CRC differs
  Result<Attachment> attachment(const AttachmentIndex& index) const;
  Result<Metadata> metadata(const MetadataIndex& index) const;

 private:
  friend class MessageCursor;
  void drop_false_entries();
  void walk_uncovered(std::uint64_t end);
  void walk(std::uint64_t from, std::uint64_t to);
  bool visit(const RawRecord& raw, std::uint64_t at);
  bool take(const RawRecord& raw, std::uint64_t at);
  void add_loose(std::uint64_t time, std::uint64_t at, std::uint64_t end);
  void complain(Kind kind, std::string what, std::uint64_t byte, std::string hint);

  Bytes file_;
  ReadSettings settings_;
  Summary summary_;
  bool has_index_ = false, new_group_ = true;
  std::vector<Place> places_;  // by offset
  // Messages outside of chunks from the first inversion of their times on, by time, then offset; the places before
  // it are read as they stand.
  std::vector<LooseMessage> loose_;
  std::uint64_t loose_from_ = UINT64_MAX;
  ProblemList problems_;
};

/// One pass over a selection. The reader must outlive it.
class MessageCursor {
 public:
  MessageCursor(const IndexedReader& reader, Selection selection, Order order);
  ~MessageCursor();
  MessageCursor(MessageCursor&&) noexcept;
  MessageCursor& operator=(MessageCursor&&) noexcept;

  /// @param message  its data is valid until the next call
  /// @return false at the end
  bool next(Message& message);
  /// Channels and schemas met so far; that of the last message is among them.
  const Registry& registry() const { return registry_; }
  const std::vector<Problem>& problems() const { return problems_.list(); }
  /// Most bytes that unpacked chunks took at one time.
  std::uint64_t peak_bytes() const { return peak_bytes_; }

 private:
  struct Run;
  struct Later;
  bool wants(std::uint16_t channel);
  bool wants(const Message& message);
  bool may_hold_wanted(const Place& place);
  std::unique_ptr<Run> open(const Place& place);
  bool unpack(const Place& place, Run& run);
  void learn(Run& run);
  void learn_before(std::uint64_t offset);
  void define(const RawRecord& raw, std::uint64_t offset);
  bool advance(Run& run);
  std::optional<RawRecord> next_record(Run& run);
  void admit(std::unique_ptr<Run> run);
  void leave_last();
  void admit_due();
  void complain(Kind kind, std::string what, std::uint64_t byte);

  const IndexedReader* reader_;
  Selection selection_;
  Order order_;
  Registry registry_;
  std::vector<signed char> wanted_;  // by channel: -1 not known yet
  std::vector<Place> places_;        // wanted ones, in the order of opening
  std::size_t next_place_ = 0;
  std::size_t searched_ = 0;         // of the reader's places, for definitions
  std::vector<std::unique_ptr<Run>> runs_;  // a heap by the time of their next message
  std::unique_ptr<Run> spare_;              // its buffer is unpacked into again
  bool given_ = false;                      // the message of the front run was given out
  Decompressor decompressor_;
  std::uint64_t held_bytes_ = 0, peak_bytes_ = 0;
  ProblemList problems_;
  bool quiet_ = false;  // what is wrong is told another time
};

}  // namespace quadsonde::ingest::mcap
