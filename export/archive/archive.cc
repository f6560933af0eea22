#include "export/archive/archive.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>

#include "export/archive/catalogue.h"
#include "export/sha256.h"

namespace quadsonde::product {
namespace {

namespace fs = std::filesystem;
using ingest::fail;
using ingest::Kind;
using ingest::Result;

tl::unexpected<ingest::Problem> not_an_archive(const fs::path& root, const std::string& what) {
  return fail(Kind::usage, what, {root.string(), {}, {}, {}}, "name the folder of an archive, or a new one for `add`");
}

bool is_archives_own(const std::string& name) {
  return name == ArchiveFolder::lock_name || name == ArchiveFolder::incoming_name ||
         name == ArchiveFolder::journal_name;
}

/// A folder that did not exist is on the disk only after the one above it is.
void sync_parent(const fs::path& path) {
  const auto parent = fs::absolute(path).parent_path();
  const int descriptor = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// One step of add(): what is to become of a candidate.
struct Plan {
  const ArchiveCandidate* candidate = nullptr;
  ArchiveEntry entry;
  AddOutcome outcome = AddOutcome::added;
};

bool is_whole(const ArchiveFolder& folder, const ArchiveEntry& entry) {
  const auto bytes = folder.read(entry.file(), most_netcdf_bytes);
  const auto manifest = folder.read(entry.manifest(), most_json_bytes);
  return bytes && manifest && sha256_hex(ingest::as_bytes(*bytes)) == entry.sha256 &&
         parse_manifest(*manifest, entry.manifest()).has_value();
}

/// Decides on each candidate; nothing is written yet.
class Planner {
 public:
  Planner(const ArchiveFolder& folder, ArchiveIndex& index) : folder_(folder), index_(index) {}

  Result<void> take(const ArchiveCandidate& candidate) {
    Plan plan{&candidate, candidate.entry, AddOutcome::added};
    auto known = index_.of_flight(plan.entry.flight_id);
    if (!known) return fail(known.error());
    for (const auto& earlier : plans)
      if (earlier.entry.flight_id == plan.entry.flight_id) known->push_back(earlier.entry);
    int newest = 0;
    const ArchiveEntry* same = nullptr;
    for (const auto& version : *known) {
      newest = std::max(newest, version.version);
      if (version.name == plan.entry.name) same = &version;
    }
    plan.entry.version = same ? same->version : newest + 1;
    if (same) {
      const bool in_this_call =
          std::any_of(plans.begin(), plans.end(), [&](const Plan& p) { return p.entry.name == plan.entry.name; });
      plan.outcome = in_this_call || is_whole(folder_, plan.entry) ? AddOutcome::already_there : AddOutcome::restored;
    } else if (folder_.is_folder(plan.entry.folder)) {
      // An index that is older than the files.
      plan.outcome = is_whole(folder_, plan.entry) ? AddOutcome::already_there : AddOutcome::restored;
      const auto manifest = folder_.read(plan.entry.manifest(), most_json_bytes);
      if (const auto old = manifest ? parse_manifest(*manifest, "") : fail(manifest.error()))
        plan.entry.version = old->version;
      touched.push_back(plan.entry.folder);
    }
    if (plan.outcome != AddOutcome::already_there) touched.push_back(plan.entry.folder);
    plans.push_back(std::move(plan));
    return {};
  }

  std::vector<Plan> plans;
  std::vector<std::string> touched;

 private:
  const ArchiveFolder& folder_;
  ArchiveIndex& index_;
};

Result<void> put_in_place(ArchiveFolder& folder, const Plan& plan) {
  if (plan.outcome == AddOutcome::already_there) return {};
  const auto& e = plan.entry;
  const auto manifest = manifest_text(e);
  if (plan.outcome == AddOutcome::restored && folder.is_folder(e.folder)) {
    if (auto done = folder.place(e.file(), plan.candidate->bytes); !done) return done;
    return folder.place_if_other(e.manifest(), manifest);
  }
  const auto item = stac_item(e, {});
  return folder.place_folder(
      e.folder, {{e.name + ".nc", plan.candidate->bytes}, {e.name + ".json", item}, {"manifest.json", manifest}});
}

/// Brings index, items and catalogues up to what stands in these folders.
Result<void> finish(ArchiveFolder& folder, ArchiveIndex& index, const std::vector<std::string>& folders) {
  std::set<std::string> flights, leaves;
  if (auto begun = index.begin(); !begun) return begun;
  const auto all = [&]() -> Result<void> {
    for (const auto& path : folders) {
      const auto text = folder.read(path + "/manifest.json", most_json_bytes);
      if (!text) continue;  // it never came to its place
      const auto entry = parse_manifest(*text, path);
      if (!entry || entry->folder != path) continue;
      if (auto done = index.put(*entry); !done) return done;
      flights.insert(entry->flight_id);
    }
    for (const auto& flight : flights) {
      if (auto done = refresh_flight(folder, index, flight); !done) return done;
      auto versions = index.of_flight(flight);
      if (!versions) return fail(versions.error());
      for (const auto& version : *versions) leaves.insert(version.catalogue_folder());
    }
    if (auto done = refresh_catalogues(folder, index, leaves); !done) return done;
    return index.commit();
  };
  auto done = all();
  if (!done) index.rollback();
  return done;
}

Result<std::vector<Added>> answers(ArchiveIndex& index, const std::vector<Plan>& plans) {
  std::vector<Added> all;
  for (const auto& plan : plans) {
    Added added{plan.outcome, plan.entry, {}};
    auto versions = index.of_flight(plan.entry.flight_id);
    if (!versions) return fail(versions.error());
    relate(*versions);
    for (const auto& version : *versions)
      if (version.name == plan.entry.name) added.entry.superseded = version.superseded;
    const auto& best = versions->back();
    if (added.entry.superseded) added.other = best.name;
    if (plan.outcome == AddOutcome::added && versions->size() > 1) {
      added.outcome = added.entry.superseded ? AddOutcome::outdated : AddOutcome::superseding;
      if (!added.entry.superseded) added.other = (*versions)[versions->size() - 2].name;
    }
    all.push_back(std::move(added));
  }
  return all;
}

}  // namespace

std::string_view name(AddOutcome outcome) {
  constexpr std::string_view words[] = {"added", "superseding", "outdated", "already there", "restored"};
  return words[static_cast<int>(outcome)];
}

Result<ArchiveCandidate> archive_candidate(std::string bytes, const std::string& name) {
  const auto profile = read_profile_netcdf(ingest::as_bytes(bytes), name);
  if (!profile) return fail(profile.error());
  ArchiveCandidate candidate{std::move(bytes), {}};
  candidate.entry = make_entry(*profile, ingest::as_bytes(candidate.bytes));
  return candidate;
}

Result<void> Archive::check_is_archive(const ArchiveFolder& folder) {
  std::error_code error;
  if (!fs::exists(folder.root(), error)) return not_an_archive(folder.root(), "there is no such folder");
  if (!fs::is_directory(folder.root(), error)) return not_an_archive(folder.root(), "this is a file, not a folder");
  const auto text = folder.read(archive_marker, most_json_bytes);
  if (!text)
    return not_an_archive(folder.root(), fmt::format("this folder is no archive: it has no {}", archive_marker));
  const auto marker = Json::parse(*text, nullptr, false);
  if (!marker.is_object() || marker.value("schema", Json()) != Json("quadsonde.archive/1"))
    return not_an_archive(folder.root(),
                          fmt::format("{} names no kind of archive that this version knows", archive_marker));
  return {};
}

Result<ArchiveIndex> Archive::index_for(ArchiveIndex::Mode mode) {
  if (!folder_.is_file(archive_index))
    return fail(Kind::missing, "this archive has no index", {folder_.at(archive_index).string(), {}, {}, {}},
                "`quadsonde archive rebuild` makes it from the files");
  return ArchiveIndex::open(folder_.at(archive_index), mode);
}

/// Under the lock.
Result<void> Archive::recover() {
  const auto journal = folder_.has_journal() ? folder_.journal() : std::vector<std::string>{};
  const bool all = std::any_of(journal.begin(), journal.end(), [](const std::string& line) {
    return line == ArchiveFolder::everything || !line.starts_with("profiles/") || line.find("..") != std::string::npos;
  });
  folder_.clear_incoming();
  if (all || !folder_.is_file(archive_index)) {
    auto report = rebuild_locked(folder_, settings_);
    if (!report) return fail(report.error());
    return {};
  }
  if (journal.empty()) return {};
  auto index = index_for(ArchiveIndex::Mode::write);
  if (!index) return fail(index.error());
  if (auto done = finish(folder_, *index, journal); !done) return done;
  folder_.clear_journal();
  return {};
}

/// Where there is something to be finished, and this user may do it, and nobody is at it.
Result<void> Archive::settle() {
  const bool no_index = !folder_.is_file(archive_index);
  if (!no_index && !folder_.has_journal() && folder_.names(ArchiveFolder::incoming_name).empty()) return {};
  if (const auto lock = folder_.try_lock_to_write()) return recover();
  if (!no_index) return {};
  // Somebody is making it.
  auto lock = folder_.lock_to_write(settings_.stopped);
  if (!lock) return fail(lock.error());
  return recover();
}

Result<Archive> Archive::open(const fs::path& root, ArchiveSettings settings) {
  Archive archive(ArchiveFolder(root, settings.fault), settings);
  if (auto is = check_is_archive(archive.folder_); !is) return fail(is.error());
  // What cannot be finished now (a full disk) is no reason not to read what is there.
  auto settled = archive.settle();
  if (!settled && !archive.folder_.is_file(archive_index)) return fail(settled.error());
  return archive;
}

Result<Archive> Archive::open_or_create(const fs::path& root, ArchiveSettings settings) {
  std::error_code error;
  if (fs::exists(root, error) && !fs::is_directory(root, error))
    return not_an_archive(root, "this is a file, not a folder");
  Archive archive(ArchiveFolder(root, settings.fault), settings);
  if (!fs::exists(root, error)) {
    fs::create_directories(root, error);
    if (error)
      return fail(Kind::write_failed, fmt::format("this folder cannot be made: {}", error.message()),
                  {root.string(), {}, {}, {}}, "name another folder or change its permissions");
    sync_parent(root);
  }
  auto& folder = archive.folder_;
  if (!folder.is_file(archive_marker)) {
    const auto names = folder.names("");
    // Asked again: another process may have made the archive, marker first, and begun to fill it between the two looks.
    if (!std::all_of(names.begin(), names.end(), is_archives_own) && !folder.is_file(archive_marker))
      return not_an_archive(root, "this folder is no archive, and it is not empty");
    auto lock = folder.lock_to_write(settings.stopped);
    if (!lock) return fail(lock.error());
    if (!folder.is_file(archive_marker))
      if (auto done = folder.place(archive_marker, archive_marker_text()); !done) return fail(done.error());
  }
  if (auto is = check_is_archive(folder); !is) return fail(is.error());
  if (auto settled = archive.settle(); !settled) return fail(settled.error());
  return archive;
}

Result<std::vector<Added>> Archive::add(const std::vector<ArchiveCandidate>& candidates) {
  auto lock = folder_.lock_to_write(settings_.stopped);
  if (!lock) return fail(lock.error());
  if (auto done = recover(); !done) return fail(done.error());
  auto index = index_for(ArchiveIndex::Mode::write);
  if (!index) return fail(index.error());
  Planner planner(folder_, *index);
  for (const auto& candidate : candidates)
    if (auto done = planner.take(candidate); !done) return fail(done.error());
  if (!planner.touched.empty()) {
    const auto write = [&]() -> Result<void> {
      if (auto done = folder_.write_journal(planner.touched); !done) return done;
      for (const auto& plan : planner.plans)
        if (auto done = put_in_place(folder_, plan); !done) return done;
      return finish(folder_, *index, planner.touched);
    };
    if (auto done = write(); !done) {
      // What came to its place is brought into the index if that goes now; else whoever opens the archive next does it.
      (void)recover();
      return fail(done.error());
    }
    folder_.clear_journal();
  }
  return answers(*index, planner.plans);
}

Result<std::vector<ArchiveEntry>> Archive::query(const ArchiveQuery& query) {
  auto index = index_for(ArchiveIndex::Mode::read);
  if (!index) return fail(index.error());
  return query_index(*index, query);
}

Result<std::string> Archive::read(const ArchiveEntry& entry) const {
  auto bytes = folder_.read(entry.file(), most_netcdf_bytes);
  if (!bytes) return bytes;
  if (sha256_hex(ingest::as_bytes(*bytes)) != entry.sha256)
    return fail(Kind::damaged, "this profile is not as it was added", {folder_.at(entry.file()).string(), {}, {}, {}},
                "see `quadsonde archive verify`; adding the same profile again restores it");
  return bytes;
}

Result<RebuildReport> Archive::rebuild(const fs::path& root, ArchiveSettings settings) {
  ArchiveFolder folder(root, settings.fault);
  if (auto is = check_is_archive(folder); !is) return fail(is.error());
  auto lock = folder.lock_to_write(settings.stopped);
  if (!lock) return fail(lock.error());
  return rebuild_locked(folder, settings);
}

}  // namespace quadsonde::product
