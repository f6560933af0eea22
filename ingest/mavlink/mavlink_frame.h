#pragma once
// MAVLink frames, versions 1 and 2: out of a block of bytes, or pushed in pieces as they arrive on a link.
#include <cstdint>
#include <functional>
#include <vector>

#include "ingest/mavlink/mavlink_messages.h"

namespace quadsonde::ingest {

/// CRC-16/MCRF4XX, which MAVLink calls X.25, continued from `crc`.
std::uint16_t mavlink_crc(Bytes bytes, std::uint16_t crc = 0xFFFF);

constexpr std::size_t most_mavlink_frame = 280;  ///< 10 + 255 + 2 + 13 bytes

struct MavlinkFrame {
  const MavlinkMessageInfo* info = nullptr;
  std::uint32_t id = 0;
  std::uint8_t version = 0, sequence = 0, system = 0, component = 0;
  bool is_signed = false;  ///< the signature is stepped over, not checked: that needs the key
  std::uint16_t crc = 0;
  Bytes payload;  ///< as sent: version 2 cuts zeros off its end
};

/// What stands at the beginning of some bytes.
struct MavlinkProbe {
  enum class State {
    complete,     ///< a frame with a right checksum
    incomplete,   ///< the bytes end before the frame does
    not_a_frame,  ///< no magic byte
    unsupported,  ///< a version 2 flag that changes the frame in a way not known
    unknown_id,   ///< whole, but its checksum cannot be checked
    wrong_crc
  };
  State state = State::not_a_frame;
  std::size_t length = 0;  ///< as the head claims; 0 if not known yet
  MavlinkFrame frame;      ///< filled as far as its head goes
};
MavlinkProbe probe_mavlink(Bytes bytes);

/// A payload with the zeros back that version 2 cuts off: points into the frame if it is whole, else to a copy.
class PaddedPayload {
 public:
  explicit PaddedPayload(const MavlinkFrame& frame);
  PaddedPayload(const PaddedPayload&) = delete;
  PaddedPayload& operator=(const PaddedPayload&) = delete;
  const std::uint8_t* data() const { return data_; }

 private:
  std::uint8_t copy_[256];
  const std::uint8_t* data_;
};

/// Frames out of bytes that arrive in pieces of any size; it knows no file and no time. Holds at most one frame.
class MavlinkStreamDecoder {
 public:
  using Sink = std::function<void(const MavlinkFrame&)>;  ///< the frame is valid during the call only

  void feed(Bytes bytes, const Sink& sink);
  std::uint64_t frames() const { return frames_; }
  /// Whole frames with an unknown id or a wrong checksum.
  std::uint64_t rejected() const { return rejected_; }
  std::uint64_t skipped_bytes() const { return skipped_; }

 private:
  std::size_t consume(Bytes bytes, const Sink& sink);

  std::vector<std::uint8_t> pending_;
  std::uint64_t frames_ = 0, rejected_ = 0, skipped_ = 0;
};

}  // namespace quadsonde::ingest
