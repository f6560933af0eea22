#pragma once
// Which column of a table is which quantity: the maps of --columns, and those that ship with the tool.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::ingest {

/// Where one canonical column comes from. value = column * scale + offset.
struct ColumnSource {
  std::vector<std::string> columns;  ///< one, or several whose texts are joined by a blank (date and time)
  double scale = 1, offset = 0;
  std::string format;  ///< of a time: "iso", "unix", "unix_ms", "unix_us" or a %-pattern; empty = the map's, or seconds
  bool optional = false;  ///< may be missing from the table
};

/// A parsed MAP.toml. Canonical names are those of the command line reference (time_s, utc, qw, roll_deg, vn_m_s, ...).
struct ColumnMap {
  std::string name;  ///< "skyhub", or the file's stem
  std::string note;  ///< what a reader of the result should know
  std::string toml;  ///< the text it was made of, so that it can be shown and changed
  /// canonical name -> ways to get it; the first whose columns are in the table is taken.
  std::map<std::string, std::vector<ColumnSource>, std::less<>> columns;
  std::vector<std::string> match;  ///< shipped maps: the header must hold all of these

  // [read]
  char delimiter = 0;            ///< 0 = guess from the header line; ' ' = any run of blanks
  std::uint64_t header = 0;      ///< line of the header, first is 1; 0 = find it
  std::string comment;           ///< lines that begin so are skipped
  std::string time_format;       ///< of `utc`, "iso" if empty
  int zone_s = 0;                ///< seconds east of UTC of times that name no zone
  bool skip_other_rows = false;  ///< rows without a time are part of the format (events), not damage

  // [vehicle]
  std::string vehicle_name, vehicle_name_from,
      autopilot;  ///< _from: key of a "key<delimiter>value" line above the header
  bool multirotor = false;
  int rotors = 0;
  bool magnetic_heading = false;  ///< the table's headings count from magnetic north
};

/// Is it a canonical column name (rotor_N_rpm included)?
bool is_canonical_column(std::string_view name);

/// @param name  for messages and `info` where the text has no [map] name
/// Errors: usage, with the line and what was expected.
Result<ColumnMap> parse_column_map(std::string_view toml, const std::string& name);
/// Reads a MAP.toml. Errors: unreadable, usage.
Result<ColumnMap> read_column_map(const std::filesystem::path& path);

/// The maps that ship with the tool, in the order in which they are tried; the canonical names come last.
const std::vector<ColumnMap>& shipped_column_maps();

}  // namespace quadsonde::ingest
