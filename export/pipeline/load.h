#pragma once
// From a file to its flights in the air.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "export/pipeline/control.h"
#include "export/pipeline/heading.h"
#include "export/pipeline/height_drift.h"
#include "export/pipeline/settings.h"
#include "ingest/flight/flight.h"
#include "ingest/flight/segments.h"

namespace quadsonde::product {

/// One flight: an airborne part of what one boot of the autopilot logged.
struct FlightPart {
  int number = 1;                              ///< from 1, over the whole file
  std::shared_ptr<const ingest::Flight> boot;  ///< everything of that boot, tidy, heights shifted
  ingest::Segment segment;
  ingest::LogTime share_from, share_to;  ///< its share of the boot: up to half way to its neighbours
  std::optional<ingest::MslHeight> takeoff;
  std::optional<HeightDrift> drift;       ///< what airborne() takes off the heights
  std::vector<ingest::Problem> problems;  ///< of this boot and of this flight
  /// How heights above the sea were made, where the log has only such above the ellipsoid: from which stream, by which
  /// geoid.
  std::string made_heights;
  HeadingFacts heading;  ///< what was done to the headings of this boot

  double duration_s() const { return ingest::to_seconds(segment.to - segment.from); }
  /// Only what was measured in the air, a drift of the height taken off. Where the log has heights above the ellipsoid or of the local frame only, and
  /// take-off or landing was seen, the height above take-off is made of them.
  ingest::Flight airborne() const;
  /// With what stands before take-off and after landing: the take-off height can be found in it again.
  ingest::Flight whole() const { return ingest::cut(*boot, share_from, share_to); }
};

struct LoadedLog {
  std::filesystem::path path;
  std::string sha256;
  ingest::LogContent content;  ///< its flights moved into `boots`
  std::vector<std::shared_ptr<const ingest::Flight>> boots;
  std::vector<FlightPart> parts;           ///< may be empty
  std::optional<ingest::Problem> nothing;  ///< why there is no part
};

/// Reads a log of any known format and finds its flights. A log without a flight is no failure here: `nothing` tells
/// why. Fails as the readers do, and with Kind::usage for a map that cannot be read.
ingest::Result<LoadedLog> load_log(const std::filesystem::path& path, const InputSettings& settings,
                                   const Control& control = {});

/// The parts that were asked for. `choice` as in FlightChoice; by itself `all`, or the longest, which is then said in
/// `notes`. Fails with what `nothing` says, or Kind::usage for a number that is not there.
ingest::Result<std::vector<FlightPart>> choose_flights(const LoadedLog& log, const std::string& choice,
                                                       bool all_by_default, std::vector<ingest::Problem>& notes);

}  // namespace quadsonde::product
