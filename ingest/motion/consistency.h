#pragma once
// Is a log's telemetry consistent with itself and with the equations of motion, and if not, what is wrong with it?
// Source: design notes, section 6. The estimator is not known here: drag, trim and latency are arguments.
#include <optional>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/motion/faults.h"
#include "ingest/motion/noise_levels.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::ingest {

enum class Verdict { consistent, doubtful, inconsistent, cannot_be_shown };
/// "consistent", "doubtful", "inconsistent", "cannot be shown"
std::string name(Verdict verdict);

/// The vehicle as the check is told of it. Drag factor and trim are fitted to each flight within their sd, so that
/// the defaults, those of a vehicle nobody measured, amount to least squares per flight.
struct DragArguments {
  DragLaw<double> drag{0.20, 0, 0, 0};
  double drag_log_sd = 0.35;  ///< of one factor on the law
  double latency_s = 0;       ///< already known and not to be found fault with
  double trim_roll_deg = 0, trim_pitch_deg = 0;
  double trim_sd_deg = 3;
  std::optional<double> turbulence_sd;  ///< m/s; left out: the likeliest
};

/// What a vehicle file tells. The latency of a class prior is a guess, which the check does not take off.
DragArguments drag_arguments(const Vehicle& vehicle);

struct ConsistencySettings {
  double window_s = 20;
  double most_windows = 60;       ///< beyond, every so many-th
  double confirmed_windows = 20;  ///< at most so many are integrated
  double vertical_gust = 0.25, vertical_gust_time = 5;
};
template <class Visitor>
void describe(ConsistencySettings& s, Visitor&& visit) {
  visit("check_window_s", s.window_s, 10.0, 60.0, "Length of the windows over which the motion is integrated.");
  visit("check_most_windows", s.most_windows, 5.0, 10000.0, "Longer flights are sampled by so many windows.");
  visit("check_confirmed_windows", s.confirmed_windows, 1.0, 10000.0,
        "So many windows confirm the winner by integration.");
}

struct Finding {
  FaultClass fault = FaultClass::unexplained;
  std::string id;
  std::string sentence;
  std::vector<std::string> causes;        ///< usual ones of its class
  std::vector<std::string> alternatives;  ///< faults that this flight cannot tell from it
  double size = 0;                        ///< degrees, seconds or a factor, as the sentence says
  double improvement = 0;  ///< chi2 as named over chi2 with the fault undone; 0 where it is not found by shooting
  bool decides = false;    ///< it makes the log inconsistent
};

/// A fault and what it would do to this flight's chi2.
struct ForetoldFault {
  std::string id, sentence;
  double ratio = 0;
  bool shown() const { return ratio >= 1.2; }
};

/// Correlation of the thrust's horizontal pull with the acceleration, both smoothed over a second.
struct FollowedAxis {
  std::string axis;             ///< "north", "east", "forward", "right"
  double acceleration_rms = 0;  ///< [m/s2]; below 0.2 the rest says little
  double correlation = 0, correlation_exchanged = 0;
  double gain = 0, gain_sd = 0;  ///< of the tilt in the motion; 1 = as the equations say
};

struct ConsistencyReport {
  Verdict verdict = Verdict::cannot_be_shown;
  std::string because;       ///< one sentence
  double chi2_per_dof = 0;   ///< of the log as named
  double chi2_restored = 0;  ///< with the named fault undone; the same if there is none
  std::optional<double> chi2_integrated, chi2_restored_integrated;  ///< by CVODES; empty if it gave up
  bool noise_is_known = false;                                      ///< else only the ratio of the two says something
  NoiseLevels noise;
  std::vector<double> windows;   ///< chi2 per degree of freedom of each, as named
  double drag_linear_per_s = 0;  ///< fitted, with the fault undone
  double trim_roll_deg = 0, trim_pitch_deg = 0;
  std::vector<FollowedAxis> axes;
  std::vector<Finding> findings;        ///< those that decide first
  std::vector<ForetoldFault> foretold;  ///< every fault that was tried on this flight
  std::vector<std::string> cannot_show;
};

/// @param flight  the airborne part
/// Fails with Kind::missing (no attitude or velocity) or Kind::no_answer (not one window without a hole).
Result<ConsistencyReport> check_consistency(const Flight& flight, const DragArguments& drag = {},
                                            const ConsistencySettings& settings = {});

/// The report as plain text for people, a few dozen lines.
std::string to_text(const ConsistencyReport& report);

}  // namespace quadsonde::ingest
