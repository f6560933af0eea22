#pragma once
// What a run found, into an archive.
#include <filesystem>
#include <string>
#include <vector>

#include "export/archive/archive.h"
#include "export/pipeline/run_log.h"

namespace quadsonde::product {

struct ArchivedRun {
  std::vector<Added> added;
  std::vector<ingest::Problem> left_out;  ///< why a flight gave no netCDF and so is not in the archive
};

/// Adds the profiles of a run to an archive, which is made where there is none. A flight without UTC, place or a wind
/// cannot be archived; that is no failure.
/// Fails as Archive::open_or_create and Archive::add do.
ingest::Result<ArchivedRun> archive_run(const RunResult& run, const std::filesystem::path& archive,
                                        const Control& control = {});

/// Counts as writing while it lives, so that an interrupt waits for it.
class WritingGuard {
 public:
  explicit WritingGuard(const Control& control) : control_(control) {
    if (control_.writing) ++*control_.writing;
  }
  ~WritingGuard() {
    if (control_.writing) --*control_.writing;
  }
  WritingGuard(const WritingGuard&) = delete;
  WritingGuard& operator=(const WritingGuard&) = delete;

 private:
  const Control& control_;
};

/// The settings that let an archive be stopped and watched as everything else is.
ArchiveSettings archive_settings(const Control& control, std::string stage);

}  // namespace quadsonde::product
