#pragma once
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "cli/options.h"
#include "ingest/flight/problem.h"

namespace quadsonde::cli {

/// quadsonde.toml beside the first input, if it is there.
std::optional<std::filesystem::path> settings_beside(const std::filesystem::path& input);

/// Sets what the file names and the command line did not. Paths in it are relative to it.
/// @param known_elsewhere  settings of other verbs, which one file may serve as well
/// Fails with Kind::usage for a key that no verb knows or a value out of its range, with the line.
ingest::Result<void> apply_settings_file(const std::filesystem::path& file, Options& options,
                                         const std::set<std::string>& known_elsewhere);

}  // namespace quadsonde::cli
