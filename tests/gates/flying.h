#pragma once
// Flying a gate's scenario over its seeds, and printing what came out beside its limit.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "estimator/smoother/estimate.h"
#include "ingest/motion/simulator.h"
#include "tests/gates/scores.h"

namespace quadsonde::gates {

using estimator::EstimateSettings;
using estimator::Mode;

constexpr double never = 1e9;  // [s]

/// Other filters on the same flights: the classic one and the tilt read as if the air were always in balance.
struct Beside {
  double classic = NAN, still = NAN;
};

/// One line: value, limit, whether it holds, and the other filters' values. What misses is counted.
void row(const std::string& what, double value, const char* relation, double limit, const Beside& beside = {});
void range(const std::string& what, double value, double low, double high);
/// A value without a limit: printed, never missed.
void told(const std::string& what, double value, const Beside& beside = {});
int missed();

/// The filter's word on a gate flight: what section 10 says is known to it.
EstimateSettings known_settings(Mode mode);

struct Mean {
  Score smoothed, causal, classic, still;
  double bin_rmse = 0, bin_coverage = 0;
  Beside rmse() const { return {classic.rmse, still.rmse}; }
  Beside rmse_10s() const { return {classic.rmse_10s, still.rmse_10s}; }
  Beside rmse_bin() const { return {classic.rmse_bin, still.rmse_bin}; }
};

using Adjust = std::function<void(int seed, EstimateSettings&, ingest::Vehicle&)>;

/// @param scenario  of a seed, which it is then given
/// @param latency_told  empty: what the simulation says of its vehicle
Mean fly(const std::function<ingest::Scenario(int)>& scenario, int seeds, std::optional<double> latency_told,
         const Adjust& adjust = {}, const std::vector<Mode>& modes = {Mode::smoothed, Mode::causal, Mode::classic});

/// The rigid body's drag by calibrate_tunnel: a run of one turn of 60 s at each speed [m/s].
ingest::Result<ingest::Vehicle> tunnel_vehicle(const std::vector<double>& speeds = {0, 2, 4, 6, 8});
/// A flight by the rigid body with heading error and trim drawn from the sds that the filter is given.
ingest::Scenario drawn_errors(ingest::Scenario scenario, int seed);
/// The tunnel's vehicle as the filter is told: its drag off by the spread between flights; the climb law the simulator's.
/// @param vehicle  as flown; overwritten
void told_to_filter(const ingest::Vehicle& tunnel, int seed, EstimateSettings& settings, ingest::Vehicle& vehicle);

// The groups of gates; fewer seeds in the reduced form.
void step_gates(int seeds);
void point_mass_gates(int seeds);
void law_gates(int seeds, bool reduced);
void climb_gates(int seeds, bool reduced);
void rigid_gates(int seeds);

}  // namespace quadsonde::gates
