#pragma once
// Inside the consistency check: undoes one fault after another and weighs what is left.
#include <memory>
#include <optional>
#include <vector>

#include "ingest/motion/consistency.h"
#include "ingest/motion/shooting.h"

namespace quadsonde::ingest {

class FaultSearch {
 public:
  /// @param velocity_confirmed  position and velocity agree, so a wrong scale is the tilt's
  FaultSearch(std::shared_ptr<const Telemetry> telemetry, std::vector<ShootingWindow> windows,
              const DragArguments& drag, const ConsistencySettings& settings, bool velocity_confirmed);

  struct Found {
    FaultCandidate candidate;
    double size = 0;
    std::vector<std::string> alternatives;
  };

  /// False if not even the log as named could be fitted.
  bool run();
  /// The fault whose undoing restores the flight; empty if none improves it.
  const std::optional<Found>& best() const { return best_; }
  /// Numbers of the flight, as named and restored.
  void fill(ConsistencyReport& report);
  /// Every typical fault committed on the restored flight.
  std::vector<ForetoldFault> foretold() const { return foretold_; }

 private:
  struct Tried {
    FaultCandidate candidate;
    double size = 0, extra = 0;  ///< extra: parameters that were fitted
    LogReading reading;
    ShootingFit fit;
    double badness() const { return fit.badness() + 6 * extra; }
  };
  void measure_noise();
  LogReading reading_of(const TelemetryMap& map, const Telemetry& base) const;
  std::optional<Tried> attempt(FaultCandidate candidate, double size, double extra);
  void try_all();
  void try_turned_or_scaled();
  void try_late();
  void try_missing_heading();
  void try_again();
  void pick(double enough);
  bool fit_within_noise();
  void settle_noise(const Tried& at);
  void foretell();
  void follow_axes(ConsistencyReport& report);
  void confirm(ConsistencyReport& report);

  std::shared_ptr<const Telemetry> telemetry_;
  DragArguments drag_;
  ConsistencySettings settings_;
  bool confirmed_;
  Shooting shooting_;
  NoiseLevels noise_;
  bool noise_known_ = false;
  std::optional<ShootingFit> named_;
  std::vector<Tried> tried_;
  std::optional<std::size_t> winner_;
  std::optional<Found> best_;
  std::vector<ForetoldFault> foretold_;
};

}  // namespace quadsonde::ingest
