#pragma once
// Profiles for archives: made up, each of another flight.
#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "export/archive/archive.h"
#include "export/cf_netcdf/cf_netcdf.h"
#include "export/sha256.h"
#include "tests/export/made_up.h"

namespace quadsonde::support {

struct MadeUp {
  int flight = 0;     ///< other flights have other logs, starts and places
  double bin_m = 10;  ///< a setting; another one is another version
  std::string station = {}, vehicle = "quad-07";
  double stronger = 0;  ///< added to the wind [m/s]
  double takeoff_msl_m = 150;
};

inline std::string made_up_netcdf(const MadeUp& made) {
  auto profile = made_up_profile();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) {
      if (bin.utc)
        *bin.utc = *bin.utc + ingest::seconds(7200.0 * made.flight + (leg.name == profiles::LegName::down ? 300 : 0));
      if (auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind))
        wind->v_NA_N *= 1 + made.stronger / wind->v_NA_N.norm();
    }
  auto source = made_up_source();
  source.file = fmt::format("flight-{}.ulg", made.flight);
  source.sha256 = product::sha256_hex(ingest::as_bytes(source.file));
  source.flight = 1;
  source.settings[0].value = made.bin_m;
  product::NetcdfMetadata metadata;
  metadata.vehicle = made.vehicle;
  metadata.station.name = made.station;
  metadata.takeoff = ingest::GeoPoint{43.5657 + 0.01 * made.flight, 1.4815};
  metadata.takeoff_msl = ingest::MslHeight{made.takeoff_msl_m};
  auto bytes = product::profile_netcdf(profile, source, metadata);
  if (!bytes) throw std::runtime_error(ingest::to_string(bytes.error()));
  return std::move(*bytes);
}

inline product::ArchiveCandidate made_up_candidate(const MadeUp& made) {
  auto candidate = product::archive_candidate(made_up_netcdf(made), "made-up.nc");
  if (!candidate) throw std::runtime_error(ingest::to_string(candidate.error()));
  return std::move(*candidate);
}

/// Candidates of flights 0, 1, 2, ...: made once, since each costs a netCDF file.
inline const std::vector<product::ArchiveCandidate>& candidates(std::size_t count) {
  static std::vector<product::ArchiveCandidate> all;
  while (all.size() < count) all.push_back(made_up_candidate({static_cast<int>(all.size())}));
  return all;
}

}  // namespace quadsonde::support
