#pragma once
// Paparazzi messages to Flight: the one table of messages, units, frames and signs.
#include <optional>
#include <string>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct PaparazziReadSettings {
  Reading mode = Reading::tolerant;
  std::string aircraft;  ///< take this aircraft id; empty: the one with the most lines
};

/// True if most of the first lines of a file read "seconds aircraft MESSAGE values".
bool looks_like_paparazzi_data(Bytes head);

/// Flights of a Paparazzi log: the .data file and the .log with its message definitions beside it.
/// Time is seconds since the .log's time_of_day. Integers are scaled with the exact powers of two of the firmware,
/// not with the rounded coefficients that the .log prints.
/// @param log        bytes of the .log; without it messages are only counted: no flight, and a Problem of
///                   Kind::missing that names the .log
/// @param file_name  of the .data, for messages only; nothing is opened
/// @return fails with not_a_log if no line is a message; in strict mode also with the first line that is none
/// Source: paparazzi/pprzlink message_definitions/v1.0/messages.xml.
Result<LogContent> read_paparazzi(Bytes data, std::optional<Bytes> log, const std::string& file_name,
                                  const PaparazziReadSettings& settings = {});

}  // namespace quadsonde::ingest
