#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/data.h"

namespace quadsonde::support {

struct Ended {
  int code = -1;  ///< exit code, or 128 + signal
  std::string out, err;
};

/// Runs the built program in a folder and waits for it.
/// @param interrupt_after_s  Ctrl-C after so long; negative: never
Ended quadsonde(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                double interrupt_after_s = -1);

/// The same with no file allowed to grow beyond so many bytes: what a full disk does, in the middle of a file.
Ended quadsonde_on_full_disk(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                             std::uint64_t bytes);

/// Files and folders below a folder, relative, sorted: what a run left behind.
std::vector<std::string> tree(const std::filesystem::path& folder);

/// A log of a short simulated ascent and descent with a turning nose, as a table: made once, copied.
void place_flight(const std::filesystem::path& csv);
/// The same with the lines of its table changed.
void place_changed_flight(const std::filesystem::path& csv,
                          const std::function<std::string(std::string line, std::size_t number)>& change);
/// The table without some of its columns.
void place_flight_without(const std::filesystem::path& csv, const std::vector<std::string>& columns);
void place_scenario(const std::filesystem::path& toml);

}  // namespace quadsonde::support
