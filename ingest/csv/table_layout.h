#pragma once
// Where the header of a table is, and which of its columns a map takes.
#include "ingest/csv/column_map.h"
#include "ingest/flight/bytes.h"

namespace quadsonde::ingest::csv {

struct BoundColumn {
  std::string canonical;
  const ColumnSource* source = nullptr;
  std::vector<std::size_t> fields;  ///< places in a row, joined by a blank where there are several
};

struct Layout {
  const ColumnMap* map = nullptr;
  char delimiter = ',';
  std::size_t data_at = 0;        ///< offset behind the header line
  std::uint64_t header_line = 0;  ///< first line is 1
  std::vector<std::string> names;
  std::vector<std::pair<std::string, std::string>> preamble;  ///< key and value of lines above the header
  std::vector<BoundColumn> bound;
};

/// @param map  the user's, or nullptr: the shipped map whose columns the header holds. Must outlive the Layout.
/// Errors: not_a_log (no line is a header), missing (a column that the map names, or any time).
Result<Layout> find_layout(Bytes bytes, const std::string& file, const ColumnMap* map);

/// What was used of the map, as a MAP.toml that reads this table and is the start of the next one: a line for each
/// column that the table has, then [read] and [vehicle] as they are.
std::string used_map(const Layout& layout);

}  // namespace quadsonde::ingest::csv
