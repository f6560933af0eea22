#pragma once
// ArduPilot DataFlash messages to Flight: the one table of names, units, frames and signs.
#include <string>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct DataflashReadSettings {
  Reading mode = Reading::tolerant;  ///< the format resynchronises by itself: salvage does what tolerant does
};

/// True if the head of a file (64 KiB are enough) has a DataFlash format message, perhaps behind some garbage.
bool looks_like_dataflash(Bytes head);

/// Flights of an ArduPilot DataFlash log (.bin, .log in its binary form), one per boot.
/// Time is microseconds since boot; attitude is ATT (with the board trim), velocity the GPS's own where it comes
/// at 4 Hz or more, else the EKF's; heights are above mean sea level.
/// @param file_name  for messages only; nothing is opened
/// @return fails with not_a_log without a sound format message; in strict mode also with the first damage
/// Source: ArduPilot libraries/AP_Logger/LogStructure.h.
Result<LogContent> read_dataflash(Bytes bytes, const std::string& file_name,
                                  const DataflashReadSettings& settings = {});

}  // namespace quadsonde::ingest
