#pragma once
// Is a log consistent with itself and with the equations of motion: the check of ingest/motion for one flight.
#include <string>
#include <vector>

#include "export/pipeline/analyse.h"
#include "export/pipeline/load.h"
#include "ingest/motion/consistency.h"
#include "ingest/motion/heading_offset.h"

namespace quadsonde::product {

struct CheckSettings {
  InputSettings input;
  FlightChoice flight;
  DragSettings drag;
  ingest::ConsistencySettings check;
};
template <class Visitor>
void describe(CheckSettings& s, Visitor&& visit) {
  describe(s.input, visit);
  describe(s.flight, visit);
  describe(s.drag, visit);
  ingest::describe(s.check, visit);
}

struct CheckAnswer {
  std::string file, sha256;
  int flight = 1;
  std::string vehicle_from;
  ingest::ConsistencyReport report;
  std::optional<ingest::HeadingOffset> heading;  ///< empty: too little motion, or it could not be fitted
  std::vector<ingest::Problem> problems;  ///< met on the way; the verdict is not among them
};

/// Fails with Kind::missing or Kind::no_answer where the flight has nothing to check, and when stopped.
ingest::Result<CheckAnswer> check(const LoadedLog& log, const FlightPart& part, const VehicleInUse& vehicle,
                                  const ingest::ConsistencySettings& settings, const Control& control = {});

/// A verdict as a Problem for other answers: Kind::inconsistent or Kind::doubtful; empty if consistent.
std::optional<ingest::Problem> verdict_problem(const ingest::ConsistencyReport& report, const std::string& file);

/// An offset that the flight determines, beyond its own sd and what a heading is taken to be off anyhow, as advice:
/// nothing is turned by itself. Empty otherwise.
std::optional<ingest::Problem> heading_problem(const std::optional<ingest::HeadingOffset>& heading,
                                               double heading_sd_deg, const InputSettings& input,
                                               const std::string& file);

/// For a terminal.
std::string check_text(const CheckAnswer& answer);
/// Object of schema quadsonde.check/1, as text.
std::string check_json(const CheckAnswer& answer);

}  // namespace quadsonde::product
