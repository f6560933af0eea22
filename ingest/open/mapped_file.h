#pragma once
#include <filesystem>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::ingest {

/// A file mapped into memory for reading, unmapped with the object. Not to be cut by others meanwhile.
class MappedFile {
 public:
  /// Errors: unreadable (no such file, a folder, no permission), not_a_log (empty).
  static Result<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();
  Bytes bytes() const { return {static_cast<const std::uint8_t*>(data_), size_}; }

 private:
  MappedFile(void* data, std::size_t size) : data_(data), size_(size) {}
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace quadsonde::ingest
