#pragma once
// An archive of wind profiles: a folder that is the dataset and outlives the tool that made it.
//
//   quadsonde-archive.json, README.txt       what this folder is
//   catalog.json, collection.json            STAC 1.0
//   profiles/YYYY/MM/STATION/NAME/           one profile: NAME.nc (CF netCDF), NAME.json (STAC item), manifest.json
//   profiles/.../catalog.json                one per year, month and station
//   index.sqlite                             for queries; made of the manifests
//
// The netCDF files and their manifests are the archive; everything else is made of them (rebuild). A profile appears
// with its three files by one rename of their folder, after they are synced; then catalogue and index follow, guarded
// by a journal that the next one who opens the archive finishes. Nothing that add() returned is ever lost by a crash.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "export/archive/folder.h"
#include "export/archive/index.h"
#include "export/archive/query.h"

namespace quadsonde::product {

/// A profile to be added: its bytes, and what they say.
struct ArchiveCandidate {
  std::string bytes;
  ArchiveEntry entry;
};
/// Fails as read_profile_netcdf does.
ingest::Result<ArchiveCandidate> archive_candidate(std::string bytes, const std::string& name);

enum class AddOutcome {
  added,          ///< the first of its flight
  superseding,    ///< of a flight that was there: better than what was there
  outdated,       ///< of a flight that was there: kept, but marked as superseded, for an older quadsonde made it
  already_there,  ///< these very bytes were there
  restored        ///< they were there by name, but missing or changed on the disk: they are whole again
};
std::string_view name(AddOutcome outcome);
struct Added {
  AddOutcome outcome = AddOutcome::added;
  ArchiveEntry entry;
  std::string other;  ///< the version that it supersedes, or that supersedes it
};

enum class FindingKind { missing, changed, truncated, foreign, outdated, unfinished };
std::string_view name(FindingKind kind);
struct Finding {
  FindingKind kind;
  std::string path;  ///< from the archive's root
  std::string what;
};

struct VerifyReport {
  std::size_t profiles = 0, files = 0;
  std::uint64_t bytes = 0;
  std::vector<Finding> findings;  ///< in the order of their paths; empty: everything is there and as it was written
};

struct RebuildReport {
  std::size_t profiles = 0, remade_manifests = 0;
  std::vector<Finding> findings;  ///< what could not be taken into the index
};

using ArchiveProgress = std::function<void(double share)>;

struct ArchiveSettings {
  ArchiveStop stopped;
  ArchiveProgress progress;
  ArchiveFault fault;  ///< for tests
};

class Archive {
 public:
  /// Finishes what a process that died has left, where this user may write; makes an index where there is none.
  /// Fails with Kind::usage when this is no archive.
  static ingest::Result<Archive> open(const std::filesystem::path& root, ArchiveSettings settings = {});
  /// The same, made where nothing or an empty folder is.
  static ingest::Result<Archive> open_or_create(const std::filesystem::path& root, ArchiveSettings settings = {});

  /// All of them, or a Problem. What is returned is on the disk: files, catalogue and index. Several processes may do
  /// it at once. After a Problem an archive holds what it held before and perhaps some of the new ones, whole.
  ingest::Result<std::vector<Added>> add(const std::vector<ArchiveCandidate>& candidates);

  ingest::Result<std::vector<ArchiveEntry>> query(const ArchiveQuery& query);
  /// The netCDF of an entry. Fails with Kind::damaged when it is not as it was added.
  ingest::Result<std::string> read(const ArchiveEntry& entry) const;

  /// Compares every file with its manifest, and catalogue and index with the files. Changes nothing.
  ingest::Result<VerifyReport> verify();
  /// Makes index, catalogue, items and, from sound netCDF files, missing manifests again from the files alone.
  static ingest::Result<RebuildReport> rebuild(const std::filesystem::path& root, ArchiveSettings settings = {});

  const std::filesystem::path& root() const { return folder_.root(); }

 private:
  Archive(ArchiveFolder folder, ArchiveSettings settings)
      : folder_(std::move(folder)), settings_(std::move(settings)) {}
  static ingest::Result<void> check_is_archive(const ArchiveFolder& folder);
  ingest::Result<void> settle();
  ingest::Result<void> recover();
  ingest::Result<ArchiveIndex> index_for(ArchiveIndex::Mode mode);

  ArchiveFolder folder_;
  ArchiveSettings settings_;
};

}  // namespace quadsonde::product
