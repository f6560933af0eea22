#pragma once
// A vehicle's drag from flights in an unknown wind, or a clear no with the flight to fly next.
// Source: design notes, section 5, "Free flight, no wind reference"; estimator/MODEL.md section 15.
#include <optional>
#include <string>
#include <vector>

#include "estimator/calibration/free_flight_fit.h"
#include "estimator/calibration/identifiability.h"
#include "estimator/calibration/referee.h"
#include "ingest/flight/flight.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::estimator {

struct FreeFlight {
  std::string name;                   ///< for messages: the log's file name
  ingest::Flight flight;              ///< tidy, and only what was measured in the air
  std::optional<double> air_density;  ///< [kg/m3]; empty: from the log's sensors, else the standard atmosphere
};

struct FreeFlightSettings {
  /// What is known beforehand: a class prior, or a vehicle file that is to be updated.
  ingest::Vehicle prior;
  std::optional<double> mass;  ///< as flown [kg]
  bool advise = true;          ///< simulate the manoeuvre that is advised
};

/// One flight and what it tells.
struct FreeFlightRun {
  std::string name;
  double seconds = 0, air_density = 0;
  bool standard_density = true;
  double excitation = 0;     ///< X of the slow motion [m/s]
  double heading_index = 0;  ///< 0: the nose never turned
  std::size_t windows = 0;   ///< sound ones
  bool used = false;
  std::string why_not;                  ///< one sentence without full stop, when not used
  std::optional<double> drag, drag_sd;  ///< of this flight alone at the airspeed of all, where several are used [1/s]
  double turbulence_sd = 0;             ///< [m/s]
};

/// What comes out if the attitude errs so.
struct AssumedNoise {
  TiltNoise noise;
  double drag = 0, drag_rel_sd = 0;  ///< c at the mean airspeed [1/s], and its formal sd
  double latency = 0, log_likelihood = 0;
  bool converged = false;
};

/// A number of the vehicle before and after.
struct Move {
  std::string what, unit;
  double before = 0, before_sd = 0, after = 0, after_sd = 0;
};

struct FreeFlightCalibration {
  ingest::Vehicle vehicle;             ///< method free-flight; where refused: the prior, untouched
  std::optional<std::string> refused;  ///< why there is no vehicle: a sentence without full stop
  std::vector<FreeFlightRun> runs;     ///< in the order given
  double excitation = 0;               ///< of the flights used, else of the best one [m/s]
  double airspeed = 0;                 ///< mean weighed by its square, at which c is judged [m/s]
  /// c at that airspeed [1/s] and the parts of its sd; also where it is only shown and not used.
  struct Seen {
    double drag = 0, rel_sd = 0, formal_rel_sd = 0, half_range = 0;
  };
  std::optional<Seen> seen;
  std::vector<AssumedNoise> assumed;
  std::optional<Referee> referee;
  bool quadratic = false;     ///< the flights themselves ask for kappa
  double quadratic_gain = 0;  ///< of the likelihood's exponent
  bool trim_determined = false, latency_determined = false;
  Identifiability identifiability;
  std::vector<Move> moves;  ///< where a vehicle file was updated
  std::vector<ingest::Problem> notes;
};

/// Fails with Kind::missing for a flight without attitude or velocity, Kind::usage without a flight. A set of flights
/// that cannot tell the drag is no failure: `refused` says why.
ingest::Result<FreeFlightCalibration> calibrate_free_flight(const std::vector<FreeFlight>& flights,
                                                            const FreeFlightSettings& settings);

}  // namespace quadsonde::estimator
