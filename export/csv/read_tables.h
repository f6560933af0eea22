#pragma once
// Our own wind and profile tables, read back: CSV and JSON as design/CLI.md has them.
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "ingest/flight/problem.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// One wind or profile of a file.
struct ReadTable {
  int flight = 1;       ///< as a JSON names it; 1 for CSV
  std::string made_of;  ///< the log's name, as a JSON names it; else empty
  std::variant<estimator::WindSeries, profiles::WindProfile> content;
};

enum class TableKind { wind_csv, profile_csv, json, none };
/// By the header of a CSV, or by the schema of a JSON (a wind, a profile or a list of them).
TableKind table_kind(std::string_view text);

/// What a CSV holds, or each object of a JSON. A wind has no trace and no diagnostics but the turbulence that a JSON
/// tells; the datum of a profile's CSV is the one in which its mean heights lie inside its bins.
/// Fails with Kind::damaged (with the line of a CSV, the row of a JSON) for a field that is no number or time,
/// Kind::missing for a column that is not there or a table without rows, Kind::not_a_log for anything else.
ingest::Result<std::vector<ReadTable>> read_tables(std::string_view text, const std::string& file);

}  // namespace quadsonde::product
