#include <fmt/format.h>

#include <algorithm>

#include "ingest/mcap/indexed_reader.h"

namespace quadsonde::ingest::mcap {

/// An open place. `current` is its next message.
struct MessageCursor::Run {
  enum class From { records, order, loose };
  From from = From::records;
  bool in_chunk = true;
  std::uint64_t base = 0;            // in the file: of the place
  std::uint64_t offset = 0;          // in the file: of the chunk, or of the message outside of one
  Bytes records;                     // a chunk's, unpacked, or a part of the file
  std::vector<std::uint8_t> buffer;  // holds them if they were compressed
  std::uint64_t held = 0;            // of buffer, counted in held_bytes_
  std::size_t at = 0;
  std::vector<LooseMessage> order;   // of a chunk whose messages are not in order: offsets in records
  std::size_t position = 0;          // in order or in the reader's loose messages
  Message current;
};

/// For a heap with the earliest message in front; messages of one time come as they stand in the file.
struct MessageCursor::Later {
  bool operator()(const std::unique_ptr<Run>& a, const std::unique_ptr<Run>& b) const {
    return std::pair(a->current.log_time, a->offset) > std::pair(b->current.log_time, b->offset);
  }
};

MessageCursor::~MessageCursor() = default;
MessageCursor::MessageCursor(MessageCursor&&) noexcept = default;
MessageCursor& MessageCursor::operator=(MessageCursor&&) noexcept = default;

MessageCursor::MessageCursor(const IndexedReader& reader, Selection selection, Order order)
    : reader_(&reader),
      selection_(std::move(selection)),
      order_(order),
      registry_(reader.summary().registry),
      wanted_(selection_.topics.empty() ? 0 : 65536, -1) {
  const bool by_time = order_ == Order::log_time;
  for (const auto& place : reader.places_)
    if ((place.is_chunk || !by_time || place.offset < reader.loose_from_) && may_hold_wanted(place))
      places_.push_back(place);
  if (!by_time) return;
  std::ranges::stable_sort(places_, {}, &Place::first_time);
  if (reader.loose_.empty()) return;
  auto run = std::make_unique<Run>();
  run->from = Run::From::loose;
  run->in_chunk = false;
  admit(std::move(run));
}

void MessageCursor::complain(Kind kind, std::string what, std::uint64_t byte) {
  if (!quiet_) problems_.add({kind, std::move(what), {reader_->settings_.file_name, byte, {}, {}}, "it is left out"});
}

bool MessageCursor::wants(std::uint16_t id) {
  if (wanted_.empty()) return true;
  if (wanted_[id] >= 0) return wanted_[id] != 0;
  const auto* channel = registry_.channel(id);
  if (!channel) return true;  // not known yet: it has to be looked at
  wanted_[id] = std::ranges::find(selection_.topics, channel->topic) != selection_.topics.end();
  return wanted_[id] != 0;
}

bool MessageCursor::wants(const Message& message) {
  return message.log_time >= selection_.from && message.log_time <= selection_.to && wants(message.channel_id);
}

bool MessageCursor::may_hold_wanted(const Place& place) {
  if (place.last_time < selection_.from || place.first_time > selection_.to) return false;
  return place.channels.empty() || std::ranges::any_of(place.channels, [&](auto id) { return wants(id); });
}

bool MessageCursor::unpack(const Place& place, Run& run) {
  const auto raw = record_at(reader_->file_, place.offset);
  const auto chunk = raw && raw->op == Op::chunk ? parse_chunk(raw->content) : std::nullopt;
  const auto compression = chunk ? compression_named(chunk->compression) : std::nullopt;
  if (!compression) {
    complain(chunk ? Kind::unsupported : Kind::damaged,
             chunk ? fmt::format("a chunk of {} bytes is compressed with \"{}\"", chunk->records.size(),
                                 chunk->compression.substr(0, 40))
                   : "no chunk stands where the index says",
             place.offset);
    return false;
  }
  if (chunk->uncompressed_size > reader_->settings_.max_chunk) {
    complain(Kind::limit, fmt::format("a chunk of {} bytes says that it unpacks to {}; the limit is {}",
                                      chunk->records.size(), chunk->uncompressed_size, reader_->settings_.max_chunk),
             place.offset);
    return false;
  }
  bool whole = chunk->records.size() == chunk->uncompressed_size;
  run.records = chunk->records;
  if (*compression != Compression::none) {
    whole = decompressor_.run(*compression, chunk->records, chunk->uncompressed_size, run.buffer);
    run.records = run.buffer;
  }
  const bool checked = reader_->settings_.check_crc && chunk->uncompressed_crc != 0;
  if (whole && (!checked || crc32(run.records) == chunk->uncompressed_crc)) return true;
  complain(Kind::damaged,
           fmt::format("{}: {} bytes of records",
                       whole ? "the CRC of this chunk differs" : "this chunk does not unpack to the size that it says",
                       chunk->uncompressed_size),
           place.offset);
  return false;
}

/// Learns the channels of a chunk and whether its messages are in order; if not, sorts them by time.
void MessageCursor::learn(Run& run) {
  std::uint64_t last = 0;
  bool sorted = true;
  run.order.clear();
  std::size_t at = 0;
  const auto size = run.records.size();
  const auto* const bytes = run.records.data();
  while (size - at >= kHeadSize) {
    const auto length = load<std::uint64_t>(bytes + at + 1);
    const auto op = static_cast<Op>(bytes[at]);
    if (length > size - at - kHeadSize || op == Op::none) break;
    if (op == Op::message && length >= kMessageHead) {
      const auto time = load<std::uint64_t>(bytes + at + kHeadSize + 6);
      sorted = sorted && time >= last;
      last = time;
    } else if (op == Op::schema || op == Op::channel) {
      define({op, run.records.subspan(at + kHeadSize, length), 0}, run.offset);
    }
    at += kHeadSize + length;
  }
  if (at != size)
    complain(Kind::damaged, fmt::format("{} bytes at the end of this chunk are no whole records", size - at),
             run.offset);
  run.records = run.records.first(at);
  if (sorted || order_ == Order::file) return;
  at = 0;
  while (const auto raw = record_at(run.records, at)) {
    // One that is shorter than its own head comes first, and is told then.
    const bool whole = raw->content.size() >= kMessageHead;
    if (raw->op == Op::message) run.order.push_back({whole ? load_message(raw->content).log_time : 0, at});
    at = raw->end;
  }
  std::ranges::stable_sort(run.order, {}, &LooseMessage::time);
  run.from = Run::From::order;
}

/// A file whose summary does not repeat them may define a channel in any earlier chunk, which by the order of times
/// may not have been opened yet.
void MessageCursor::learn_before(std::uint64_t offset) {
  const auto& places = reader_->places_;
  Run run;
  quiet_ = true;  // what is wrong with a chunk is told when its messages are read
  for (; searched_ < places.size() && places[searched_].offset < offset; ++searched_) {
    if (places[searched_].is_chunk && unpack(places[searched_], run)) {
      std::size_t at = 0;
      while (const auto raw = record_at(run.records, at)) {
        define(*raw, places[searched_].offset);
        at = raw->end;
      }
    }
  }
  quiet_ = false;
}

void MessageCursor::define(const RawRecord& raw, std::uint64_t offset) {
  const auto known = [&](const auto& parsed) {
    if (!parsed) return false;
    const auto added = registry_.add(*parsed);
    return added == Registry::Added::fresh || added == Registry::Added::same;
  };
  const bool taken = raw.op == Op::schema    ? known(parse_schema(raw.content))
                     : raw.op == Op::channel ? known(parse_channel(raw.content))
                                             : true;
  if (!taken)
    complain(Kind::damaged,
             fmt::format("a {} record of {} bytes is damaged or contradicts an earlier one",
                         raw.op == Op::schema ? "schema" : "channel", raw.content.size()),
             offset);
}

std::unique_ptr<MessageCursor::Run> MessageCursor::open(const Place& place) {
  auto run = spare_ ? std::move(spare_) : std::make_unique<Run>();
  run->from = Run::From::records;
  run->base = run->offset = place.offset;
  run->in_chunk = place.is_chunk;
  run->at = run->position = 0;
  if (!place.is_chunk) {
    run->records = reader_->file_.subspan(place.offset, place.end - place.offset);
    return run;
  }
  if (unpack(place, *run))
    learn(*run);
  else
    run->records = {};
  return run;
}

std::optional<RawRecord> MessageCursor::next_record(Run& run) {
  if (run.from == Run::From::records) {
    auto raw = record_at(run.records, run.at);
    if (!run.in_chunk) run.offset = run.base + run.at;
    if (raw) run.at = raw->end;
    return raw;
  }
  const auto& list = run.from == Run::From::order ? run.order : reader_->loose_;
  if (run.position == list.size()) return std::nullopt;
  const auto at = list[run.position++].offset;
  if (run.from == Run::From::order) return record_at(run.records, at);
  run.offset = at;
  return record_at(reader_->file_, at);
}

/// Moves to the next wanted message of a run; false at its end.
bool MessageCursor::advance(Run& run) {
  while (const auto raw = next_record(run)) {
    if (raw->op != Op::message) continue;
    if (raw->content.size() < kMessageHead) {
      complain(Kind::damaged, "a message is shorter than its own head", run.offset);
      continue;
    }
    run.current = load_message(raw->content);
    if (!registry_.has_channel(run.current.channel_id)) learn_before(run.offset);
    if (!registry_.has_channel(run.current.channel_id)) {
      complain(Kind::damaged, fmt::format("a message is on channel {}, which was never defined", run.current.channel_id),
               run.offset);
      continue;
    }
    if (wants(run.current)) return true;
  }
  return false;
}

void MessageCursor::admit(std::unique_ptr<Run> run) {
  run->held = run->buffer.capacity() + run->order.capacity() * sizeof(LooseMessage);
  held_bytes_ += run->held;
  peak_bytes_ = std::max(peak_bytes_, held_bytes_);
  const bool any = advance(*run);
  runs_.push_back(std::move(run));
  if (any) {
    std::push_heap(runs_.begin(), runs_.end(), Later{});
  } else {
    held_bytes_ -= runs_.back()->held;
    spare_ = std::move(runs_.back());
    runs_.pop_back();
  }
}

/// Steps over the message given out last, whose data was in use until now.
void MessageCursor::leave_last() {
  if (!given_) return;
  given_ = false;
  auto& front = runs_.front();
  if (advance(*front)) {
    // Mostly the same chunk goes on.
    const bool stays = (runs_.size() < 2 || !Later{}(front, runs_[1])) && (runs_.size() < 3 || !Later{}(front, runs_[2]));
    if (stays) return;
    std::pop_heap(runs_.begin(), runs_.end(), Later{});
    std::push_heap(runs_.begin(), runs_.end(), Later{});
    return;
  }
  std::pop_heap(runs_.begin(), runs_.end(), Later{});
  held_bytes_ -= runs_.back()->held;
  spare_ = std::move(runs_.back());
  runs_.pop_back();
}

/// Opens every place that may hold the next message.
void MessageCursor::admit_due() {
  while (next_place_ < places_.size() &&
         (runs_.empty() ||
          (order_ == Order::log_time && places_[next_place_].first_time <= runs_.front()->current.log_time)))
    admit(open(places_[next_place_++]));
}

bool MessageCursor::next(Message& message) {
  leave_last();
  admit_due();
  if (runs_.empty()) {
    problems_.close(reader_->settings_.file_name);
    return false;
  }
  message = runs_.front()->current;
  given_ = true;
  return true;
}

}  // namespace quadsonde::ingest::mcap
