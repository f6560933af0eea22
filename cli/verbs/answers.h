#pragma once
// What estimate, profile and run share.
#include <functional>
#include <string>
#include <vector>

#include "cli/verb.h"
#include "export/pipeline/render.h"
#include "export/pipeline/run_log.h"

namespace quadsonde::cli {

/// Everything met on the way to the answers of one log, to standard error.
void tell(Console& console, const product::RunResult& result);

/// X.csv, or X-N.csv where several flights were chosen.
std::filesystem::path numbered(const std::filesystem::path& path, int flight, bool several);

/// Texts to where the call asks: JSON (several as a list) into its output or, with --json, onto standard output;
/// else the texts for people, one after the other.
bool wants_json(const Call& call);
int give(const Call& call, const std::vector<std::string>& texts);

using Render = std::function<ingest::Result<std::string>(const product::FlightAnswer&, product::Format)>;
using Say = std::function<std::string(const product::FlightAnswer&)>;

/// Answers for each input, printed or written as the call asks.
struct AnswerVerb {
  product::PipelineSettings settings;
  std::vector<std::string> references;
  bool want_profile = true;
  bool merge = false;    ///< all flights to one profile
  bool section = false;  ///< the legs of all flights over time and height; goes before merge
  Render render;  ///< into a file, or JSON onto standard output
  Say say;        ///< for people

  int run(const Call& call);

 private:
  /// Whether the output is a folder in which files get the names that the campaign demands.
  bool tool_names(const std::filesystem::path& output) const;
  std::vector<product::FlightRun> collect(const Call& call, int& code);
  int write(const Call& call, const std::vector<product::FlightRun>& runs);
  /// The runs as one, merged or as a section; null where they cannot be, which is said.
  std::optional<product::FlightRun> merged(const Call& call, const std::vector<product::FlightRun>& runs) const;
  void print(const Call& call, const std::vector<product::FlightRun>& runs);
};

}  // namespace quadsonde::cli
