#pragma once
// Profiles and winds as CF netCDF: CF-1.8 and ACDD-1.3, netCDF-4, one file per flight.
#include <filesystem>
#include <optional>
#include <string>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "export/station/station.h"
#include "profiles/profile.h"
#include "profiles/section.h"

namespace quadsonde::product {

/// What a product says about itself beside its numbers. What is empty is left out of the file, never invented.
struct NetcdfMetadata {
  std::string title;      ///< left empty: one that says what the file holds
  std::string flight_id;  ///< left empty: the log's stem and the flight's number
  Station station;
  std::string vehicle, autopilot;  ///< as the log names them
  std::optional<ingest::GeoPoint> takeoff;
  std::optional<ingest::MslHeight> takeoff_msl;
  /// Stands for the time of making, which would differ from run to run; SOURCE_DATE_EPOCH goes before it. Left empty:
  /// the last sample.
  std::optional<ingest::UtcTime> log_end;
};

/// A profile as timeSeriesProfile: one record of `time` for up and one for down where the profile has them, else one
/// for all; to write the merged leg of a flight that climbs, hand over a profile with that leg alone. The vertical
/// axis is the altitude above the geoid of the bins' middles.
/// @return the bytes of the file; the same input gives the same bytes
/// Fails with Kind::missing without UTC, a place or a height above the sea (CF section 9 wants all three), with
/// Kind::no_answer when no bin has a wind, and with Kind::inconsistent when the legs' bins do not match.
/// Source: CF-1.8 section 9 and appendix H.5; ACDD-1.3.
ingest::Result<std::string> profile_netcdf(const profiles::WindProfile& profile, const ProductSource& source,
                                           const NetcdfMetadata& metadata = {});

/// A section as timeSeriesProfile: one record of `time` per ascent and descent, in the order of their middle times.
/// @return the bytes of the file; the same input gives the same bytes
/// Fails as profile_netcdf does, and with Kind::inconsistent where two columns share their mid time.
ingest::Result<std::string> section_netcdf(const profiles::Section& section, const ProductSource& source,
                                           const NetcdfMetadata& metadata = {});

/// The wind along the flight as trajectory: one `obs` per filter step that has UTC, a place and a height above the
/// sea. Steps without one of them are left out, and the file's comment says how many.
/// @return the bytes of the file; the same input gives the same bytes
/// Fails with Kind::missing without UTC, a place or a height above the sea.
/// Source: CF-1.8 section 9 and appendix H.4; ACDD-1.3.
ingest::Result<std::string> wind_netcdf(const estimator::WindSeries& series, const ProductSource& source,
                                        const NetcdfMetadata& metadata = {});

/// The same, written to a file: whole or not at all.
ingest::Result<void> write_profile_netcdf(const std::filesystem::path& path, const profiles::WindProfile& profile,
                                          const ProductSource& source, const NetcdfMetadata& metadata = {},
                                          bool overwrite = false);
ingest::Result<void> write_wind_netcdf(const std::filesystem::path& path, const estimator::WindSeries& series,
                                       const ProductSource& source, const NetcdfMetadata& metadata = {},
                                       bool overwrite = false);

}  // namespace quadsonde::product
