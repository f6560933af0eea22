#include "ingest/mavlink/mavlink_frame.h"

#include <algorithm>
#include <array>

namespace quadsonde::ingest {
namespace {

constexpr std::uint8_t magic_1 = 0xFE, magic_2 = 0xFD, signed_flag = 0x01;
constexpr std::size_t crc_size = 2, signature_size = 13;

/// Row k: the effect of a byte that k further bytes follow; eight rows take eight bytes in one step.
constexpr auto crc_tables = [] {
  std::array<std::array<std::uint16_t, 256>, 8> tables{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0x8408 : crc >> 1;
    tables[0][byte] = static_cast<std::uint16_t>(crc);
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const unsigned before = tables[k - 1][byte];
      tables[k][byte] = static_cast<std::uint16_t>((before >> 8) ^ tables[0][before & 0xFF]);
    }
  return tables;
}();

bool is_magic(std::uint8_t byte) { return byte == magic_1 || byte == magic_2; }

}  // namespace

std::uint16_t mavlink_crc(Bytes bytes, std::uint16_t crc) {
  const auto* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, at += 8) {
    const unsigned first = at[0] ^ (crc & 0xFFU), second = at[1] ^ (crc >> 8);
    crc = static_cast<std::uint16_t>(crc_tables[7][first] ^ crc_tables[6][second] ^ crc_tables[5][at[2]] ^
                                     crc_tables[4][at[3]] ^ crc_tables[3][at[4]] ^ crc_tables[2][at[5]] ^
                                     crc_tables[1][at[6]] ^ crc_tables[0][at[7]]);
  }
  for (; left > 0; --left, ++at) crc = static_cast<std::uint16_t>((crc >> 8) ^ crc_tables[0][(crc ^ *at) & 0xFF]);
  return crc;
}

MavlinkProbe probe_mavlink(Bytes bytes) {
  using State = MavlinkProbe::State;
  MavlinkProbe probe;
  if (bytes.empty()) return {State::incomplete, 0, {}};
  if (!is_magic(bytes[0])) return probe;
  auto& frame = probe.frame;
  frame.version = bytes[0] == magic_1 ? 1 : 2;
  const std::size_t head = frame.version == 1 ? 6 : 10;
  if (bytes.size() < head) return {State::incomplete, 0, {}};
  const std::size_t length = bytes[1];
  if (frame.version == 1) {
    frame.sequence = bytes[2];
    frame.system = bytes[3];
    frame.component = bytes[4];
    frame.id = bytes[5];
  } else {
    if ((bytes[2] & ~signed_flag) != 0) return {State::unsupported, 0, {}};
    frame.is_signed = (bytes[2] & signed_flag) != 0;
    frame.sequence = bytes[4];
    frame.system = bytes[5];
    frame.component = bytes[6];
    frame.id = bytes[7] | bytes[8] << 8 | static_cast<std::uint32_t>(bytes[9]) << 16;
  }
  probe.length = head + length + crc_size + (frame.is_signed ? signature_size : 0);
  probe.state = State::incomplete;
  if (bytes.size() < probe.length) return probe;
  frame.info = find_mavlink_message(frame.id);
  frame.payload = bytes.subspan(head, length);
  frame.crc = load<std::uint16_t>(bytes.data() + head + length);
  probe.state = State::unknown_id;
  if (frame.info == nullptr) return probe;
  const std::uint8_t extra = frame.info->crc_extra;
  const auto crc = mavlink_crc(Bytes(&extra, 1), mavlink_crc(bytes.subspan(1, head - 1 + length)));
  probe.state = crc == frame.crc ? State::complete : State::wrong_crc;
  return probe;
}

PaddedPayload::PaddedPayload(const MavlinkFrame& frame) : data_(frame.payload.data()) {
  const std::size_t whole = frame.info == nullptr ? sizeof(copy_) : frame.info->max_length;
  if (frame.payload.size() >= whole) return;
  std::copy(frame.payload.begin(), frame.payload.end(), copy_);
  std::fill(copy_ + frame.payload.size(), copy_ + sizeof(copy_), std::uint8_t{0});
  data_ = copy_;
}

/// @return how many bytes are done with; what is left is the beginning of a frame
std::size_t MavlinkStreamDecoder::consume(Bytes bytes, const Sink& sink) {
  using State = MavlinkProbe::State;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const auto rest = bytes.subspan(at);
    const auto probe = probe_mavlink(rest);
    if (probe.state == State::incomplete) break;
    if (probe.state == State::complete) {
      ++frames_;
      sink(probe.frame);
      at += probe.length;
      continue;
    }
    const bool whole = probe.state == State::unknown_id || probe.state == State::wrong_crc;
    // A dialect of somebody else's steps whole; garbage that begins like a frame gives up one byte only.
    if (whole && rest.size() == probe.length) break;
    const bool another_follows = whole && is_magic(rest[probe.length]);
    if (another_follows)
      ++rejected_;
    else
      ++skipped_;
    at += another_follows ? probe.length : 1;
  }
  return at;
}

void MavlinkStreamDecoder::feed(Bytes bytes, const Sink& sink) {
  while (!pending_.empty() && !bytes.empty()) {
    // Complete the frame that the last piece began, byte by byte of what it may still need at most.
    const auto taken = std::min(bytes.size(), most_mavlink_frame);
    const auto before = pending_.size();
    pending_.insert(pending_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    const auto done = consume(pending_, sink);
    if (done >= before) {
      bytes = bytes.subspan(done - before);
      pending_.clear();
      break;
    }
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
    bytes = bytes.subspan(taken);
  }
  if (bytes.empty()) return;
  const auto done = consume(bytes, sink);
  const auto rest = bytes.subspan(done);
  pending_.assign(rest.begin(), rest.end());
}

}  // namespace quadsonde::ingest
