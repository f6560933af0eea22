#pragma once
// Whether runs can be believed, one by one and beside each other, before a common law is fitted.
#include <optional>
#include <vector>

#include "estimator/calibration/tunnel_fit.h"

namespace quadsonde::estimator {

/// What is stated, before any log is looked at: mass, speeds, directions, densities, enough runs.
std::optional<ingest::Problem> check_stated(const std::vector<TunnelRun>& runs, const TunnelSettings& settings);

/// A run by itself: streams, steadiness, length.
std::optional<ingest::Problem> check_steadiness(const TunnelRun& run, std::size_t steady, std::size_t seen,
                                                double median_speed);

/// Turn of the nose, whether pitch and roll tell of one wind, and the direction they tell.
/// @param notes  receives what is doubtful without being wrong
std::optional<ingest::Problem> check_sinusoids(const TunnelRunFit& run, const SinusoidFit& fit,
                                               const TunnelSettings& settings, std::vector<ingest::Problem>& notes);

/// The runs beside each other: whether one linear + quadratic law fits all stated winds.
/// @return a Problem if one run is far off (with the unit that would explain it)
/// @param spread  receives sqrt(chi2 / dof) where it is above what chance gives, else 1
std::optional<ingest::Problem> check_against_each_other(const std::vector<TunnelRunFit>& runs, double& spread,
                                                        std::vector<ingest::Problem>& notes);

/// The drag itself beside what multirotors have: the one sign of a wrong unit in every run.
void check_against_class(double c, double airspeed, std::vector<ingest::Problem>& notes);

/// A run's wind is nil: it tells the trim.
inline bool is_calm(double wind_speed) { return wind_speed < 0.1; }

}  // namespace quadsonde::estimator
