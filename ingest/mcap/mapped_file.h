#pragma once
// A file's bytes without reading them all into memory.
#include <filesystem>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::ingest::mcap {

/// A read-only memory map. Move only. A file that shrinks while it is mapped ends the program (as any map does).
class MappedFile {
 public:
  /// @return fails with unreadable if it cannot be opened or is no regular file; an empty file gives no bytes
  static Result<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();
  Bytes bytes() const { return bytes_; }

 private:
  explicit MappedFile(Bytes bytes) : bytes_(bytes) {}
  Bytes bytes_;
};

}  // namespace quadsonde::ingest::mcap
