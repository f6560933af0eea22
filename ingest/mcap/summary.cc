#include "ingest/mcap/summary.h"

#include <fmt/format.h>

#include <algorithm>

namespace quadsonde::ingest::mcap {
namespace {

Problem damaged(std::string what, std::uint64_t byte) {
  return {Kind::damaged, std::move(what), {{}, byte, {}, {}}, "the file is read from its beginning instead"};
}

/// True if [start, start + length) lies between the first record and the footer.
bool inside(std::uint64_t start, std::uint64_t length, std::uint64_t end) {
  return start >= kMagic.size() && start <= end && length <= end - start;
}

/// Takes one record of the summary; false if it contradicts the format or points outside the file.
bool take(const RawRecord& record, std::uint64_t end, Summary& summary) {
  const auto into = [](auto parsed, auto& list) {
    if (!parsed) return false;
    list.push_back(std::move(*parsed));
    return true;
  };
  const auto known = [&](auto parsed) { return parsed && summary.registry.add(*parsed) != Registry::Added::differs; };
  switch (record.op) {
    case Op::schema:
      return known(parse_schema(record.content));
    case Op::channel:
      return known(parse_channel(record.content));
    case Op::chunk_index:
      return into(parse_chunk_index(record.content), summary.chunks) &&
             inside(summary.chunks.back().chunk_start, summary.chunks.back().chunk_length, end);
    case Op::attachment_index:
      return into(parse_attachment_index(record.content), summary.attachments) &&
             inside(summary.attachments.back().offset, summary.attachments.back().length, end);
    case Op::metadata_index:
      return into(parse_metadata_index(record.content), summary.metadata) &&
             inside(summary.metadata.back().offset, summary.metadata.back().length, end);
    case Op::statistics:
      summary.statistics = parse_statistics(record.content);
      return summary.statistics.has_value();
    default:
      return true;
  }
}

}  // namespace

std::vector<std::uint64_t> Summary::known_starts(Bytes file) const {
  std::vector<std::uint64_t> starts;
  const auto add = [&](std::uint64_t at, Op op) {
    if (const auto raw = record_at(file, at); raw && raw->op == op) starts.push_back(at);
  };
  for (const auto& chunk : chunks) {
    if (footer.summary_crc != 0) starts.push_back(chunk.chunk_start);
    add(chunk.chunk_start, Op::chunk);
  }
  for (const auto& attachment : attachments) add(attachment.offset, Op::attachment);
  for (const auto& record : metadata) add(record.offset, Op::metadata);
  constexpr std::uint64_t kDataEnd = kHeadSize + 4;
  if (footer.summary_start >= kMagic.size() + kDataEnd) add(footer.summary_start - kDataEnd, Op::data_end);
  std::ranges::sort(starts);
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
  return starts;
}

Result<Summary> read_summary(Bytes file, bool check_crc) {
  if (file.size() < kMagic.size() + kTailSize || !has_magic(file, file.size() - kMagic.size()))
    return fail(Kind::truncated, "the file has no end mark: the recording was cut", {{}, file.size(), {}, {}});
  const std::uint64_t footer_at = file.size() - kTailSize;
  const auto record = record_at(file, footer_at);
  const auto footer = record && record->op == Op::footer ? parse_footer(record->content) : std::nullopt;
  if (!footer) return fail(damaged("no footer where it should be", footer_at));
  if (footer->summary_start == 0) return fail(Kind::missing, "the file has no summary", {{}, footer_at, {}, {}});
  if (footer->summary_start < kMagic.size() || footer->summary_start > footer_at)
    return fail(damaged("the footer points outside the file", footer_at));
  const auto covered = file.subspan(footer->summary_start, file.size() - kMagic.size() - 4 - footer->summary_start);
  if (check_crc && footer->summary_crc != 0 && crc32(covered) != footer->summary_crc)
    return fail(damaged("the CRC of the summary differs", footer->summary_start));
  Summary summary;
  summary.footer = *footer;
  for (std::uint64_t at = footer->summary_start; at < footer_at;) {
    const auto next = record_at(file.first(footer_at), at);
    if (!next || !take(*next, footer_at, summary)) return fail(damaged("a record of the summary is damaged", at));
    at = next->end;
  }
  return summary;
}

}  // namespace quadsonde::ingest::mcap
