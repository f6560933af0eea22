#include "tests/cli/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <thread>

#include "tests/export/pipeline/flown.h"

namespace quadsonde::support {
namespace {

[[noreturn]] void become(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                         const std::filesystem::path& out, const std::filesystem::path& err, std::uint64_t most_bytes) {
  if (most_bytes) {
    const rlimit limit{most_bytes, most_bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::vector<char*> argv;
  std::string program = QUADSONDE_PROGRAM;
  argv.push_back(program.data());
  auto copies = arguments;
  for (auto& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int out_fd = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600),
            err_fd = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(out_fd, 1), ::dup2(err_fd, 2);
  if (::chdir(folder.c_str()) != 0) ::_exit(126);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

const std::string& flight_table() {
  static const std::string text = product::flight_csv(flown().flight);
  return text;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line + ",");
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

Ended start(const std::vector<std::string>& arguments, const std::filesystem::path& folder, double interrupt_after_s,
            std::uint64_t most_bytes) {
  const TemporaryFolder streams;
  const auto out = streams / "out", err = streams / "err";
  const pid_t child = ::fork();
  if (child == 0) become(arguments, folder, out, err, most_bytes);
  if (interrupt_after_s >= 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(interrupt_after_s));
    ::kill(child, SIGINT);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(out), read_text(err)};
}

}  // namespace

Ended quadsonde(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                double interrupt_after_s) {
  return start(arguments, folder, interrupt_after_s, 0);
}

Ended quadsonde_on_full_disk(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                             std::uint64_t bytes) {
  return start(arguments, folder, -1, bytes);
}

std::vector<std::string> tree(const std::filesystem::path& folder) {
  std::vector<std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    all.push_back(std::filesystem::relative(entry.path(), folder).string());
  std::sort(all.begin(), all.end());
  return all;
}

void place_flight(const std::filesystem::path& csv) { write_text(csv, flight_table()); }

void place_changed_flight(const std::filesystem::path& csv,
                          const std::function<std::string(std::string, std::size_t)>& change) {
  std::istringstream lines(flight_table());
  std::string text;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) text += change(line, ++number) + "\n";
  write_text(csv, text);
}

void place_flight_without(const std::filesystem::path& csv, const std::vector<std::string>& columns) {
  std::vector<bool> keep;
  place_changed_flight(csv, [&](const std::string& line, std::size_t number) {
    const auto cells = cells_of(line);
    if (number == 1)
      for (const auto& name : cells) keep.push_back(std::find(columns.begin(), columns.end(), name) == columns.end());
    std::string text;
    bool first = true;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!keep[i]) continue;
      text += (first ? "" : ",") + cells[i];
      first = false;
    }
    return text;
  });
}

void place_scenario(const std::filesystem::path& toml) { write_text(toml, ascent_toml()); }

}  // namespace quadsonde::support
