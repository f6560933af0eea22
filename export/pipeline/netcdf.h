#pragma once
// An answer as CF netCDF.
#include <string>

#include "export/pipeline/analyse.h"

namespace quadsonde::product {

/// Fail as profile_netcdf and wind_netcdf do, with the log named: above all without UTC. The answer must have a profile
/// for the first.
ingest::Result<std::string> profile_netcdf_of(const FlightAnswer& answer);
ingest::Result<std::string> wind_netcdf_of(const FlightAnswer& answer);

}  // namespace quadsonde::product
