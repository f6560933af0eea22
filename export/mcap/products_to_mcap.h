#pragma once
// Winds and profiles as MCAP files of their own: self-describing, protobuf or JSON.
#include <string>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "export/mcap/flight_to_mcap.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// One message quadsonde.Wind for each filter step in /quadsonde/wind. Log times are UTC where it is known, else the
/// source's clock. The metadata record `quadsonde.product` names source, vehicle, settings and problems.
/// @return the bytes of the file; the same input gives the same bytes
/// Fails with limit beyond 4e9 steps.
ingest::Result<std::string> wind_mcap(const estimator::WindSeries& series, const ProductSource& source,
                                      const FlightFileSettings& settings = {});

/// One message quadsonde.ProfileLeg for each leg in /quadsonde/profile/up, down and all, at the UTC of the first sample
/// (0 while unknown).
ingest::Result<std::string> profile_mcap(const profiles::WindProfile& profile, const ProductSource& source,
                                         const FlightFileSettings& settings = {});

}  // namespace quadsonde::product
