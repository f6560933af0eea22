#pragma once
// What is made of the manifests: relations of versions, items, catalogues.
#include <map>
#include <set>
#include <string>
#include <vector>

#include "export/archive/archive.h"

namespace quadsonde::product {

constexpr const char *archive_marker = "quadsonde-archive.json", *archive_readme = "README.txt",
                     *archive_index = "index.sqlite", *archive_profiles = "profiles";
std::string archive_marker_text();
std::string archive_readme_text();

/// Sorts the versions of one flight from the worst to the best, marks all but the last as superseded and gives each
/// its relations.
std::vector<Versions> relate(std::vector<ArchiveEntry>& versions);

/// Every catalogue of an archive with these entries: path and text.
std::map<std::string, std::string> catalogues_of(const std::vector<ArchiveEntry>& entries);

/// Marks and items of a flight, from the index; leaves touched are added.
ingest::Result<void> refresh_flight(ArchiveFolder& folder, ArchiveIndex& index, const std::string& flight_id);
/// The catalogues of these folders and of everything above them, from the index.
ingest::Result<void> refresh_catalogues(ArchiveFolder& folder, ArchiveIndex& index,
                                        const std::set<std::string>& leaves);

/// What stands on the disk below profiles/.
struct ArchiveScan {
  std::vector<ArchiveEntry> entries;          ///< those with a sound manifest
  std::vector<std::string> without_manifest;  ///< folders that may be entries
  std::vector<std::string> catalogues;        ///< every catalog.json met
  std::vector<std::string> folders;           ///< of years, months, stations, deepest first
  std::vector<Finding> findings;
  std::size_t files = 0;
};
ArchiveScan scan_archive(const ArchiveFolder& folder, const ArchiveStop& stopped);

/// Under the lock: everything derived, made again.
ingest::Result<RebuildReport> rebuild_locked(ArchiveFolder& folder, const ArchiveSettings& settings);

constexpr std::uint64_t most_netcdf_bytes = std::uint64_t{64} << 20, most_json_bytes = std::uint64_t{16} << 20;

}  // namespace quadsonde::product
