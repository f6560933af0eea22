#include "export/archive/subset.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <tuple>

#include "export/archive/catalogue.h"

namespace quadsonde::product {
namespace {

namespace fs = std::filesystem;
using ingest::fail;
using ingest::Kind;
using ingest::Result;

/// Goes with everything in it unless it was given its place.
class Beside {
 public:
  explicit Beside(const fs::path& target)
      : path_(target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid())) {}
  ~Beside() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  const fs::path& path() const { return path_; }

  Result<void> give_place(const fs::path& target) {
    const auto moved_away = fs::path(path_.string() + ".old");
    std::error_code error, ignored;
    const bool was_there = fs::exists(target, error);
    if (was_there) fs::rename(target, moved_away, error);
    if (!error) fs::rename(path_, target, error);
    if (error) {
      if (was_there && !fs::exists(target, ignored)) fs::rename(moved_away, target, ignored);
      return fail(Kind::write_failed, fmt::format("cannot be renamed to its place: {}", error.message()),
                  {target.string(), {}, {}, {}}, "name another folder");
    }
    if (was_there) fs::remove_all(moved_away, ignored);
    return {};
  }

 private:
  fs::path path_;
};

Result<void> check_target(const fs::path& to, bool overwrite) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(to, error))) return {};
  const auto there = [&](const char* what) {
    return fail(Kind::usage, what, {to.string(), {}, {}, {}},
                "name a new folder; --force replaces an archive, and nothing else");
  };
  if (!fs::is_directory(to, error)) return there("this is no folder");
  if (fs::is_empty(to, error)) return {};
  if (!fs::exists(to / archive_marker, error)) return there("this folder is no archive, and it is not empty");
  if (!overwrite) return there("an archive is already there");
  return {};
}

Result<ArchiveCandidate> stored(const Archive& from, const ArchiveEntry& entry) {
  auto bytes = from.read(entry);
  if (!bytes) return fail(bytes.error());
  const ArchiveFolder folder(from.root());
  const auto text = folder.read(entry.manifest(), most_json_bytes);
  if (!text) return fail(text.error());
  auto full = parse_manifest(*text, folder.at(entry.manifest()).string());
  if (!full) return fail(full.error());
  return ArchiveCandidate{std::move(*bytes), std::move(*full)};
}

/// In steps of so many, each of which is one commit.
constexpr std::size_t at_once = 64;

Result<void> fill(Archive& to, const Archive& from, std::vector<ArchiveEntry> entries,
                  const ArchiveSettings& settings) {
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    return std::tie(a.flight_id, a.version) < std::tie(b.flight_id, b.version);
  });
  std::vector<ArchiveCandidate> batch;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (settings.stopped && settings.stopped())
      return fail(Kind::no_answer, "stopped before it was finished", {}, "nothing was written; run it again");
    auto candidate = stored(from, entries[i]);
    if (!candidate) return fail(candidate.error());
    batch.push_back(std::move(*candidate));
    if (batch.size() < at_once && i + 1 < entries.size()) continue;
    if (auto added = to.add(batch); !added) return fail(added.error());
    batch.clear();
    if (settings.progress) settings.progress(static_cast<double>(i + 1) / static_cast<double>(entries.size()));
  }
  return {};
}

}  // namespace

Result<void> export_subset(const Archive& from, const std::vector<ArchiveEntry>& entries, const fs::path& to,
                           bool overwrite, const ArchiveSettings& settings) {
  auto target = fs::absolute(to).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  if (auto may = check_target(target, overwrite); !may) return may;
  Beside beside(target);
  {
    auto archive = Archive::open_or_create(beside.path(), settings);
    if (!archive) return fail(archive.error());
    if (auto done = fill(*archive, from, entries, settings); !done) return done;
  }
  return beside.give_place(target);
}

}  // namespace quadsonde::product
