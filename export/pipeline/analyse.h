#pragma once
// One flight through every stage.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "export/csv/source.h"
#include "export/pipeline/compare_truth.h"
#include "export/pipeline/load.h"
#include "export/report/words.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::product {

struct VehicleInUse {
  ingest::Vehicle vehicle;             ///< scaled to the mass flown
  std::string from;                    ///< for people: a file, or "class prior"
  std::vector<ingest::Problem> notes;  ///< e.g. a mass that could not be used
};

/// `auto`: vehicle.toml beside the log, else the class prior. Fails with Kind::usage or Kind::unreadable.
ingest::Result<VehicleInUse> choose_vehicle(const DragSettings& settings, const std::filesystem::path& log);

/// What is known at the end about one flight.
struct FlightAnswer {
  FlightPart part;
  FlightTitle title;
  ProductSource source;  ///< its problems: all that were met, each once
  estimator::WindSeries series;
  std::optional<estimator::WindSeries> classic;  ///< the published filter on the same flight
  std::optional<profiles::WindProfile> profile;  ///< legs as asked for
  std::optional<ingest::Problem> no_profile;     ///< why there is none
  std::optional<TruthComparison> comparison;
};

struct Wanted {
  bool profile = true;
  bool classic = false;
  const ingest::Truth* truth = nullptr;
  std::string truth_file;
};

/// Estimates one flight and, where wanted, bins it and compares it. Fails when no instant of it has a wind, or when
/// stopped; without a height there is an answer, and no_profile says so.
ingest::Result<FlightAnswer> analyse(const LoadedLog& log, const FlightPart& part, const VehicleInUse& vehicle,
                                     const PipelineSettings& settings, const Wanted& wanted,
                                     const Control& control = {});

/// Settings under their names, as products repeat them.
std::vector<NamedSetting> named_settings(const PipelineSettings& settings);

}  // namespace quadsonde::product
