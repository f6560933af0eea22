#pragma once
// A profile netCDF of ours, read again. The bytes may be anybody's: the library decodes them in a child process.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// One bin of one record; NaN stays out: what is not known is empty.
struct StoredBin {
  std::optional<double> east, north, speed, from_deg;   ///< wind [m/s], [deg]
  std::optional<double> se_east, se_north, covariance;  ///< k=1 [m/s], [m2/s2]
  std::optional<double> noise, calibration, trim, climb_law, sampling;  ///< parts of the uncertainty [m/s]
  std::optional<double> effective_samples, sigma_east, sigma_north, spread_from_deg;  ///< turbulence [m/s]
  std::optional<double> resolution_m, freedom;  ///< method optimal
  std::optional<double> pressure_pa, temperature_k, relative_humidity_pct, barometric_altitude_m;
  estimator::Reasons reasons;                           ///< those that this version knows
  int quality = 9;                                      ///< wind_qc: 1 good, 3 doubtful, 4 bad, 9 none
  std::int64_t samples = 0;
  bool has_wind() const { return east && north; }
};

/// One leg.
struct StoredRecord {
  double mid_s = 0, from_s = 0, to_s = 0;  ///< since 1970 UTC
  int leg = 2;                             ///< 0 up, 1 down, 2 all
  std::string id;
  std::vector<StoredBin> bins;  ///< one per altitude
};

struct StoredProfile {
  std::string version, input_file, input_sha256;
  int input_flight = 1;
  std::string settings, vehicle;  ///< JSON objects, as text
  std::string id, platform, license, institution, date_created;
  std::string station_id;  ///< empty where the file has no identifier but the place
  double lat_deg = 0, lon_deg = 0;
  std::optional<double> surface_msl_m;          ///< of the take-off point
  std::vector<double> bottom_msl_m, top_msl_m;  ///< edges of the bins
  std::vector<StoredRecord> records;            ///< in the order of their mid times
};

/// Reads what profile_netcdf() writes, of any version. Nothing in the file is believed before it is checked: sizes,
/// types, ranges, times that grow, bins that follow each other.
/// Fails with Kind::unsupported when these bytes are no profile netCDF of ours (another format, another product,
/// somebody else's), Kind::damaged when they claim to be one and contradict themselves or the library fails on them,
/// Kind::limit when they are larger than a profile can be, and Kind::no_answer when no bin has a wind.
ingest::Result<StoredProfile> read_profile_netcdf(ingest::Bytes bytes, const std::string& name);

}  // namespace quadsonde::product
