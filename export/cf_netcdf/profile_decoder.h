#pragma once
// The part of reading a profile that runs in a child process.
#include <string>
#include <utility>
#include <vector>

#include "export/cf_netcdf/read_profile.h"
#include "ingest/flight/bytes.h"

namespace quadsonde::product {

/// Variables over time and altitude that a file may lack, and where a bin keeps them.
const std::vector<std::pair<const char*, std::optional<double> StoredBin::*>>& optional_bin_variables();

/// What a profile netCDF holds, as a JSON object under the names of its attributes and variables, NaN as null; or
/// {"not_ours": why}. May crash on hostile bytes.
std::string decode_profile(ingest::Bytes bytes);

}  // namespace quadsonde::product
