#include <algorithm>

#include "export/archive/catalogue.h"
#include "export/sha256.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Result;

/// Whether the netCDF of an entry is as its manifest says; what it is instead goes into the findings.
void check_netcdf(const ArchiveFolder& folder, const ArchiveEntry& entry, std::vector<Finding>& findings) {
  const auto bytes = folder.read(entry.file(), most_netcdf_bytes);
  if (!bytes)
    findings.push_back({folder.is_file(entry.file()) ? FindingKind::changed : FindingKind::missing, entry.file(),
                        "the profile cannot be read"});
  else if (bytes->size() < entry.bytes)
    findings.push_back({FindingKind::truncated, entry.file(), "the profile is cut short"});
  else if (sha256_hex(ingest::as_bytes(*bytes)) != entry.sha256)
    findings.push_back({FindingKind::changed, entry.file(), "the profile is not as it was added"});
}

/// A profile whose manifest is gone, from its netCDF alone. Empty when that is none of ours or not the one that the
/// folder is named after.
std::optional<ArchiveEntry> entry_of_netcdf(const ArchiveFolder& folder, const std::string& path) {
  const auto name = path.substr(path.rfind('/') + 1);
  auto bytes = folder.read(path + "/" + name + ".nc", most_netcdf_bytes);
  if (!bytes) return std::nullopt;
  auto candidate = archive_candidate(std::move(*bytes), name + ".nc");
  // Its name holds the fingerprint of its bytes: a changed profile has another.
  if (!candidate || candidate->entry.folder != path) return std::nullopt;
  return candidate->entry;
}

Result<void> remake_manifests(ArchiveFolder& folder, ArchiveScan& scan, RebuildReport& report) {
  std::map<std::string, int> newest;
  for (const auto& entry : scan.entries) newest[entry.flight_id] = std::max(newest[entry.flight_id], entry.version);
  for (const auto& path : scan.without_manifest) {
    auto entry = entry_of_netcdf(folder, path);
    if (!entry) continue;
    entry->version = ++newest[entry->flight_id];
    if (auto done = folder.place(entry->manifest(), manifest_text(*entry)); !done) return done;
    std::erase_if(scan.findings, [&](const Finding& f) { return f.path == entry->manifest(); });
    scan.entries.push_back(std::move(*entry));
    ++report.remade_manifests;
  }
  return {};
}

Result<void> write_index(ArchiveFolder& folder, const std::vector<ArchiveEntry>& entries) {
  if (auto made = folder.make_folders(ArchiveFolder::incoming_name); !made) return made;
  const auto incoming = std::string(ArchiveFolder::incoming_name) + "/" + archive_index;
  {
    auto index = ArchiveIndex::open(folder.at(incoming), ArchiveIndex::Mode::create);
    if (!index) return fail(index.error());
    if (auto done = index->begin(); !done) return done;
    for (const auto& entry : entries)
      if (auto done = index->put(entry); !done) return done;
    if (auto done = index->commit(); !done) return done;
    if (auto done = index->finish_creation(); !done) return done;
  }
  // What the old index had not yet taken in must not be read into the new one.
  for (const auto* ending : {"-wal", "-shm"}) folder.remove(std::string(archive_index) + ending);
  return folder.move_in(incoming, archive_index);
}

Result<void> write_items(ArchiveFolder& folder, std::vector<ArchiveEntry>& entries) {
  std::map<std::string, std::vector<ArchiveEntry>> flights;
  for (auto& entry : entries) flights[entry.flight_id].push_back(std::move(entry));
  entries.clear();
  for (auto& [id, versions] : flights) {
    const auto relations = relate(versions);
    for (std::size_t i = 0; i < versions.size(); ++i) {
      if (auto done = folder.place_if_other(versions[i].item(), stac_item(versions[i], relations[i])); !done)
        return done;
      entries.push_back(std::move(versions[i]));
    }
  }
  return {};
}

}  // namespace

ingest::Result<RebuildReport> rebuild_locked(ArchiveFolder& folder, const ArchiveSettings& settings) {
  const auto stopped = [&] { return settings.stopped && settings.stopped(); };
  const auto stop = fail(Kind::no_answer, "stopped before it was finished", {folder.root().string(), {}, {}, {}},
                         "the next one who opens the archive finishes it");
  if (auto done = folder.write_journal({ArchiveFolder::everything}); !done) return fail(done.error());
  folder.clear_incoming();
  if (auto done = folder.place_if_other(archive_readme, archive_readme_text()); !done) return fail(done.error());
  auto scan = scan_archive(folder, settings.stopped);
  if (stopped()) return stop;
  RebuildReport report;
  if (auto done = remake_manifests(folder, scan, report); !done) return fail(done.error());
  std::size_t looked = 0;
  for (const auto& entry : scan.entries) {
    if (stopped()) return stop;
    check_netcdf(folder, entry, scan.findings);
    if (settings.progress)
      settings.progress(0.9 * static_cast<double>(++looked) / static_cast<double>(scan.entries.size()));
  }
  if (auto done = write_items(folder, scan.entries); !done) return fail(done.error());
  if (auto done = write_index(folder, scan.entries); !done) return fail(done.error());
  const auto catalogues = catalogues_of(scan.entries);
  for (const auto& [path, text] : catalogues)
    if (auto done = folder.place_if_other(path, text); !done) return fail(done.error());
  for (const auto& path : scan.catalogues)
    if (!catalogues.contains(path)) folder.remove(path);
  for (const auto& path : scan.folders) folder.remove(path);  // only empty ones go
  folder.clear_journal();
  report.profiles = scan.entries.size();
  report.findings = std::move(scan.findings);
  std::sort(report.findings.begin(), report.findings.end(),
            [](const Finding& a, const Finding& b) { return std::tie(a.path, a.kind) < std::tie(b.path, b.kind); });
  return report;
}

}  // namespace quadsonde::product
