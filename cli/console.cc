#include "cli/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value && *value;
}

/// To standard error, which may be a closed pipe: what cannot be said there is not worth ending for.
void write_error(const std::string& text) { std::fputs(text.c_str(), stderr); }

/// Where and what; the next step gets a line of its own.
std::string fact_of(const ingest::Problem& problem) {
  const auto where = ingest::to_string(problem.where);
  return where.empty() ? problem.what : where + ": " + problem.what;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out(text);
  for (auto& c : out)
    if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7F) c = '?';
  return out;
}

Console::Console() {
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  colour_ = terminal && !is_set("NO_COLOR");
  bar_ = terminal && !is_set("CI");
}

void Console::print(std::string_view text) {
  clear_progress();
  const auto safe = printable(text);
  std::fwrite(safe.data(), 1, safe.size(), stdout);
}

bool Console::flush() { return std::fflush(stdout) == 0 && !std::ferror(stdout); }

void Console::say(const char* colour, std::string_view label, const std::string& text, const std::string& next) {
  clear_progress();
  const std::lock_guard lock(mutex_);
  const auto body = product::wrapped(fmt::format("quadsonde: {}: {}", label, printable(text)), 79, 2) +
                    (next.empty() ? "" : "\n" + product::wrapped("  -> " + printable(next), 79, 5));
  if (colour_) {
    const auto from = body.find(label);
    write_error(
        fmt::format("{}\033[{}m{}\033[0m{}\n", body.substr(0, from), colour, label, body.substr(from + label.size())));
  } else {
    write_error(fmt::format("{}\n", body));
  }
}

void Console::note(const std::string& text) {
  if (!quiet_) say("36", "note", text);
}

void Console::warning(const ingest::Problem& problem) {
  const auto fact = fact_of(problem);
  if (quiet_) return;
  {
    const std::lock_guard lock(mutex_);
    if (!told_.insert(fact).second) return;
  }
  say("33", "warning", fact, problem.hint);
}

void Console::warnings(const std::vector<ingest::Problem>& problems) {
  constexpr std::size_t most = 20;
  for (std::size_t i = 0; i < std::min(problems.size(), most); ++i) warning(problems[i]);
  if (problems.size() > most) note(fmt::format("{} more problems; --json lists all", problems.size() - most));
}

void Console::error(const ingest::Problem& problem) { say("31", "error", fact_of(problem), problem.hint); }

void Console::progress(std::string_view stage, double share) {
  if (!bar_ || quiet_) return;
  const std::lock_guard lock(mutex_);
  constexpr int width = 30;
  const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * width);
  write_error(fmt::format("\r[{}{}] {:<30}", std::string(static_cast<std::size_t>(full), '='),
                          std::string(static_cast<std::size_t>(width - full), ' '), stage));
  std::fflush(stderr);
  bar_shown_ = true;
}

void Console::clear_progress() {
  const std::lock_guard lock(mutex_);
  if (bar_shown_) write_error(fmt::format("\r{}\r", std::string(70, ' ')));
  bar_shown_ = false;
}

}  // namespace quadsonde::cli
