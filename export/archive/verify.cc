#include <algorithm>
#include <tuple>

#include "export/archive/catalogue.h"
#include "export/sha256.h"

namespace quadsonde::product {
namespace {

using ingest::Result;

class Verifier {
 public:
  Verifier(const ArchiveFolder& folder, const ArchiveSettings& settings) : folder_(folder), settings_(settings) {}

  /// Under the lock: everything but the bytes of the profiles.
  void structure() {
    scan_ = scan_archive(folder_, settings_.stopped);
    report_.profiles = scan_.entries.size(), report_.files = scan_.files;
    report_.findings = scan_.findings;
    for (const auto& entry : scan_.entries) by_name_[entry.name] = &entry;
    root();
    flights();
    index();
    catalogues();
  }

  /// The profiles themselves: they never change, so others may write meanwhile.
  void bytes() {
    std::size_t looked = 0;
    for (const auto& entry : scan_.entries) {
      if (settings_.stopped && settings_.stopped()) return;
      profile(entry);
      if (settings_.progress)
        settings_.progress(static_cast<double>(++looked) / static_cast<double>(scan_.entries.size()));
    }
  }

  VerifyReport report() {
    auto& all = report_.findings;
    std::sort(all.begin(), all.end(),
              [](const Finding& a, const Finding& b) { return std::tie(a.path, a.kind) < std::tie(b.path, b.kind); });
    all.erase(std::unique(all.begin(), all.end(),
                          [](const Finding& a, const Finding& b) { return a.path == b.path && a.kind == b.kind; }),
              all.end());
    return std::move(report_);
  }

 private:
  void find(FindingKind kind, const std::string& path, const std::string& what) {
    report_.findings.push_back({kind, path, what});
  }

  /// A file that can be made again.
  void compare(const std::string& path, const std::string& expected) {
    const auto text = folder_.read(path, most_json_bytes);
    if (!folder_.is_file(path))
      find(FindingKind::missing, path, "it is gone; `quadsonde archive rebuild` makes it again");
    else if (!text || *text != expected)
      find(FindingKind::changed, path, "it does not say what the profiles say; `quadsonde archive rebuild` mends it");
  }

  void root() {
    compare(archive_marker, archive_marker_text());
    compare(archive_readme, archive_readme_text());
    report_.files += 5;
    const std::set<std::string> ours{archive_marker,
                                     archive_readme,
                                     archive_index,
                                     std::string(archive_index) + "-wal",
                                     std::string(archive_index) + "-shm",
                                     archive_profiles,
                                     "catalog.json",
                                     "collection.json",
                                     ArchiveFolder::lock_name,
                                     ArchiveFolder::incoming_name,
                                     ArchiveFolder::journal_name};
    for (const auto& name : folder_.names("")) {
      const bool a_folder = name == archive_profiles || name == ArchiveFolder::incoming_name;
      if (!ours.contains(name) || !(a_folder ? folder_.is_folder(name) : folder_.is_file(name)))
        find(FindingKind::foreign, name, "this is none of the archive's");
    }
    for (const auto& name : folder_.names(ArchiveFolder::incoming_name))
      find(FindingKind::unfinished, std::string(ArchiveFolder::incoming_name) + "/" + name,
           "left by a process that ended early; the next `add` clears it");
    if (folder_.has_journal())
      find(FindingKind::unfinished, ArchiveFolder::journal_name,
           "left by a process that ended early; whoever may write opens the archive and finishes it");
  }

  void flights() {
    std::map<std::string, std::vector<ArchiveEntry>> flights;
    for (const auto& entry : scan_.entries) flights[entry.flight_id].push_back(entry);
    for (auto& [id, versions] : flights) {
      const auto relations = relate(versions);
      for (std::size_t i = 0; i < versions.size(); ++i) {
        compare(versions[i].item(), stac_item(versions[i], relations[i]));
        superseded_[versions[i].name] = versions[i].superseded;
      }
    }
  }

  void index() {
    if (!folder_.is_file(archive_index)) {
      find(FindingKind::missing, archive_index, "it is gone; `quadsonde archive rebuild` makes it again");
      return;
    }
    const auto damaged = [&] {
      find(FindingKind::changed, archive_index, "it is damaged; `quadsonde archive rebuild` makes it again");
    };
    auto index = ArchiveIndex::open(folder_.at(archive_index), ArchiveIndex::Mode::read);
    if (!index) return damaged();
    const auto fault = index->fault();
    if (!fault || !fault->empty()) return damaged();
    std::set<std::string> known;
    const auto done = index->each({}, [&](ArchiveEntry&& row) {
      known.insert(row.name);
      row_against_files(row);
      return true;
    });
    if (!done) return damaged();
    for (const auto& entry : scan_.entries)
      if (!known.contains(entry.name)) find(FindingKind::outdated, archive_index, "it does not know " + entry.name);
  }

  void row_against_files(const ArchiveEntry& row) {
    const auto found = by_name_.find(row.name);
    if (found == by_name_.end()) {
      if (!folder_.is_folder(row.folder))
        find(FindingKind::missing, row.folder, "the index knows this profile; it is gone");
      return;
    }
    auto expected = *found->second;
    expected.superseded = superseded_[row.name];
    if (!same_row(row, expected)) find(FindingKind::outdated, archive_index, "it says other things about " + row.name);
  }

  void catalogues() {
    const auto expected = catalogues_of(scan_.entries);
    for (const auto& [path, text] : expected) compare(path, text);
    for (const auto& path : scan_.catalogues) {
      linked(path);
      if (!expected.contains(path)) find(FindingKind::outdated, path, "there are no profiles below it");
    }
    linked("collection.json");
  }

  /// What a catalogue names must be there.
  void linked(const std::string& path) {
    const auto text = folder_.read(path, most_json_bytes);
    const auto json = text ? Json::parse(*text, nullptr, false) : Json();
    if (!json.is_object() || !json.contains("links") || !json["links"].is_array()) return;
    const auto slash = path.rfind('/');
    const auto folder = slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
    for (const auto& link : json["links"]) {
      const auto rel = link.value("rel", ""), href = link.value("href", "");
      if ((rel != "item" && rel != "child") || !href.starts_with("./") || href.find("..") != std::string::npos)
        continue;
      const auto target = folder + href.substr(2), holder = target.substr(0, target.rfind('/'));
      if (!folder_.is_folder(holder)) find(FindingKind::missing, holder, "the catalogue names it; it is gone");
    }
  }

  void profile(const ArchiveEntry& entry) {
    const auto file = entry.file();
    std::error_code error;
    if (!folder_.is_file(file)) return find(FindingKind::missing, file, "the profile is gone");
    const auto size = std::filesystem::file_size(folder_.at(file), error);
    report_.bytes += error ? 0 : size;
    if (!error && size < entry.bytes) return find(FindingKind::truncated, file, "the profile is cut short");
    const auto sha256 = sha256_of_file(folder_.at(file));
    if (!sha256) return find(FindingKind::changed, file, "the profile cannot be read");
    if (*sha256 != entry.sha256) find(FindingKind::changed, file, "the profile is not as it was added");
  }

  const ArchiveFolder& folder_;
  const ArchiveSettings& settings_;
  ArchiveScan scan_;
  std::map<std::string, const ArchiveEntry*> by_name_;
  std::map<std::string, bool> superseded_;
  VerifyReport report_;
};

}  // namespace

std::string_view name(FindingKind kind) {
  constexpr std::string_view words[] = {"missing", "changed", "truncated", "foreign", "outdated", "unfinished"};
  return words[static_cast<int>(kind)];
}

Result<VerifyReport> Archive::verify() {
  Verifier verifier(folder_, settings_);
  {
    const auto lock = folder_.lock_to_read(settings_.stopped);
    if (!lock) return ingest::fail(lock.error());
    verifier.structure();
  }
  verifier.bytes();
  if (settings_.stopped && settings_.stopped())
    return ingest::fail(ingest::Kind::no_answer, "stopped before it was finished", {root().string(), {}, {}, {}},
                        "run it again");
  return verifier.report();
}

}  // namespace quadsonde::product
