#pragma once
// One flight through every stage.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "export/csv/source.h"
#include "export/pipeline/compare.h"
#include "export/pipeline/load.h"
#include "export/report/autopilot_wind.h"
#include "export/report/words.h"
#include "export/station/station.h"
#include "ingest/motion/consistency.h"
#include "ingest/motion/vehicle.h"
#include "profiles/merge.h"
#include "profiles/section.h"

namespace quadsonde::product {

struct VehicleInUse {
  ingest::Vehicle vehicle;             ///< scaled to the mass flown
  std::string from;                    ///< for people: a file, or "class prior"
  std::string sha256;                  ///< of the file; empty for a class prior
  std::vector<ingest::Problem> notes;  ///< e.g. a class that was chosen, a mass far from the file's
};

/// `auto`: vehicle.toml beside the log, else a class prior: of the class that mass or rotors tell, else the name that
/// the log has for its vehicle, else generic. Fails with Kind::usage or Kind::unreadable.
/// @param logged  who flew, where the log has been read already
ingest::Result<VehicleInUse> choose_vehicle(const DragSettings& settings, const std::filesystem::path& log,
                                            const ingest::VehicleIdentity* logged = nullptr);

/// How flights that were merged agree.
struct MergeFacts {
  profiles::SpreadTest spread;
  double hours = 0, farthest_m = 0;
  std::size_t flights = 0;
};

/// What is known at the end about one flight, or about several that were merged.
struct FlightAnswer {
  FlightPart part;
  FlightTitle title;
  Station station;          ///< who observed; empty where no station file tells
  ProductSettings product;  ///< in which forms products are written
  ProductSource source;  ///< its problems: all that were met, each once
  std::optional<ingest::ConsistencyReport> check;  ///< empty where it was not asked for or nothing could be checked
  estimator::WindSeries series;
  std::optional<estimator::WindSeries> classic;  ///< the published filter on the same flight
  std::optional<profiles::WindProfile> profile;  ///< legs as asked for
  std::optional<ingest::Problem> no_profile;     ///< why there is none
  std::optional<Comparison> comparison;
  std::optional<AutopilotComparison> autopilot_wind = std::nullopt;  ///< kept beside, never fed back
  std::optional<MergeFacts> merged = std::nullopt;
  /// Legs over time and height: of a flight that climbs or descends more than once each, or of several flights.
  std::optional<profiles::Section> section = std::nullopt;
};

struct Wanted {
  bool profile = true;
  bool classic = false;
  const std::vector<ReferenceFile>* references = nullptr;  ///< null or empty: nothing to compare with
  ReferenceSettings reference;
};

/// Estimates one flight and, where wanted, bins it and compares it. Fails when no instant of it has a wind, or when
/// stopped; without a height there is an answer, and no_profile says so.
ingest::Result<FlightAnswer> analyse(const LoadedLog& log, const FlightPart& part, const VehicleInUse& vehicle,
                                     const PipelineSettings& settings, const Wanted& wanted,
                                     const Control& control = {});

/// Settings under their names, as products repeat them.
std::vector<NamedSetting> named_settings(const PipelineSettings& settings);

}  // namespace quadsonde::product
