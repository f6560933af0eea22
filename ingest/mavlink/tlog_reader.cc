#include "ingest/mavlink/tlog_reader.h"

namespace quadsonde::ingest {
namespace {

constexpr std::size_t time_size = 8, least_record = time_size + 8;
constexpr std::uint64_t hour_us = 3'600'000'000;

std::uint64_t big_endian(const std::uint8_t* at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < time_size; ++i) value = value << 8 | at[i];
  return value;
}

}  // namespace

/// The end of the file, or a magic byte behind a time within an hour.
bool TlogReader::record_follows(std::size_t at, std::uint64_t time_us) const {
  if (at == bytes_.size()) return true;
  if (bytes_.size() - at <= time_size) return false;
  const auto magic = bytes_[at + time_size];
  const auto other = big_endian(bytes_.data() + at);
  return (magic == 0xFE || magic == 0xFD) && (other > time_us ? other - time_us : time_us - other) < hour_us;
}

std::optional<std::size_t> TlogReader::scan(std::size_t at, TlogRecord& record, Count& count) const {
  using State = MavlinkProbe::State;
  bool searching = false;
  while (at < bytes_.size()) {
    if (bytes_.size() - at < least_record) {
      (searching ? count.skipped : count.trailing) += bytes_.size() - at;
      return std::nullopt;
    }
    const auto probe = probe_mavlink(bytes_.subspan(at + time_size));
    const auto end = at + time_size + probe.length;
    if (probe.state == State::complete) {
      record = {big_endian(bytes_.data() + at), probe.frame, at, searching};
      return end;
    }
    if (probe.state == State::incomplete && !searching) {
      count.trailing += bytes_.size() - at;
      return std::nullopt;
    }
    const bool whole = probe.state == State::unknown_id || probe.state == State::wrong_crc;
    if (whole && record_follows(end, big_endian(bytes_.data() + at))) {
      ++count.rejected;
      at = end;
      continue;
    }
    if (!count.first_skipped) count.first_skipped = at;
    searching = true;
    ++count.skipped;
    ++at;
  }
  return std::nullopt;
}

std::optional<std::size_t> TlogReader::peek(std::size_t at, TlogRecord& record) const {
  Count ignored;
  return scan(at, record, ignored);
}

bool TlogReader::next(TlogRecord& record) {
  const auto end = scan(at_, record, count_);
  if (!end) {
    at_ = bytes_.size();
    return false;
  }
  at_ = *end;
  ++frames_;
  record.salvaged = count_.skipped > 0;
  if (record.salvaged) ++salvaged_;
  if (record.frame.is_signed) ++signed_;
  return true;
}

}  // namespace quadsonde::ingest
