#pragma once
// A leg's bins on another grid.
#include <vector>

#include "export/cf_netcdf/read_profile.h"

namespace quadsonde::product {

/// @param zero   altitude of the grid's zero [m]
/// @param edges  of the grid's bins above that zero, growing, one more than bins [m]
/// @return one bin per bin of the grid: the mean of the leg's bins with a wind that lie in it, weighted by overlap,
///         where these cover at least half of it, else one without a wind. Standard errors add up as if fully
///         correlated, the correlation of the components is the weighted mean; quality is that of the worst.
std::vector<StoredBin> regrid(const StoredProfile& profile, const StoredRecord& record, double zero,
                              const std::vector<double>& edges);

estimator::MaybeWind wind_of(const StoredBin& bin);

}  // namespace quadsonde::product
