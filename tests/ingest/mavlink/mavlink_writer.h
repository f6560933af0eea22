#pragma once
// Writes MAVLink frames and telemetry logs for tests and benchmarks: fields by name, zero where none is given.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "ingest/mavlink/mavlink_frame.h"

namespace quadsonde::support {

struct FrameOptions {
  int version = 2;
  std::uint8_t system = 1, component = 1, sequence = 0;
  bool is_signed = false, cut_zeros = true;
};

using FieldValues = std::map<std::string, double>;

inline std::vector<std::uint8_t> mavlink_payload(const ingest::MavlinkMessageInfo& info, const FieldValues& values) {
  std::vector<std::uint8_t> payload(256, 0);
  for (const auto& field : ingest::mavlink_fields(info)) {
    const auto found = values.find(std::string(field.name));
    if (found == values.end()) continue;
    const double number = found->second;
    const auto put = [&](auto value) { std::memcpy(payload.data() + field.offset, &value, sizeof(value)); };
    using T = ingest::MavlinkType;
    switch (field.type) {
      case T::f32:
        put(static_cast<float>(number));
        break;
      case T::f64:
        put(number);
        break;
      case T::u64:
      case T::i64:
        put(static_cast<std::int64_t>(number));
        break;
      case T::u32:
      case T::i32:
        put(static_cast<std::uint32_t>(static_cast<std::int64_t>(std::llround(number))));
        break;
      case T::u16:
      case T::i16:
        put(static_cast<std::uint16_t>(std::lround(number)));
        break;
      default:
        put(static_cast<std::uint8_t>(std::lround(number)));
        break;
    }
  }
  return payload;
}

/// One frame. A text goes into the char array of the message; of other arrays the first element is set.
inline std::vector<std::uint8_t> mavlink_frame(const std::string& name, const FieldValues& values,
                                               const FrameOptions& options = {}, const std::string& text = {}) {
  const auto& info = *ingest::find_mavlink_message(name);
  auto payload = mavlink_payload(info, values);
  if (!text.empty())
    for (const auto& field : ingest::mavlink_fields(info))
      if (field.type == ingest::MavlinkType::text)
        std::memcpy(payload.data() + field.offset, text.data(), std::min<std::size_t>(text.size(), field.count));
  payload.resize(options.version == 1 ? info.base_length : info.max_length);
  if (options.version == 2 && options.cut_zeros)
    while (payload.size() > 1 && payload.back() == 0) payload.pop_back();
  const auto id = info.id;
  const auto byte = [](std::uint32_t value) { return static_cast<std::uint8_t>(value & 0xFF); };
  std::vector<std::uint8_t> frame;
  if (options.version == 1)
    frame = {
        0xFE,    byte(static_cast<std::uint32_t>(payload.size())), options.sequence, options.system, options.component,
        byte(id)};
  else
    frame = {0xFD,
             byte(static_cast<std::uint32_t>(payload.size())),
             static_cast<std::uint8_t>(options.is_signed ? 1 : 0),
             0,
             options.sequence,
             options.system,
             options.component,
             byte(id),
             byte(id >> 8),
             byte(id >> 16)};
  frame.insert(frame.end(), payload.begin(), payload.end());
  const auto crc =
      ingest::mavlink_crc(ingest::Bytes(&info.crc_extra, 1), ingest::mavlink_crc(ingest::Bytes(frame).subspan(1)));
  frame.push_back(byte(crc));
  frame.push_back(byte(crc >> 8));
  if (options.is_signed) frame.insert(frame.end(), 13, 0x5A);
  return frame;
}

/// A telemetry log: each frame behind the ground station's time, big-endian.
class TlogWriter {
 public:
  FrameOptions options;
  std::uint64_t host_us = 1'557'756'559'000'000;
  std::vector<std::uint8_t> bytes;

  void record(const std::vector<std::uint8_t>& frame) {
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(host_us >> shift & 0xFF));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  void add(const std::string& name, const FieldValues& values, const std::string& text = {}) {
    record(mavlink_frame(name, values, options, text));
    ++options.sequence;
    host_us += 1000;
  }
  void heartbeat(int type = 2, int autopilot = 3, int base_mode = 0x81) {
    add("HEARTBEAT", {{"type", type}, {"autopilot", autopilot}, {"base_mode", base_mode}});
  }
  /// Ten seconds of attitude at 10 Hz and the filter's state at 5 Hz from a boot time on.
  void fly(double from_ms = 60000, double north = 1) {
    heartbeat();
    for (int k = 0; k < 100; ++k) {
      const double ms = from_ms + 100 * k;
      add("ATTITUDE", {{"time_boot_ms", ms}, {"roll", 0.1}, {"pitch", -0.2}, {"yaw", 0.3}});
      if (k % 2 == 0)
        add("LOCAL_POSITION_NED", {{"time_boot_ms", ms}, {"x", k}, {"z", -5}, {"vx", north}, {"vy", 2}, {"vz", -0.5}});
      host_us += 100'000 - (k % 2 == 0 ? 2000 : 1000);
    }
  }
};

}  // namespace quadsonde::support
