#include "ingest/mcap/indexed_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace quadsonde::ingest::mcap {

Result<IndexedReader> IndexedReader::open(Bytes file, ReadSettings settings) {
  if (!has_magic(file, 0))
    return fail(Kind::not_a_log, "the file does not begin with the MCAP mark", {settings.file_name, 0, {}, {}},
                "check that it is an MCAP log");
  IndexedReader reader;
  reader.file_ = file;
  reader.settings_ = std::move(settings);
  auto summary = read_summary(file, reader.settings_.check_crc);
  auto end = file.size();
  if (summary) {
    reader.summary_ = std::move(*summary);
    reader.has_index_ = true;
    end = reader.summary_.footer.summary_start;
    reader.drop_false_entries();
    for (const auto& chunk : reader.summary_.chunks) {
      Place place{chunk.chunk_start, chunk.message_start_time, chunk.message_end_time, true, 0, {}};
      for (const auto& [channel, offset] : chunk.message_index_offsets) place.channels.push_back(channel);
      reader.places_.push_back(std::move(place));
    }
  } else {
    auto problem = summary.error();
    problem.where.file = reader.settings_.file_name;
    // No summary is a choice of the writer; a damaged one is not.
    if (problem.kind != Kind::missing) reader.problems_.add(std::move(problem));
  }
  reader.walk_uncovered(end);
  std::ranges::stable_sort(reader.places_, {}, &Place::offset);
  const auto key = [](const LooseMessage& m) { return std::pair(m.time, m.offset); };
  std::ranges::sort(reader.loose_, {}, key);
  reader.problems_.close(reader.settings_.file_name);
  return reader;
}

void IndexedReader::complain(Kind kind, std::string what, std::uint64_t byte, std::string hint) {
  problems_.add({kind, std::move(what), {settings_.file_name, byte, {}, {}}, std::move(hint)});
}

/// Entries of the index that point to something else, which is found by the walk, or where another one points.
void IndexedReader::drop_false_entries() {
  std::uint64_t dropped = 0;
  std::set<std::uint64_t> seen;
  const auto drop = [&](auto& entries, auto place, Op op) {
    dropped += std::erase_if(entries, [&](const auto& entry) {
      const auto [offset, length] = place(entry);
      const auto raw = record_at(file_, offset);
      return !raw || raw->op != op || raw->end - offset != length || !seen.insert(offset).second;
    });
  };
  drop(summary_.chunks, [](const ChunkIndex& c) { return std::pair(c.chunk_start, c.chunk_length); }, Op::chunk);
  drop(summary_.attachments, [](const AttachmentIndex& a) { return std::pair(a.offset, a.length); }, Op::attachment);
  drop(summary_.metadata, [](const MetadataIndex& m) { return std::pair(m.offset, m.length); }, Op::metadata);
  if (dropped > 0)
    complain(Kind::doubtful,
             fmt::format("{} entries of the index point to something else, or twice to the same", dropped),
             summary_.footer.summary_start, "the records are found without them");
}

/// Walks the parts of the data section that no index covers: usually a header and some definitions.
void IndexedReader::walk_uncovered(std::uint64_t end) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> covered;
  // The message indexes follow their chunk; that they reach as far as a summary says is believed to a CRC only.
  const bool verified = settings_.check_crc && summary_.footer.summary_crc != 0;
  for (const auto& chunk : summary_.chunks) {
    const auto room = verified ? end - std::min(end, chunk.chunk_start + chunk.chunk_length) : 0;
    covered.emplace_back(chunk.chunk_start, chunk.chunk_length + std::min(room, chunk.message_index_length));
  }
  for (const auto& attachment : summary_.attachments) covered.emplace_back(attachment.offset, attachment.length);
  for (const auto& metadata : summary_.metadata) covered.emplace_back(metadata.offset, metadata.length);
  std::ranges::sort(covered);
  std::uint64_t at = kMagic.size();
  for (const auto& [start, length] : covered) {
    if (start > at) walk(at, std::min(start, end));
    at = std::max(at, start + length);
  }
  if (at < end) walk(at, end);
}

void IndexedReader::walk(std::uint64_t from, std::uint64_t to) {
  const auto bytes = file_.first(to);
  new_group_ = true;
  while (from < to) {
    const auto raw = record_at(bytes, from);
    if (!raw)
      return complain(to == file_.size() ? Kind::truncated : Kind::damaged,
                      fmt::format("no whole record stands here: {} bytes are left out", to - from), from,
                      "what stands before it is used");
    if (raw->op == Op::message && raw->content.size() >= kMessageHead)
      add_loose(load<std::uint64_t>(raw->content.data() + 6), from, raw->end);
    else if (!visit(*raw, from))
      return;
    from = raw->end;
  }
}

/// @return false at the end of the data
bool IndexedReader::visit(const RawRecord& raw, std::uint64_t at) {
  if (raw.op == Op::data_end && raw.content.size() == 4) return false;
  if (raw.op == Op::footer && raw.content.size() == kFooterSize) return false;
  if (!take(raw, at))
    complain(Kind::damaged,
             fmt::format("a record of kind {} is damaged or contradicts an earlier one: {} bytes",
                         static_cast<int>(raw.op), raw.content.size()),
             at, "it is left out");
  return true;
}

/// Everything but messages; false if it cannot be used.
bool IndexedReader::take(const RawRecord& raw, std::uint64_t at) {
  const auto known = [&](const auto& parsed) {
    if (!parsed) return false;
    const auto added = summary_.registry.add(*parsed);
    return added == Registry::Added::fresh || added == Registry::Added::same;
  };
  switch (raw.op) {
    case Op::schema:
      return known(parse_schema(raw.content));
    case Op::channel:
      return known(parse_channel(raw.content));
    case Op::message:  // shorter than its own head
    case Op::data_end:
    case Op::footer:
      return false;
    case Op::chunk:
      if (const auto chunk = parse_chunk(raw.content)) {
        places_.push_back({at, chunk->message_start_time, chunk->message_end_time, true, 0, {}});
        return true;
      }
      return false;
    case Op::attachment:
      if (const auto a = parse_attachment(raw.content)) {
        summary_.attachments.push_back(
            {at, raw.end - at, a->log_time, a->create_time, a->data.size(), a->name, a->media_type});
        return true;
      }
      return false;
    case Op::metadata:
      if (const auto m = parse_metadata(raw.content)) {
        summary_.metadata.push_back({at, raw.end - at, m->name});
        return true;
      }
      return false;
    default:
      return true;
  }
}

void IndexedReader::add_loose(std::uint64_t time, std::uint64_t at, std::uint64_t end) {
  bool goes_on = !new_group_ && !places_.empty() && !places_.back().is_chunk;
  if (goes_on && loose_from_ == UINT64_MAX && time < places_.back().last_time) {
    loose_from_ = at;
    goes_on = false;
  }
  if (at >= loose_from_) loose_.push_back({time, at});
  if (!goes_on) {
    new_group_ = false;
    places_.push_back({at, time, time, false, end, {}});
    return;
  }
  auto& place = places_.back();
  place.first_time = std::min(place.first_time, time);
  place.last_time = std::max(place.last_time, time);
  place.end = end;
}

MessageCursor IndexedReader::messages(Selection selection, Order order) const {
  return MessageCursor(*this, std::move(selection), order);
}

Result<Attachment> IndexedReader::attachment(const AttachmentIndex& index) const {
  const Where where{settings_.file_name, index.offset, {}, std::string(index.name)};
  const auto raw = record_at(file_, index.offset);
  const auto found = raw && raw->op == Op::attachment ? parse_attachment(raw->content) : std::nullopt;
  if (!found) return fail(Kind::damaged, "no attachment stands where the index says", where);
  if (settings_.check_crc && found->crc != 0 && crc32(found->covered) != found->crc)
    return fail(Kind::damaged, "the CRC of this attachment differs", where);
  return *found;
}

Result<Metadata> IndexedReader::metadata(const MetadataIndex& index) const {
  const auto raw = record_at(file_, index.offset);
  auto found = raw && raw->op == Op::metadata ? parse_metadata(raw->content) : std::nullopt;
  if (!found)
    return fail(Kind::damaged, "no metadata record stands where the index says",
                {settings_.file_name, index.offset, {}, std::string(index.name)});
  return *found;
}

}  // namespace quadsonde::ingest::mcap
