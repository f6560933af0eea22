#include "ingest/mcap/reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace quadsonde::ingest::mcap {
namespace {

bool is_known(Op op) { return op >= Op::header && op <= Op::data_end; }

}  // namespace

RecordReader::RecordReader(Bytes file, ReadSettings settings) : file_(file), settings_(std::move(settings)) { start(); }

void RecordReader::start() {
  if (!has_magic(file_, 0)) {
    complain(Kind::not_a_log, "the file does not begin with the MCAP mark", 0, {}, "check that it is an MCAP log");
    // A damaged mark costs nothing; a file that is something else is not searched for messages.
    const auto first = record_at(file_, kMagic.size());
    done_ = done_ || !first || first->op != Op::header || !parse_header(first->content);
  }
  at_ = std::min<std::uint64_t>(kMagic.size(), file_.size());
  if (done_ || settings_.mode == Reading::strict) return;
  auto summary = read_summary(file_, settings_.check_crc);
  if (!summary) return;
  summary_ = std::move(*summary);
  starts_ = summary_->known_starts(file_);
}

void RecordReader::complain(Kind kind, std::string what, std::uint64_t byte, std::string topic, std::string hint) {
  if (settings_.mode == Reading::strict) {
    // The first one ends the reading, also of what is told at the end only.
    if (!problems_.empty()) return;
    done_ = true;
  }
  problems_.add({kind, std::move(what), {settings_.file_name, byte, {}, std::move(topic)}, std::move(hint)});
}

bool RecordReader::next_slow(Record& record) {
  while (!done_) {
    if (chunk_at_ < chunk_.size()) {
      if (next_in_chunk(record)) return true;
    } else {
      close_chunk();
      if (next_at_top(record)) return true;
    }
  }
  // Strict mode ends inside a chunk, too.
  close_chunk();
  note_end();
  return false;
}

bool RecordReader::next_in_chunk(Record& record) {
  const auto raw = record_at(chunk_, chunk_at_);
  if (!raw || (!chunk_sound_ && implausible(*raw))) {
    counts_.bytes_given_up += chunk_.size() - chunk_at_;
    // The tail of a cut chunk is a record that was not finished: said once, when the chunk was opened.
    complain(Kind::damaged,
             fmt::format("{} bytes at the end of this chunk are no whole records", chunk_.size() - chunk_at_),
             chunk_offset_, {}, "what stands before them in the chunk is kept");
    close_chunk();
    return false;
  }
  chunk_at_ = raw->end;
  record = {raw->op, raw->content, chunk_offset_, true, chunk_sound_};
  switch (raw->op) {
    case Op::schema:
    case Op::channel:
    case Op::message:
      return take(*raw, record) == Step::give && !done_;
    default:
      if (is_known(raw->op))
        complain(Kind::damaged, fmt::format("a record of kind {} stands inside a chunk", static_cast<int>(raw->op)),
                 chunk_offset_);
      return false;
  }
}

bool RecordReader::next_at_top(Record& record) {
  if (at_ >= file_.size()) {
    complain(Kind::truncated, "the file ends without a footer: the recording was cut", file_.size(), {},
             "everything before the cut is used");
    done_ = true;
    return false;
  }
  const auto raw = record_at(file_, at_);
  if (!raw || straddles_start(*raw)) {
    if (!open_cut_chunk())
      structure_lost(raw ? "a record runs into the next one" : "no whole record stands here");
    return false;
  }
  if (swallows_others(*raw)) {
    structure_lost("the length of this record is damaged");
    return false;
  }
  record = {raw->op, raw->content, at_, false, !behind_loss_};
  const auto from = at_;
  if (raw->op == Op::data_end) advance_data_crc(from, true);
  at_ = raw->end;
  const auto step = take(*raw, record);
  if (step == Step::lost) {
    at_ = from;
    structure_lost("no record stands here");
    return false;
  }
  if (!in_summary_) advance_data_crc(at_, false);
  loose_is_plain_ = settings_.mode != Reading::salvage && !in_summary_ && !behind_loss_ && !done_;
  plain_until_ = next_start_after(at_);
  return step == Step::give && (!done_ || complete_);
}

RecordReader::Step RecordReader::take(const RawRecord& raw, Record& record) {
  switch (raw.op) {
    case Op::schema:
      return take_definition(parse_schema(raw.content), record, "schema");
    case Op::channel:
      return take_definition(parse_channel(raw.content), record, "channel");
    case Op::message:
      return take_message(record);
    case Op::chunk:
      if (const auto chunk = parse_chunk(raw.content); chunk && !in_summary_) {
        open_chunk(*chunk, record.offset, false);
        return Step::skip;
      }
      break;
    case Op::attachment:
      return take_attachment(record);
    case Op::data_end:
      return take_data_end(raw);
    case Op::footer:
      return take_footer(raw);
    case Op::statistics:
      if ((statistics_ = parse_statistics(raw.content))) return Step::give;
      break;
    case Op::header:
      if (parse_header(raw.content)) return Step::give;
      break;
    case Op::message_index:
      if (parse_message_index(raw.content)) return Step::give;
      break;
    case Op::chunk_index:
      if (parse_chunk_index(raw.content)) return Step::give;
      break;
    case Op::attachment_index:
      if (parse_attachment_index(raw.content)) return Step::give;
      break;
    case Op::metadata:
      if (parse_metadata(raw.content)) return Step::give;
      break;
    case Op::metadata_index:
      if (parse_metadata_index(raw.content)) return Step::give;
      break;
    case Op::summary_offset:
      if (parse_summary_offset(raw.content)) return Step::give;
      break;
    default:
      if (ignored_records_++ == 0) first_ignored_ = record.offset;
      return Step::skip;
  }
  if (std::ranges::binary_search(starts_, record.offset))
    complain(Kind::damaged, fmt::format("{} bytes that the index knows are not readable", raw.content.size()),
             record.offset, {}, "reading goes on behind them");
  else
    complain(Kind::damaged, fmt::format("a record of kind {} is damaged: {} bytes", static_cast<int>(raw.op),
                                        raw.content.size()),
             record.offset, {}, "reading goes on behind it");
  counts_.bytes_given_up += raw.content.size();
  return Step::skip;
}

namespace {
Schema view(std::uint16_t id, const KnownSchema& known) { return {id, known.name, known.encoding, known.data}; }
Channel view(std::uint16_t id, const KnownChannel& known) {
  Channel channel{id, known.schema_id, known.topic, known.message_encoding, {}};
  for (const auto& [key, value] : known.metadata) channel.metadata.emplace_back(key, value);
  return channel;
}
const KnownSchema* known_in(const Registry& registry, const Schema& schema) { return registry.schema(schema.id); }
const KnownChannel* known_in(const Registry& registry, const Channel& channel) { return registry.channel(channel.id); }
}  // namespace

/// Where no CRC of a chunk vouches for a definition, that of the summary does for its own; it is used then.
template <class T>
bool RecordReader::contradicts_summary(const T& definition) {
  if (in_summary_ || !summary_ || summary_->footer.summary_crc == 0) return false;
  const auto* known = known_in(summary_->registry, definition);
  if (!known || matches(*known, definition)) return false;
  registry_.add(view(definition.id, *known), true);
  return true;
}

/// A definition in a chunk whose CRC failed.
template <class T>
void RecordReader::learn_unsound(const std::optional<T>& definition) {
  if (definition && !contradicts_summary(*definition)) registry_.add(*definition, false);
}

void RecordReader::learn_unsound(const RawRecord& raw) {
  if (raw.op == Op::schema) learn_unsound(parse_schema(raw.content));
  if (raw.op == Op::channel) learn_unsound(parse_channel(raw.content));
}

template <class T>
RecordReader::Step RecordReader::take_definition(const std::optional<T>& parsed, const Record& record,
                                                 const char* what) {
  if (!parsed) {
    counts_.bytes_given_up += record.content.size();
    complain(Kind::damaged, fmt::format("a {} record of {} bytes is damaged", what, record.content.size()),
             record.offset);
    return Step::skip;
  }
  if ((!record.in_chunk || !record.sound) && contradicts_summary(*parsed)) {
    complain(Kind::damaged, fmt::format("the definition of {} {} differs from the one in the summary", what, parsed->id),
             record.offset, {}, "the one in the summary is used, as a CRC vouches for it");
    return Step::skip;
  }
  switch (registry_.add(*parsed, record.sound)) {
    case Registry::Added::fresh:
    case Registry::Added::same:
      return Step::give;
    case Registry::Added::differs:
      complain(Kind::damaged, fmt::format("{} {} is defined twice, and differently", what, parsed->id), record.offset,
               {}, "the first definition is used");
      return Step::skip;
    case Registry::Added::refused:
      complain(parsed->id == 0 ? Kind::damaged : Kind::limit,
               parsed->id == 0 ? fmt::format("a {} has the id 0, which the format forbids", what)
                               : "schemas and channels take more than 256 MiB",
               record.offset);
      return Step::skip;
  }
  return Step::skip;
}

/// A channel whose record was lost may stand in the summary as well.
bool RecordReader::define_channel(std::uint16_t id) {
  const auto* known = summary_ ? summary_->registry.channel(id) : nullptr;
  if (!known) return false;
  if (const auto* schema = summary_->registry.schema(known->schema_id))
    registry_.add(view(known->schema_id, *schema), false);
  registry_.add(view(id, *known), false);
  complain(Kind::damaged, "the definition of this channel is lost; the one in the summary is used", at_, known->topic);
  return registry_.has_channel(id);
}

RecordReader::Step RecordReader::take_message(Record& record) {
  const bool short_one = record.content.size() < kMessageHead;
  const auto id = short_one ? std::uint16_t{0} : load<std::uint16_t>(record.content.data());
  if (short_one || in_summary_ || !(registry_.has_channel(id) || define_channel(id))) {
    ++counts_.lost;
    complain(Kind::damaged,
             short_one     ? "a message is shorter than its own head"
             : in_summary_ ? "a message stands behind the end of the data"
                           : fmt::format("a message is on channel {}, which was never defined", id),
             record.offset, {}, "1 message is left out");
    return Step::skip;
  }
  ++counts_.messages;
  counts_.salvaged += record.sound ? 0 : 1;
  return Step::give;
}

RecordReader::Step RecordReader::take_attachment(Record& record) {
  const auto attachment = parse_attachment(record.content);
  if (!attachment) {
    counts_.bytes_given_up += record.content.size();
    complain(Kind::damaged, fmt::format("an attachment of {} bytes is damaged", record.content.size()), record.offset,
             {}, "it is left out");
    return Step::skip;
  }
  if (!settings_.check_crc || attachment->crc == 0 || crc32(attachment->covered) == attachment->crc) return Step::give;
  complain(Kind::damaged, "the CRC of this attachment differs", record.offset, std::string(attachment->name),
           settings_.mode == Reading::salvage ? "it is kept" : "it is left out");
  record.sound = false;
  return settings_.mode == Reading::salvage ? Step::give : Step::skip;
}

RecordReader::Step RecordReader::take_data_end(const RawRecord& raw) {
  const auto crc = parse_data_end(raw.content);
  if (!crc) return Step::lost;
  in_summary_ = true;
  if (settings_.check_crc && *crc != 0 && *crc != data_crc_)
    complain(Kind::damaged, "the CRC over all data differs: some byte of the file is not what was written", 0, {},
             problems_.empty() ? "no record is visibly damaged; single values may be wrong" : "");
  return Step::give;
}

RecordReader::Step RecordReader::take_footer(const RawRecord& raw) {
  const auto footer = parse_footer(raw.content);
  if (!footer || !has_magic(file_, raw.end)) {
    // Inside data this is no footer; at the end it is a damaged one.
    if (file_.size() - raw.end > kMagic.size()) return Step::lost;
    complain(Kind::damaged, "the end of the file is damaged", raw.end - raw.content.size(), {}, "the data is used");
    done_ = true;
    return Step::skip;
  }
  if (!in_summary_)
    complain(Kind::damaged, "the footer stands where the end of the data is missing", at_, {}, "");
  const auto from = footer->summary_start != 0 ? footer->summary_start : raw.end - kFooterSize - kHeadSize;
  const auto to = raw.end - 4;
  if (settings_.check_crc && footer->summary_crc != 0 &&
      (from > to || crc32(file_.subspan(from, to - from)) != footer->summary_crc))
    complain(Kind::damaged, "the CRC of the summary differs", from, {}, "the data is read from the front instead");
  if (file_.size() - raw.end > kMagic.size())
    complain(Kind::doubtful, fmt::format("{} bytes follow the end of the log", file_.size() - raw.end - kMagic.size()),
             raw.end + kMagic.size(), {}, "they are ignored");
  complete_ = true;
  done_ = true;
  return Step::give;
}

void RecordReader::advance_data_crc(std::uint64_t to, bool last) {
  if (!settings_.check_crc || (!last && to - data_crc_at_ < kCrcStride)) return;
  data_crc_ = crc32(file_.subspan(data_crc_at_, to - data_crc_at_), data_crc_);
  data_crc_at_ = to;
}

/// What can only be told when everything was read.
void RecordReader::note_end() {
  if (settings_.mode == Reading::strict && !problems_.empty()) return;
  if (statistics_) {
    const auto accounted = counts_.messages + counts_.lost;
    if (statistics_->message_count > accounted) {
      const auto missing = statistics_->message_count - accounted;
      counts_.lost += missing;
      complain(Kind::damaged, fmt::format("{} of the {} messages that the statistics count are not there", missing,
                                          statistics_->message_count),
               first_ignored_);
    }
    statistics_.reset();
  }
  if (!problems_.empty() && ignored_records_ > 0)
    complain(Kind::doubtful, fmt::format("{} records of unknown kinds were ignored; they may be damaged known ones",
                                         ignored_records_),
             first_ignored_);
  ignored_records_ = 0;
  problems_.close(settings_.file_name);
}

}  // namespace quadsonde::ingest::mcap
