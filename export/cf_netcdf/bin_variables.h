#pragma once
// The variables over time and altitude that a profile netCDF holds beside the wind itself.
#include <optional>
#include <vector>

#include "export/cf_netcdf/wind_variables.h"
#include "profiles/profile.h"

namespace quadsonde::product {

inline constexpr const char* time_units = "seconds since 1970-01-01T00:00:00Z";

/// What a bin knows beside its wind.
struct BinVariable {
  VariableText text;
  NcFile::Type type;
  std::optional<double> (*value)(const profiles::Bin&);
  bool always = true;  ///< else only in a file that has a value for it
};
const std::vector<BinVariable>& bin_variables();

}  // namespace quadsonde::product
