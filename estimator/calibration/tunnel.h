#pragma once
// A vehicle's drag from flights on the spot in a known wind: in front of a wind generator or in a tunnel.
// Source: design notes, section 5, "Wind generator or tunnel"; the sinusoids are derived in tunnel_fit.h.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::estimator {

/// One flight on the spot in one wind, the nose turning through at least three quarters of a circle.
struct TunnelRun {
  std::string name;                           ///< for messages and pictures: the log's file name
  ingest::Flight flight;                      ///< tidy, and only what was measured in the air
  double wind_speed = 0;                      ///< [m/s]; 0: a run in calm air, which tells the trim
  std::optional<double> wind_speed_sd;        ///< [m/s]; empty: TunnelSettings::wind_rel_sd of the speed
  double wind_from_deg = 0;                   ///< where it comes from, clockwise from the north of the log's headings
  std::optional<double> air_density;          ///< [kg/m3]; empty: from the log's sensors, else the standard atmosphere
  std::optional<ingest::LogTime> start, end;  ///< what to use of the flight
};

/// A trim known beforehand: what the log shows in a calm hover.
struct TunnelTrim {
  double roll_deg = 0, pitch_deg = 0, sd_deg = 0.3;
};

enum class DragTerms { by_left_out_error, linear, linear_and_quadratic };

struct TunnelSettings {
  double mass = 0;                   ///< of the vehicle as flown [kg]
  double wind_rel_sd = 0.03;         ///< of a stated wind speed without a stated sd
  double wind_sd_floor = 0.02;       ///< and at least this [m/s]: a calm room is not still
  double steady_speed = 0.3;         ///< samples moving faster than this do not count [m/s]
  double steady_acceleration = 0.3;  ///< [m/s2]
  double min_turn_deg = 270;         ///< with less turn of the nose wind and trim cannot be told apart
  int starts = 8;                    ///< of the common fit
  DragTerms terms = DragTerms::by_left_out_error;
  std::optional<TunnelTrim> trim;  ///< lets runs with less turn count
};

/// Attitude while standing still, means over 0.1 s.
struct TunnelSample {
  double seconds = 0;  ///< since the run's first sample
  double heading = 0;  ///< psi [rad], -pi < psi <= pi
  double pitch = 0;    ///< tan(theta)
  double roll = 0;     ///< tan(phi) / cos(theta)
};

/// One run by itself, and what the common fit says of it.
struct TunnelRunFit {
  std::string name;
  double wind_speed = 0, wind_speed_sd = 0, wind_from_deg = 0;  ///< as stated [m/s, deg]
  double air_density = 0;                                       ///< [kg/m3]
  double amplitude = 0, amplitude_sd = 0;                       ///< A of the sinusoids, c U / g
  double fitted_from_deg = 0, fitted_from_sd_deg = 180;         ///< chi, by the tilt alone
  double trim_pitch = 0, trim_roll = 0;                         ///< theta0 and phi0, as tangents
  double turn_deg = 0;                                          ///< of heading covered, in sectors of 10 degrees
  double residual_rms = 0;                                      ///< of the tilt, times g [m/s2]
  double noise = 0;                                             ///< robust sd of one tilt sample, as tangent
  double inflation = 1;                                         ///< samples in a row that are worth one
  std::size_t steady = 0, seen = 0;                             ///< samples used, and all
  double wind_estimate = 0, wind_estimate_sd = 0;               ///< of the common fit [m/s]
  /// g A / U: the drag coefficient [1/s] that this run alone shows, and its sd with that of U; brought to the vehicle's
  /// air density by its exponent; empty when calm.
  std::optional<double> drag, drag_sd;
  std::vector<TunnelSample> samples;  ///< those used, in time order
};

/// Where one start of the common fit ended.
struct TunnelEnd {
  double start_linear = 0, start_quadratic = 0;
  double linear = 0, quadratic = 0;
  double cost = 0;
  int iterations = 0;
  bool converged = false;
};

/// A wind speed left out, and predicted from its tilt by the drag of all the others.
struct TunnelLeftOut {
  double wind_speed = 0, wind_speed_sd = 0;             ///< as stated [m/s]
  std::optional<double> linear_error, quadratic_error;  ///< predicted minus stated [m/s]; empty: others do not suffice
};

struct TunnelCalibration {
  ingest::Vehicle vehicle;             ///< method "tunnel"; logs, creation time and version are the caller's
  std::vector<TunnelRunFit> runs;      ///< in the order given
  std::vector<TunnelEnd> ends;         ///< of linear + quadratic, one per start, in order
  int best_end = 0, ends_at_best = 0;  ///< how many starts came to the best end
  bool quadratic = false;              ///< the vehicle has both terms
  std::string why_terms;               ///< one sentence
  double flow_offset_deg = 0, flow_offset_sd_deg = 0;  ///< of all stated directions in common
  int rank = 0, parameters = 0;                        ///< of the whitened Jacobian of linear + quadratic
  std::vector<double> singular_values;                 ///< its, columns scaled by prior sds, falling
  std::string weakest;                  ///< the combination of drag, trims and direction that is least known, in words
  std::vector<TunnelLeftOut> left_out;  ///< by speed
  std::optional<double> linear_left_out_rms, quadratic_left_out_rms;  ///< [m/s]
  double spread = 1;  ///< of the runs about the law, over their stated sds; above 1 it widens the vehicle's
  std::vector<ingest::Problem> notes;  ///< what is doubtful about it
};

/// The drag law of a vehicle from runs at two or more wind speeds.
/// The vehicle's covariance holds all that its c(|a|) may err by: where the linear law is taken, also the quadratic
/// term that the runs do not exclude. Climb law and latency stay at the class prior.
/// @return no answer but Kind::usage for a mass or a wind that cannot be; missing, without attitude or velocity;
///         no_answer, if the runs are too few, too short or turn too little; inconsistent, if a run moves, contradicts
///         the stated direction or the other runs (a wrong unit, named). Every one names its run and the next step.
ingest::Result<TunnelCalibration> calibrate_tunnel(const std::vector<TunnelRun>& runs, const TunnelSettings& settings);

/// c [1/s] of level flight at an airspeed [m/s], with the sd that the vehicle's covariance gives it
/// (without between_flights_rel_sd).
struct DragAt {
  double value = 0, sd = 0;
};
DragAt drag_at(const ingest::Vehicle& vehicle, double airspeed);

}  // namespace quadsonde::estimator
