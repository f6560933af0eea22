#include "export/pipeline/archive_run.h"

#include "export/pipeline/netcdf.h"

namespace quadsonde::product {

ArchiveSettings archive_settings(const Control& control, std::string stage) {
  ArchiveSettings settings;
  settings.stopped = [control] { return control.stopped(); };
  settings.progress = [control, stage = std::move(stage)](double share) { control.report(stage, share); };
  return settings;
}

ingest::Result<ArchivedRun> archive_run(const RunResult& run, const std::filesystem::path& archive,
                                        const Control& control) {
  ArchivedRun result;
  std::vector<ArchiveCandidate> candidates;
  for (const auto& flight : run.flights) {
    const auto& answer = flight.answer;
    if (!answer.profile) {
      if (answer.no_profile) result.left_out.push_back(*answer.no_profile);
      continue;
    }
    auto bytes = profile_netcdf_of(answer);
    auto candidate = bytes ? archive_candidate(std::move(*bytes), answer.source.file)
                           : ingest::Result<ArchiveCandidate>(ingest::fail(bytes.error()));
    if (candidate)
      candidates.push_back(std::move(*candidate));
    else
      result.left_out.push_back(candidate.error());
  }
  if (candidates.empty()) return result;
  if (control.stopped()) return ingest::fail(stopped_problem());
  const WritingGuard writing(control);
  auto opened = Archive::open_or_create(archive, archive_settings(control, "archive"));
  if (!opened) return ingest::fail(opened.error());
  auto added = opened->add(candidates);
  if (!added) return ingest::fail(added.error());
  result.added = std::move(*added);
  return result;
}

}  // namespace quadsonde::product
