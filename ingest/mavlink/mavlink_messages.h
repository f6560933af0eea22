#pragma once
// What each MAVLink message is called, how its checksum is seeded, and where the fields that we read lie.
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"

namespace quadsonde::ingest {

struct MavlinkMessageInfo {
  std::uint32_t id;
  std::uint8_t crc_extra;    ///< seeds the checksum with the message's definition
  std::uint8_t base_length;  ///< of the payload that version 1 carries
  std::uint8_t max_length;   ///< with the extensions of version 2
  std::string_view name;
  std::string_view fields;  ///< "name[count]:type ..." in wire order, '+' before extensions; empty if never read
};

/// All messages known, by ascending id. Source: mavlink/mavlink message_definitions (common.xml, ardupilotmega.xml).
std::span<const MavlinkMessageInfo> mavlink_messages();
/// @return nullptr for an id that is not in the table
const MavlinkMessageInfo* find_mavlink_message(std::uint32_t id);
const MavlinkMessageInfo* find_mavlink_message(std::string_view name);

enum class MavlinkType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64, text };

struct MavlinkField {
  std::string_view name;
  MavlinkType type = MavlinkType::u8;
  std::uint8_t offset = 0, count = 1;

  /// @param payload  padded with zeros to the message's full length
  double number(const std::uint8_t* payload, std::size_t index = 0) const;
  /// Integers as they are; floats give 0.
  std::int64_t integer(const std::uint8_t* payload, std::size_t index = 0) const;
  /// Text up to the first NUL.
  std::string_view text(const std::uint8_t* payload) const;
};

/// The fields of a message in wire order; empty if its row has none.
std::vector<MavlinkField> mavlink_fields(const MavlinkMessageInfo& info);

}  // namespace quadsonde::ingest
