#pragma once
// One verb of the command line: what it takes, what it is called with, what it does.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/options.h"
#include "export/pipeline/control.h"
#include "export/pipeline/settings.h"

namespace quadsonde::cli {

/// Exit codes of design/CLI.md.
inline constexpr int complete = 0, no_answer = 1, wrong_usage = 2, with_doubts = 3, interrupted = 130;
inline int exit_code(const ingest::Problem& problem) {
  return problem.kind == ingest::Kind::usage ? wrong_usage : no_answer;
}

/// What every verb takes.
struct CommonSettings {
  std::string output;
  bool json = false, force = false, quiet = false;
  std::string settings;
};
void describe(CommonSettings& s, Options& options);

struct Call {
  std::vector<std::filesystem::path> inputs;
  CommonSettings common;
  Console& console;
  const product::Control& control;

  std::optional<std::filesystem::path> output() const {
    if (common.output.empty()) return std::nullopt;
    return common.output;
  }
};

class Verb {
 public:
  virtual ~Verb() = default;
  virtual std::string name() const = 0;
  virtual std::string usage() const = 0;    ///< "LOG... -o DIR"
  virtual std::string summary() const = 0;  ///< one line
  virtual std::size_t most_inputs() const { return SIZE_MAX; }
  /// Shows its settings to the options, which write into them.
  virtual void describe(Options& options) = 0;
  /// @return an exit code
  virtual int run(const Call& call) = 0;
};

/// All verbs, in the order of the help. A new verb: a file in cli/verbs, its maker here.
std::vector<std::unique_ptr<Verb>> all_verbs();
std::unique_ptr<Verb> make_run_verb();
std::unique_ptr<Verb> make_info_verb();
std::unique_ptr<Verb> make_convert_verb();
std::unique_ptr<Verb> make_check_verb();
std::unique_ptr<Verb> make_compare_verb();
std::unique_ptr<Verb> make_estimate_verb();
std::unique_ptr<Verb> make_profile_verb();
std::unique_ptr<Verb> make_simulate_verb();
std::unique_ptr<Verb> make_calibrate_verb();
std::unique_ptr<Verb> make_validate_verb();
/// Verbs of two words: "archive add", "archive list", ...
std::vector<std::unique_ptr<Verb>> make_archive_verbs();

/// The program: parses, calls one verb, returns its exit code. No exception leaves it.
int run_program(int argc, char** argv);

}  // namespace quadsonde::cli
