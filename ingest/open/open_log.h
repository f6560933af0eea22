#pragma once
// Any supported log: the reader is chosen by the file's bytes, never by its name.
#include <filesystem>
#include <optional>

#include "ingest/csv/column_map.h"
#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct OpenSettings {
  Reading mode = Reading::tolerant;
  std::optional<ColumnMap> columns;             ///< of a table; empty: the shipped map that fits
  std::optional<std::filesystem::path> topics;  ///< MAP.toml of a foreign MCAP
  double height_offset_m = 0;                   ///< added to every height above sea level
  std::optional<std::filesystem::path> sensor;  ///< table of temperature, humidity and pressure
  double sensor_offset_s = 0;                   ///< added to the sensor's times
};

/// Reads a log. Every flight is tidied; a velocity that only the position can give is made of it, and said in details.
/// Errors: unreadable, not_a_log, unsupported (native DJI files: the exports that work are named), and the reader's.
Result<LogContent> open_log(const std::filesystem::path& path, const OpenSettings& settings = {});

/// The same for bytes in memory; `path` is for messages and for the .log beside a Paparazzi .data.
Result<LogContent> open_log(Bytes bytes, const std::filesystem::path& path, const OpenSettings& settings = {});

/// Why a flight cannot give a wind, before any estimate: not a multirotor, no attitude, no velocity. Empty if it can.
/// @param format  LogContent::format, for the hint which message or column to log
std::optional<Problem> why_unusable(const Flight& flight, const std::string& format);

/// Why no flight of a log can give a wind; empty if one can.
std::optional<Problem> why_no_flight(const LogContent& content);

}  // namespace quadsonde::ingest
