#pragma once
// The whole job for one log: read, estimate, profile, compare, write the folder.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "export/pipeline/analyse.h"
#include "export/pipeline/outputs.h"

namespace quadsonde::product {

struct RunRequest {
  std::filesystem::path log;
  std::optional<std::filesystem::path> folder;    ///< none: nothing is written
  std::vector<std::filesystem::path> references;  ///< winds of others, whatever kind each is
  PipelineSettings settings;
  bool want_profile = true, want_classic = true;
  bool all_flights = true;  ///< what an empty choice of a flight means
  bool overwrite = false;
  ReferenceSettings reference;  ///< how the references are matched
};

struct FlightRun {
  FlightAnswer answer;
  std::filesystem::path folder;    ///< empty where nothing was written
  std::vector<std::string> files;  ///< names of the products in it
};

struct RunResult {
  std::vector<FlightRun> flights;         ///< those with an answer
  std::vector<ingest::Problem> failures;  ///< of flights without one
  std::vector<ingest::Problem> notes;     ///< on the choice of flights
  /// Something of the input was damaged, missing or doubtful, or a flight gave no answer.
  bool with_doubts() const;
};

/// Fails when no flight of the log has an answer, when an output is there already (unless overwrite) or cannot be
/// written, or when stopped. What is written appears whole; of an older run in the same folder nothing stays.
ingest::Result<RunResult> run_log(const RunRequest& request, const Control& control = {});

/// The folder's name of a flight: the stem of the log, with -N where the log has several.
std::string flight_folder_name(const std::filesystem::path& log, int flight, int flights);

/// All the products' names, in the order in which they are written.
const std::vector<std::string>& product_names();

/// Everything that is known of a flight's run, as JSON of schema quadsonde.run/1.
std::string run_json(const FlightAnswer& answer, const std::vector<std::string>& files);

}  // namespace quadsonde::product
