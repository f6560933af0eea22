#pragma once
// T.csv: the wind that was really there, at the vehicle; only a simulator knows it.
#include <filesystem>
#include <string>
#include <string_view>

#include "ingest/flight/problem.h"
#include "ingest/flight/truth.h"

namespace quadsonde::product {

/// Columns time_s, height_agl_m, wind_east_m_s, wind_north_m_s, wind_up_m_s.
std::string truth_csv(const ingest::Truth& truth);

/// Reads them back, in time order; further columns are ignored.
/// Fails with Kind::missing for a column that is not there, Kind::damaged (with its line) for a field that is no
/// finite number or for times that do not rise.
ingest::Result<ingest::Truth> parse_truth_csv(std::string_view text, const std::string& file);
ingest::Result<ingest::Truth> read_truth_csv(const std::filesystem::path& file);

}  // namespace quadsonde::product
