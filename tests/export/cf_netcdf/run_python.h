#pragma once
// Runs one of the Python checks beside these tests with the system's interpreter (packages/test.txt).
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/data.h"

namespace quadsonde::support {

/// Its output where it failed, else nothing.
inline std::string python(const std::string& script, const std::string& arguments) {
  const TemporaryFolder folder;
  const auto log = folder / "log";
  const auto command =
      "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 '" + script + "' " + arguments + " > '" + log.string() + "' 2>&1";
  if (std::system(command.c_str()) == 0) return {};
  const auto bytes = read_bytes(log);
  return bytes.empty() ? "it failed without a word" : std::string(bytes.begin(), bytes.end());
}

inline std::string quoted(const std::filesystem::path& path) { return " '" + path.string() + "' "; }

}  // namespace quadsonde::support
