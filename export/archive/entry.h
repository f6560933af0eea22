#pragma once
// What an archive knows of one profile: its manifest, and the row of its index.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "export/cf_netcdf/read_profile.h"
#include "export/csv/json.h"

namespace quadsonde::product {

/// How much of a profile is to be believed: `good` where at least half of the bins with a wind are good, `doubtful`
/// where at least half are good or doubtful, else `bad`.
enum class ArchiveQuality : std::uint8_t { good, doubtful, bad };
std::string_view name(ArchiveQuality quality);
std::optional<ArchiveQuality> archive_quality(std::string_view word);

struct ArchiveEntry {
  std::string name;       ///< of the folder, the netCDF and the STAC item; unique
  std::string folder;     ///< from the archive's root: profiles/2025/06/STATION/NAME
  std::string flight_id;  ///< SHA-256 of the log, a dash, the flight's number
  int version = 1;        ///< from 1, in the order in which this flight's versions were added
  std::string input_file, input_sha256;
  int input_flight = 1;
  std::string sha256;       ///< of the netCDF
  std::uint64_t bytes = 0;  ///< of the netCDF
  std::string tool_version, date_created;
  std::string settings, vehicle_json;                  ///< JSON objects, as text
  std::string vehicle, station, license, institution;  ///< as the file names them; may be empty
  double start_s = 0, end_s = 0;                       ///< since 1970 UTC
  double lat_deg = 0, lon_deg = 0;                     ///< of the launch site
  double bottom_msl_m = 0, top_msl_m = 0;              ///< edges of the lowest and the highest bin with a wind
  std::optional<double> surface_msl_m;                 ///< of the take-off point
  double bin_m = 0;                                    ///< height of the bins; the median where they differ
  int bins = 0, good = 0, doubtful = 0, bad = 0;       ///< with a wind, over all records, and how good they are
  double speed_min_m_s = 0, speed_mean_m_s = 0, speed_max_m_s = 0;  ///< over the bins with a wind
  ArchiveQuality quality = ArchiveQuality::bad;
  bool superseded = false;  ///< by a better version of the same flight; no part of the manifest

  std::string file() const { return folder + "/" + name + ".nc"; }
  std::string item() const { return folder + "/" + name + ".json"; }
  std::string manifest() const { return folder + "/manifest.json"; }
  std::string catalogue_folder() const { return folder.substr(0, folder.rfind('/')); }
};

/// Letters, digits and ._- of a text, everything else as _; no dot or dash at the front, 1 to 40 characters.
/// @param otherwise  for a text of which nothing is left
std::string safe_name(std::string_view text, std::string_view otherwise);

/// The entry of a netCDF. Its name comes from the first sample's UTC, the vehicle, the flight and the bytes, so it is
/// the same wherever and whenever it is added.
ArchiveEntry make_entry(const StoredProfile& profile, ingest::Bytes bytes);

/// Whether `a` is the version to be used rather than `b`: the newer quadsonde, else the one added later.
bool better(const ArchiveEntry& a, const ArchiveEntry& b);

/// manifest.json: everything that is kept of an entry, closed by the SHA-256 of itself.
std::string manifest_text(const ArchiveEntry& entry);
/// Fails with Kind::damaged when it is not what manifest_text() wrote.
ingest::Result<ArchiveEntry> parse_manifest(const std::string& text, const std::string& file);

}  // namespace quadsonde::product
