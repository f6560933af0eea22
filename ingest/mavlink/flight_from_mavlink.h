#pragma once
// MAVLink messages to Flight: the one table of messages, units, frames and signs.
#include <cstdint>
#include <optional>
#include <string>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct MavlinkReadSettings {
  Reading mode = Reading::tolerant;    ///< the format resynchronises by itself: salvage does what tolerant does
  std::optional<std::uint8_t> system;  ///< take this system id; else the vehicle with the most position messages
};

/// True if the head of a file (1 KiB is enough) is a ground station's time and a MAVLink frame with a right checksum.
bool looks_like_tlog(Bytes head);

/// Flights of a MAVLink telemetry log (.tlog), one per boot of the chosen vehicle.
/// Time is the vehicle's boot time where a message has one; else the ground station's clock, mapped onto it.
/// @param file_name  for messages only; nothing is opened
/// @return fails with not_a_log if no frame has a right checksum; in strict mode also with the first damage
/// Source: mavlink/mavlink message_definitions (common.xml, ardupilotmega.xml).
Result<LogContent> read_mavlink(Bytes bytes, const std::string& file_name, const MavlinkReadSettings& settings = {});

}  // namespace quadsonde::ingest
