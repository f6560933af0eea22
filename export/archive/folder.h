#pragma once
// The files of an archive: every one of them appears whole, synced, by one rename; one process writes at a time.
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// For tests: is asked before every step that changes the disk; what is not 0 is the errno that the step fails with.
using ArchiveFault = std::function<int(std::string_view step)>;

/// Asked now and then by what may take long: true makes it end with what it has.
using ArchiveStop = std::function<bool()>;

/// Held while it lives; released with the process too, however that ends.
class ArchiveLock {
 public:
  ArchiveLock() = default;
  explicit ArchiveLock(int descriptor) : descriptor_(descriptor) {}
  ArchiveLock(ArchiveLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  ArchiveLock& operator=(ArchiveLock&& other) noexcept;
  ~ArchiveLock();

 private:
  int descriptor_ = -1;
};

/// Paths are relative to the archive's root, with / between their parts.
///
/// .incoming  where files are written before they are renamed to their place; what stands there while nobody holds the
///            lock was left by a process that died, and goes
/// .unfinished  the journal: folders whose entries may be in place while catalogue and index do not know them yet
/// .lock      flock()ed: exclusively by who writes, shared by who verifies
class ArchiveFolder {
 public:
  explicit ArchiveFolder(std::filesystem::path root, ArchiveFault fault = {})
      : root_(std::move(root)), fault_(std::move(fault)) {}
  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path at(const std::string& relative) const { return root_ / relative; }

  /// Waits; fails with Kind::write_failed after five minutes, when stopped, or where the lock cannot be opened.
  ingest::Result<ArchiveLock> lock_to_write(const ArchiveStop& stopped) const;
  /// Empty when somebody else holds it or this user may not write here.
  std::optional<ArchiveLock> try_lock_to_write() const;
  /// Never fails where there is nothing to lock, as on a medium that nobody writes.
  ingest::Result<ArchiveLock> lock_to_read(const ArchiveStop& stopped) const;

  bool is_file(const std::string& relative) const;
  bool is_folder(const std::string& relative) const;
  /// Its names, sorted.
  std::vector<std::string> names(const std::string& relative) const;
  /// A regular file's bytes; Kind::unreadable, or Kind::limit beyond `most`.
  ingest::Result<std::string> read(const std::string& relative, std::uint64_t most) const;

  /// One file, over an older one.
  ingest::Result<void> place(const std::string& relative, std::string_view content);
  /// The same, if it is not there with this very content.
  ingest::Result<void> place_if_other(const std::string& relative, const std::string& content);
  /// A folder with its files, all at once; a folder of that name that has something in it fails with
  /// Kind::inconsistent.
  ingest::Result<void> place_folder(const std::string& relative,
                                    const std::vector<std::pair<std::string, std::string_view>>& files);
  /// A file that a library wrote and synced, over an older one.
  ingest::Result<void> move_in(const std::string& from, const std::string& to) { return rename(from, to); }
  /// A file, or a folder that is empty; nothing happens where there is none.
  void remove(const std::string& relative);

  ingest::Result<void> make_folders(const std::string& relative);
  void clear_incoming();
  std::vector<std::string> journal() const;
  bool has_journal() const { return is_file(journal_name); }
  ingest::Result<void> write_journal(const std::vector<std::string>& folders);
  void clear_journal() { remove(journal_name); }

  static constexpr const char *journal_name = ".unfinished", *incoming_name = ".incoming", *lock_name = ".lock",
                              *everything = "*";

 private:
  ingest::Result<void> step(std::string_view what, const std::string& relative) const;
  ingest::Result<void> rename(const std::string& from, const std::string& to);
  ingest::Result<void> sync(const std::string& folder) const;
  ingest::Result<std::string> write_incoming(const std::string& name, std::string_view content);

  std::filesystem::path root_;
  ArchiveFault fault_;
  int counter_ = 0;
};

}  // namespace quadsonde::product
