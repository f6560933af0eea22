#include "ingest/mcap/indexed_reader.h"

#include <fmt/format.h>

#include <algorithm>

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
    if (problem.kind != Kind::missing) reader.problems_.push_back(std::move(problem));
  }
  reader.walk_uncovered(end);
  std::ranges::stable_sort(reader.places_, {}, &Place::offset);
  const auto key = [](const LooseMessage& m) { return std::pair(m.time, m.offset); };
  if (!std::ranges::is_sorted(reader.loose_, {}, key)) std::ranges::sort(reader.loose_, {}, key);
  return reader;
}

/// Entries of the index that point to something else; what they mean is found by the walk.
void IndexedReader::drop_false_entries() {
  std::uint64_t dropped = 0;
  const auto drop = [&](auto& entries, auto place, Op op) {
    dropped += std::erase_if(entries, [&](const auto& entry) {
      const auto [offset, length] = place(entry);
      const auto raw = record_at(file_, offset);
      return !raw || raw->op != op || raw->end - offset != length;
    });
  };
  drop(summary_.chunks, [](const ChunkIndex& c) { return std::pair(c.chunk_start, c.chunk_length); }, Op::chunk);
  drop(summary_.attachments, [](const AttachmentIndex& a) { return std::pair(a.offset, a.length); }, Op::attachment);
  drop(summary_.metadata, [](const MetadataIndex& m) { return std::pair(m.offset, m.length); }, Op::metadata);
  if (dropped > 0)
    problems_.push_back({Kind::doubtful, fmt::format("{} entries of the index point to something else", dropped),
                         {settings_.file_name, summary_.footer.summary_start, {}, {}},
                         "the records are found without them"});
}

/// Walks the parts of the data section that no index covers: usually a header and some definitions.
void IndexedReader::walk_uncovered(std::uint64_t end) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> covered;
  for (const auto& chunk : summary_.chunks) {
    // The message indexes follow their chunk.
    const auto room = end - std::min(end, chunk.chunk_start + chunk.chunk_length);
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
  new_group_ = true;
  while (from < to) {
    const auto raw = record_at(file_.first(to), from);
    if (!raw) {
      problems_.push_back({to == file_.size() ? Kind::truncated : Kind::damaged, "no whole record stands here",
                           {settings_.file_name, from, {}, {}}, "what stands before it is used"});
      return;
    }
    if (!visit(*raw, from)) return;
    from = raw->end;
  }
}

/// @return false at the end of the data
bool IndexedReader::visit(const RawRecord& raw, std::uint64_t at) {
  switch (raw.op) {
    case Op::schema:
      if (const auto schema = parse_schema(raw.content)) summary_.registry.add(*schema);
      return true;
    case Op::channel:
      if (const auto channel = parse_channel(raw.content)) summary_.registry.add(*channel);
      return true;
    case Op::message:
      if (const auto message = parse_message(raw.content)) add_loose(*message, at, raw.end);
      return true;
    case Op::chunk:
      if (const auto chunk = parse_chunk(raw.content))
        places_.push_back({at, chunk->message_start_time, chunk->message_end_time, true, 0, {}});
      return true;
    case Op::attachment:
      if (const auto a = parse_attachment(raw.content))
        summary_.attachments.push_back(
            {at, raw.end - at, a->log_time, a->create_time, a->data.size(), a->name, a->media_type});
      return true;
    case Op::metadata:
      if (const auto m = parse_metadata(raw.content)) summary_.metadata.push_back({at, raw.end - at, m->name});
      return true;
    case Op::data_end:
    case Op::footer:
      return false;
    default:
      return true;
  }
}

void IndexedReader::add_loose(const Message& message, std::uint64_t at, std::uint64_t end) {
  loose_.push_back({message.log_time, at});
  if (new_group_ || places_.empty() || places_.back().is_chunk) {
    new_group_ = false;
    places_.push_back({at, message.log_time, message.log_time, false, end, {}});
    return;
  }
  auto& place = places_.back();
  place.first_time = std::min(place.first_time, message.log_time);
  place.last_time = std::max(place.last_time, message.log_time);
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
