#pragma once
// An answer as the products that services take: CF netCDF, UASDC netCDF, BUFR, met_point.
#include <string>

#include "export/cf_netcdf/cf_netcdf.h"
#include "export/pipeline/analyse.h"

namespace quadsonde::product {

/// What such a product says beside its numbers: of the log, of the station file.
NetcdfMetadata metadata_of(const FlightAnswer& answer);

/// Fail as profile_netcdf and wind_netcdf do, with the log named: above all without UTC. The answer must have a profile
/// for the first.
ingest::Result<std::string> profile_netcdf_of(const FlightAnswer& answer);
ingest::Result<std::string> wind_netcdf_of(const FlightAnswer& answer);

/// The answer's section, which it must have.
ingest::Result<std::string> section_netcdf_of(const FlightAnswer& answer);

/// A product and the name that its users expect.
struct NamedProduct {
  std::string name, bytes;
};
/// The campaign's netCDF of the profile where the answer has one, else of every filter step. Fail as uasdc_netcdf and
/// its observations do; the second also as uasdc_file_name does.
ingest::Result<std::string> uasdc_of(const FlightAnswer& answer);
ingest::Result<NamedProduct> named_uasdc_of(const FlightAnswer& answer);

/// The profile in the form of BUFR that answer.product names; the answer must have one.
ingest::Result<std::string> bufr_of(const FlightAnswer& answer);
/// The profile as met_point; the answer must have one.
ingest::Result<std::string> met_point_of(const FlightAnswer& answer);

}  // namespace quadsonde::product
