#pragma once
// What goes to people: results on standard output, everything else on standard error.
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::cli {

/// Texts out of a log may hold anything; a terminal must not obey it. Control characters become '?'.
std::string printable(std::string_view text);

class Console {
 public:
  Console();
  void set_quiet(bool quiet) { quiet_ = quiet; }

  /// A result.
  void print(std::string_view text);
  void note(const std::string& text);
  /// Told once, however many flights of one log it belongs to.
  void warning(const ingest::Problem& problem);
  void warnings(const std::vector<ingest::Problem>& problems);
  void error(const ingest::Problem& problem);
  /// A bar on a terminal; nothing elsewhere, with --quiet, NO_COLOR's plain dress, and never under CI.
  void progress(std::string_view stage, double share);
  void clear_progress();
  /// False if standard output could not take everything (a closed pipe, a full disk).
  bool flush();

 private:
  void say(const char* colour, std::string_view label, const std::string& text, const std::string& next = {});
  std::mutex mutex_;
  std::set<std::string> told_;  ///< warnings so far
  bool quiet_ = false, bar_ = false, colour_ = false, bar_shown_ = false;
};

}  // namespace quadsonde::cli
