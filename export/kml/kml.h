#pragma once
// Flights for globe viewers: KML 2.2.
#include <string>

#include "export/csv/source.h"
#include "export/report/words.h"

namespace quadsonde::product {

/// The track, and a wind barb at every bin: drawn in space at its height, flat, pointing to where the wind comes from,
/// coloured by quality, with a label; a click shows the columns of the CSV. The merged leg is shown, the others can be
/// switched on. Heights are above the sea; where those are not known, above the ground.
/// Fails with Kind::missing without a place or a height.
/// Source: OGC 07-147r2, KML 2.2. Barbs as in export/report/barb.h.
ingest::Result<std::string> profile_kml(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                        const ProductSource& source, const FlightTitle& title);

/// The track and barbs along it, at most 60.
ingest::Result<std::string> wind_kml(const estimator::WindSeries& series, const ProductSource& source,
                                     const FlightTitle& title);

}  // namespace quadsonde::product
