#pragma once
// What a set of flights determines, and which flight would determine more: in numbers and in words.
// Source: design notes, section 5, "Identifiability report", and section 8.
#include <string>
#include <vector>

#include "estimator/calibration/free_flight_fit.h"

namespace quadsonde::estimator {

enum class Manoeuvre { square_turning, hover_turning, reversals, two_speeds };
std::string words(Manoeuvre manoeuvre);  ///< "fly a square at 4 m/s ..., 5 min"

struct Advice {
  Manoeuvre manoeuvre = Manoeuvre::square_turning;
  std::string what;          ///< which number it is for: "the drag"
  std::string unit;          ///< "%", "deg", "s", "1/m"
  double now = 0, then = 0;  ///< sd of that number, now and with the manoeuvre flown too
  bool simulated = false;
};

struct Identifiability {
  std::vector<double> singular_values;  ///< of the whitened Jacobian, columns scaled by the prior's sds; falling
  int rank = 0;                         ///< of them above 1: the flights say more than the prior did
  double condition = 0;                 ///< largest over smallest
  std::string weakest;                  ///< the combination least determined, in words
  std::vector<std::string> determined;  ///< one line for each number: its sd and how far below the prior's that is
  std::vector<Advice> advice;           ///< may be empty
};

/// @param information  of the flights alone     @param prior_sd  of each parameter     @param found  for the simulation
/// @param drag_rel_sd  sd of ln c as it will be stated (it may be above the formal one)
Identifiability identify(const FitMatrix& information, const FitVector& prior_sd, double drag_rel_sd);

/// The manoeuvre that helps most, and a short flight of it simulated with the vehicle as found: point mass, turbulence
/// of 0.5 m/s, wind of 3 m/s.
Advice advise(const FitMatrix& information, const FitVector& prior_sd, const FitVector& at, const FitSettings& settings,
              const ingest::Vehicle& vehicle, bool drag_known, bool simulate);

}  // namespace quadsonde::estimator
