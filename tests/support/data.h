#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace quadsonde::support {

/// A file of the shared data (QUADSONDE_DATA), whether or not it is there.
std::filesystem::path data_file(const std::string& relative);
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path);
void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes);

/// A new empty folder that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace quadsonde::support

/// Skips the running test, by name, where the shared data is not there.
#define QUADSONDE_NEEDS_DATA(relative)                                                \
  if (!std::filesystem::exists(quadsonde::support::data_file(relative)))              \
  GTEST_SKIP() << "needs QUADSONDE_DATA: " << (relative)
