#pragma once
// The netCDF of the WMO UAS demonstration campaign (FM 303-2024).
#include <string>

#include "export/uasdc/observations.h"

namespace quadsonde::product {

/// One file per flight, one `obs` per observation. Temperature, mixing ratio and pressure are there also where
/// nothing measured them, without a value, as the campaign asks for; dew point and humidity only where measured.
/// @return the bytes of the file; the same input gives the same bytes
/// Source: synoptic/wmo-uasdc, README of raw_uas_to_netCDF (2024-06), table of variables.
ingest::Result<std::string> uasdc_netcdf(const Observations& observations, const ProductSource& source,
                                         const NetcdfMetadata& metadata);

/// UASDC_OOO_AAAAA_YYYYMMDDHHMMSSZ.nc: operator, airframe, time of the first observation (whole seconds, cut).
/// Fails with Kind::usage where the station names no operator or airframe.
ingest::Result<std::string> uasdc_file_name(const Station& station, ingest::UtcTime first);

}  // namespace quadsonde::product
