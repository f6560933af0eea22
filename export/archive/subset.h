#pragma once
// Parts of an archive, taken out.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "export/archive/archive.h"

namespace quadsonde::product {

/// A new archive of these entries at `to`, which appears whole or not at all.
/// Fails with Kind::usage when something is there already, unless it is an empty folder or may be overwritten (then an
/// archive is replaced, and nothing but an archive), and as Archive::read does.
ingest::Result<void> export_subset(const Archive& from, const std::vector<ArchiveEntry>& entries,
                                   const std::filesystem::path& to, bool overwrite, const ArchiveSettings& settings);

enum class MergeAxis { altitude, height };
struct MergeSettings {
  MergeAxis axis = MergeAxis::altitude;  ///< above the geoid, or above each take-off point
  std::optional<double> bin_m;           ///< left empty: the most frequent one of the profiles
};

/// One netCDF of all records of these profiles along one time axis, on one vertical grid whose edges are multiples of
/// bin_m. Launch sites that have one station identifier, or lie within 200 m, give a timeSeriesProfile; others give
/// featureType profile, with a place per record.
///
/// A bin of the grid is the mean of the profiles' bins with a wind that lie in it, weighted by overlap, and has a value
/// where these cover at least half of it; where grids agree, values are those of the profile. Uncertainties of bins
/// that are averaged count as fully correlated, which they nearly are (trim, calibration); quality is that of the
/// worst.
/// @return the bytes of the file; the same input gives the same bytes
/// Fails with Kind::usage without profiles or with too many, Kind::missing when axis is height and a take-off height is
/// not known, Kind::inconsistent when two records share their mid time, and as Archive::read and NcFile do.
ingest::Result<std::string> merged_netcdf(const Archive& from, const std::vector<ArchiveEntry>& entries,
                                          const MergeSettings& merge, const ArchiveSettings& settings);

}  // namespace quadsonde::product
