#pragma once
// A profile as its netCDF file holds it: one axis of altitudes, one record per leg in the order of their times.
#include <optional>
#include <string>
#include <vector>

#include "export/cf_netcdf/cf_netcdf.h"

namespace quadsonde::product {

struct ProfileRecord {
  const profiles::Leg* leg = nullptr;
  std::string name;  ///< of the leg; in a section with its flight and number before it
  ingest::UtcTime from, to;
  /// Middle of the two [s since 1970].
  double mid_s() const;
};

struct ProfileRecords {
  std::vector<double> altitude, bottom, top;  ///< of the bins above the geoid [m]
  std::vector<ProfileRecord> records;         ///< at least one
  ingest::GeoPoint place;                     ///< take-off, else the mean of the bins
  bool place_is_takeoff = false;
  std::optional<ingest::MslHeight> takeoff_msl;
};

/// @param product  what cannot be made of the profile where this fails, for people: "netCDF"
/// Fails as profile_netcdf does, but for legs at one mid time, which only an axis of times minds.
ingest::Result<ProfileRecords> profile_records(const profiles::WindProfile& profile, const NetcdfMetadata& metadata,
                                               std::string_view product);

/// The columns of a section instead of the legs of a profile; fails alike, and where two columns share their mid time.
ingest::Result<ProfileRecords> section_records(const profiles::Section& section, const NetcdfMetadata& metadata);

}  // namespace quadsonde::product
