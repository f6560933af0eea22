#pragma once
// Flights for maps: GeoJSON (RFC 7946).
#include <string>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// One FeatureCollection: first the track as a line, then each filter step that has a place as a point, whose
/// properties are the columns of the CSV and their reasons. The member "quadsonde" tells where it comes from. The third
/// coordinate is the height above the ellipsoid, as RFC 7946 wants it (section 3.1.1); the properties have the height
/// above the sea. A track over the date line is cut there (section 3.1.9).
/// Fails with Kind::missing without any place.
ingest::Result<std::string> wind_geojson(const estimator::WindSeries& series, const ProductSource& source);

/// The same with the bins of every leg that have a place as points.
ingest::Result<std::string> profile_geojson(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                            const ProductSource& source);

}  // namespace quadsonde::product
