#include <vector>

#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/mavlink/mavlink_frame.h"
#include "ingest/mavlink/tlog_reader.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

namespace {

/// Writes right checksums into whatever begins like a frame: a fuzzer does not guess sixteen bits.
void mend(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t time_size = 8;
  for (std::size_t at = time_size; at < bytes.size();) {
    const auto probe = ingest::probe_mavlink(ingest::Bytes(bytes).subspan(at));
    if (probe.state != ingest::MavlinkProbe::State::wrong_crc) {
      at += probe.state == ingest::MavlinkProbe::State::complete ? probe.length + time_size : 1;
      continue;
    }
    const std::size_t head = probe.frame.version == 1 ? 6 : 10, payload = probe.frame.payload.size();
    const std::uint8_t extra = probe.frame.info->crc_extra;
    const auto covered = ingest::Bytes(bytes).subspan(at + 1, head - 1 + payload);
    const auto crc = ingest::mavlink_crc(ingest::Bytes(&extra, 1), ingest::mavlink_crc(covered));
    bytes[at + head + payload] = static_cast<std::uint8_t>(crc & 0xFF);
    bytes[at + head + payload + 1] = static_cast<std::uint8_t>(crc >> 8);
    at += probe.length + time_size;
  }
}

/// The same frames come out of the push decoder whatever the pieces are.
void push(ingest::Bytes bytes, std::size_t piece) {
  std::vector<std::uint16_t> whole, pieces;
  ingest::MavlinkStreamDecoder one, other;
  one.feed(bytes, [&](const ingest::MavlinkFrame& frame) { whole.push_back(frame.crc); });
  for (std::size_t at = 0; at < bytes.size(); at += piece)
    other.feed(bytes.subspan(at, std::min(piece, bytes.size() - at)),
               [&](const ingest::MavlinkFrame& frame) { pieces.push_back(frame.crc); });
  fuzz::require(whole == pieces);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> copy(data, data + size);
  if (size > 0 && (data[size - 1] & 1) != 0) mend(copy);
  const ingest::Bytes bytes(copy);
  (void)ingest::looks_like_tlog(bytes);
  push(bytes, size > 1 ? 1 + data[size - 1] : 1);
  fuzz::require_sound(ingest::read_mavlink(bytes, "fuzz.tlog"), size);
  fuzz::require_sound(ingest::read_mavlink(bytes, "fuzz.tlog", {ingest::Reading::strict, std::uint8_t{1}}), size);
  return 0;
}
