#pragma once
// Files that are there whole or not at all.
#include <filesystem>
#include <memory>
#include <string_view>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// A file written beside its target. commit() syncs it and renames it over the target; without commit() the
/// destructor removes it. Move only.
class AtomicFile {
 public:
  /// @param overwrite  false: an existing target fails with usage, now or at the commit
  static ingest::Result<AtomicFile> create(std::filesystem::path path, bool overwrite = false);
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  ~AtomicFile();

  ingest::Result<void> write(ingest::Bytes bytes);
  ingest::Result<void> write(std::string_view text) { return write(ingest::as_bytes(text)); }
  ingest::Result<void> commit();
  const std::filesystem::path& path() const { return path_; }
  /// The file's name until the commit, for libraries that open files themselves (they may replace its content).
  const std::filesystem::path& temporary_path() const { return temporary_; }

 private:
  AtomicFile(std::filesystem::path path, std::filesystem::path temporary, int descriptor, bool overwrite);
  void abandon();
  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
  bool overwrite_ = false;
};

/// A whole text or byte string at once.
ingest::Result<void> write_file(const std::filesystem::path& path, std::string_view content, bool overwrite = false);

}  // namespace quadsonde::product
