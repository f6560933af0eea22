#pragma once
// The part of reading a profile that runs in a child process.
#include <string>

#include "ingest/flight/bytes.h"

namespace quadsonde::product {

/// What a profile netCDF holds, as a JSON object under the names of its attributes and variables, NaN as null; or
/// {"not_ours": why}. May crash on hostile bytes.
std::string decode_profile(ingest::Bytes bytes);

}  // namespace quadsonde::product
