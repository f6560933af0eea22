#pragma once
#include "ingest/csv/column_map.h"
#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct CsvReadSettings {
  Reading mode = Reading::tolerant;
  std::optional<ColumnMap> map;  ///< empty = auto: the shipped map that fits the header
};

/// A table as a Flight, plain or compressed (gzip, Zstandard).
/// Log time is time_s; where a table has only utc, it is UTC itself. Streams have the rate of their cells: an empty
/// cell is no sample. The map that was used stands in details as "map" and "map_toml".
/// The velocity is made of the position only where there is no other; then details say so ("velocity").
/// Errors: not_a_log, missing (no time, a column that the user's map names), limit, damaged; strict: the first Problem.
Result<LogContent> read_csv(Bytes bytes, const std::string& file_name, const CsvReadSettings& settings = {});

/// Does a shipped map (or the canonical names) fit a header of these bytes?
bool looks_like_table(Bytes bytes);

}  // namespace quadsonde::ingest
