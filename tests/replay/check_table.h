#pragma once
// What `check` says about every recorded flight of the shared data, one row per flight of a file.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "export/pipeline/check.h"

namespace quadsonde::replay {

struct CheckRow {
  std::string file;  ///< below the folder searched, with " + map.toml" where one was given
  int flight = 1, flights = 1;
  std::string format;                      ///< empty if no reader knew it
  std::optional<ingest::Verdict> verdict;  ///< empty: there is nothing to check, and `reason` tells why
  double chi2 = 0, chi2_restored = 0;      ///< per degree of freedom, as named and with the named fault undone
  std::string fault;                       ///< id of the first finding that decides; may be empty
  std::string reason;
  int exit_code = 0;  ///< as `quadsonde check --flight N` ends
};

/// The longest flight of one file, checked as `quadsonde check` does it by itself.
CheckRow check_file(const std::filesystem::path& file, const std::filesystem::path& shown_below,
                    const std::optional<std::filesystem::path>& columns = {});
/// Every file below a folder that could be a log, in order of name; those named in `leave_out` are not opened.
std::vector<CheckRow> check_folder(const std::filesystem::path& folder, const std::filesystem::path& shown_below,
                                   const std::vector<std::string>& leave_out = {});
/// The rows as a table of Markdown.
std::string markdown(const std::vector<CheckRow>& rows);

}  // namespace quadsonde::replay
