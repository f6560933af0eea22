#include "export/archive/catalogue.h"

#include <algorithm>

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Result;

bool is_number(const std::string& text, std::size_t digits) {
  return text.size() == digits && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Walks profiles/YYYY/MM/STATION/NAME and says what does not belong there.
class Scanner {
 public:
  Scanner(const ArchiveFolder& folder, const ArchiveStop& stopped) : folder_(folder), stopped_(stopped) {}

  ArchiveScan run() {
    if (folder_.is_folder(archive_profiles)) level(archive_profiles, 0);
    return std::move(scan_);
  }

 private:
  void find(FindingKind kind, const std::string& path, const std::string& what) {
    scan_.findings.push_back({kind, path, what});
  }

  /// @param depth  0: years are in it, 1: months, 2: stations, 3: entries
  void level(const std::string& path, int depth) {
    for (const auto& name : folder_.names(path)) {
      if (stopped_ && stopped_()) return;
      const auto below = path + "/" + name;
      if (name == "catalog.json" && depth > 0 && folder_.is_file(below)) {
        scan_.catalogues.push_back(below);
        ++scan_.files;
      } else if (!folder_.is_folder(below) || (depth == 0 && !is_number(name, 4)) ||
                 (depth == 1 && !is_number(name, 2))) {
        find(FindingKind::foreign, below, "this is none of the archive's");
      } else if (depth == 3) {
        entry(below, name);
      } else {
        level(below, depth + 1);
      }
    }
    if (depth > 0) scan_.folders.push_back(path);
  }

  void entry(const std::string& path, const std::string& name) {
    const auto names = folder_.names(path);
    for (const auto& file : names) {
      const bool ours = (file == name + ".nc" || file == name + ".json" || file == "manifest.json") &&
                        folder_.is_file(path + "/" + file);
      if (ours)
        ++scan_.files;
      else
        find(FindingKind::foreign, path + "/" + file, "this is none of the archive's");
    }
    const auto has = [&](const std::string& file) { return folder_.is_file(path + "/" + file); };
    if (!has("manifest.json")) {
      if (has(name + ".nc") || has(name + ".json"))
        find(FindingKind::missing, path + "/manifest.json", "the manifest of this profile is gone");
      else
        find(FindingKind::foreign, path, "this folder holds no profile");
      scan_.without_manifest.push_back(path);
      return;
    }
    manifest(path, name);
  }

  void manifest(const std::string& path, const std::string& name) {
    const auto file = path + "/manifest.json";
    const auto text = folder_.read(file, most_json_bytes);
    auto entry = text ? parse_manifest(*text, file) : Result<ArchiveEntry>(fail(text.error()));
    if (!entry || entry->folder != path || entry->name != name) {
      find(FindingKind::changed, file, !entry ? "the manifest is not as it was written" : "it is of another profile");
      scan_.without_manifest.push_back(path);
      return;
    }
    scan_.entries.push_back(std::move(*entry));
  }

  const ArchiveFolder& folder_;
  const ArchiveStop& stopped_;
  ArchiveScan scan_;
};

Result<void> write_branch(ArchiveFolder& folder, ArchiveIndex& index, const std::string& branch) {
  const auto children = index.folders_in(branch);
  if (!children) return fail(children.error());
  if (!children->empty()) return folder.place_if_other(branch + "/catalog.json", stac_branch(branch, *children));
  folder.remove(branch + "/catalog.json");
  folder.remove(branch);
  return {};
}

std::string parent(const std::string& path) { return path.substr(0, path.rfind('/')); }

}  // namespace

std::string archive_marker_text() {
  return json_text(
      Json{{"schema", "quadsonde.archive/1"},
           {"layout", "profiles/YYYY/MM/STATION/NAME/NAME.nc, with NAME.json and manifest.json beside it"}});
}

std::string archive_readme_text() {
  return R"(An archive of vertical wind profiles from multirotor flight logs.

profiles/YYYY/MM/STATION/NAME/
  NAME.nc         the profile: CF-1.8 netCDF-4; what it was made of stands in its attributes
  NAME.json       the same as a STAC 1.0 item
  manifest.json   SHA-256 of NAME.nc, the log it came from and its SHA-256, the
                  software, its settings, and the numbers that the index holds
catalog.json, collection.json   a static STAC catalogue, all links relative
index.sqlite      one table "profile", made of the manifests; may be deleted

Only the netCDF files and their manifests are needed. The log's SHA-256 and the number of the
flight in it tell which flight a profile is of; of several versions the best is current, the
others have "deprecated": true in their items. `quadsonde archive verify` checks all of it, and
`quadsonde archive rebuild` makes everything but the netCDF files again. By hand, the SHA-256 of
a netCDF file is `sha256sum NAME.nc`.
)";
}

std::vector<Versions> relate(std::vector<ArchiveEntry>& versions) {
  std::sort(versions.begin(), versions.end(), [](const auto& a, const auto& b) { return better(b, a); });
  std::vector<Versions> all(versions.size());
  for (std::size_t i = 0; i < versions.size(); ++i) {
    versions[i].superseded = i + 1 < versions.size();
    if (i > 0) all[i].predecessor = versions[i - 1].name, all[i].folder_of_predecessor = versions[i - 1].folder;
    if (!versions[i].superseded) continue;
    all[i].successor = versions[i + 1].name, all[i].folder_of_successor = versions[i + 1].folder;
    all[i].latest = versions.back().name, all[i].folder_of_latest = versions.back().folder;
  }
  return all;
}

std::map<std::string, std::string> catalogues_of(const std::vector<ArchiveEntry>& entries) {
  std::map<std::string, std::set<std::string>> children;
  ArchiveExtent extent;
  for (const auto& e : entries) {
    const auto leaf = e.catalogue_folder(), month = parent(leaf), year = parent(month);
    children[leaf].insert(e.name);
    children[month].insert(leaf.substr(month.size() + 1)), children[year].insert(month.substr(year.size() + 1));
    children[archive_profiles].insert(year.substr(year.rfind('/') + 1));
    const auto low = [&](double& value, double other) { value = extent.any ? std::min(value, other) : other; };
    const auto high = [&](double& value, double other) { value = extent.any ? std::max(value, other) : other; };
    low(extent.west, e.lon_deg), low(extent.south, e.lat_deg), high(extent.east, e.lon_deg);
    high(extent.north, e.lat_deg), low(extent.start_s, e.start_s), high(extent.end_s, e.end_s);
    extent.any = true;
  }
  std::map<std::string, std::string> texts{{"catalog.json", stac_root()}};
  const auto list = [](const std::set<std::string>& names) { return std::vector(names.begin(), names.end()); };
  texts["collection.json"] = stac_collection(extent, list(children[archive_profiles]));
  for (const auto& [path, names] : children) {
    const auto depth = std::count(path.begin(), path.end(), '/');
    if (depth > 0)
      texts[path + "/catalog.json"] = depth == 3 ? stac_leaf(path, list(names)) : stac_branch(path, list(names));
  }
  return texts;
}

Result<void> refresh_flight(ArchiveFolder& folder, ArchiveIndex& index, const std::string& flight_id) {
  auto versions = index.of_flight(flight_id);
  if (!versions) return fail(versions.error());
  const auto relations = relate(*versions);
  for (std::size_t i = 0; i < versions->size(); ++i) {
    const auto& entry = (*versions)[i];
    if (auto done = index.mark(entry.name, entry.superseded); !done) return done;
    if (!folder.is_folder(entry.folder)) continue;  // lost: verify tells it
    if (auto done = folder.place_if_other(entry.item(), stac_item(entry, relations[i])); !done) return done;
  }
  return {};
}

Result<void> refresh_catalogues(ArchiveFolder& folder, ArchiveIndex& index, const std::set<std::string>& leaves) {
  std::set<std::string> months, years;
  for (const auto& leaf : leaves) {
    const auto names = index.names_in(leaf);
    if (!names) return fail(names.error());
    months.insert(parent(leaf)), years.insert(parent(parent(leaf)));
    if (!names->empty()) {
      if (auto done = folder.place_if_other(leaf + "/catalog.json", stac_leaf(leaf, *names)); !done) return done;
      continue;
    }
    folder.remove(leaf + "/catalog.json");
    folder.remove(leaf);
  }
  for (const auto* branches : {&months, &years})
    for (const auto& branch : *branches)
      if (auto done = write_branch(folder, index, branch); !done) return done;
  const auto all_years = index.folders_in(archive_profiles);
  const auto extent = index.extent();
  if (!all_years) return fail(all_years.error());
  if (!extent) return fail(extent.error());
  if (auto done = folder.place_if_other("collection.json", stac_collection(*extent, *all_years)); !done) return done;
  return folder.place_if_other("catalog.json", stac_root());
}

ArchiveScan scan_archive(const ArchiveFolder& folder, const ArchiveStop& stopped) {
  return Scanner(folder, stopped).run();
}

}  // namespace quadsonde::product
