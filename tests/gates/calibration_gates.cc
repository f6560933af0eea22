// The calibrating rows of the gates of ESTIMATION.md section 10, each value beside its limit; exit 1 if one does not
// hold.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "estimator/calibration/free_flight.h"
#include "estimator/smoother/estimate.h"
#include "tests/gates/scenarios.h"
#include "tests/gates/scores.h"

namespace quadsonde::gates {
namespace {

int failures = 0;

void row(const std::string& what, double value, const char* relation, double limit) {
  const bool holds = relation[0] == '<' ? value <= limit : value >= limit;
  failures += !holds;
  fmt::print("{:<60} {:>8.4f} {:>2} {:<7g} {}\n", what, value, relation, limit, holds ? "ok" : "MISS");
  std::fflush(stdout);
}

ingest::Result<estimator::FreeFlightCalibration> calibrated(const ingest::Simulation& flown) {
  estimator::FreeFlightSettings settings;
  settings.prior = ingest::class_prior();
  settings.advise = false;
  std::vector<estimator::FreeFlight> flights;
  flights.push_back({"gate", flown.flight, 1.19});
  return estimator::calibrate_free_flight(flights, settings);
}

/// Drag and latency from the flight, then its wind with them.
void square_gates(int seeds, double latency) {
  double sum = 0, square = 0, worst = 0, late = 0, wind = 0, wind_10s = 0, inside = 0, answered = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto scenario = s4_square(latency);
    scenario.seed = static_cast<std::uint64_t>(seed);
    const auto flown = ingest::simulate(scenario);
    const auto found = calibrated(*flown);
    if (!found || found->refused) continue;
    const auto& v = found->vehicle;
    const double c = v.drag.linear + v.drag.quadratic * found->airspeed;
    const double error = std::log(c / scenario.vehicle.drag.linear);
    answered += 1, sum += error, square += error * error, worst = std::max(worst, std::abs(error));
    late += std::pow(v.latency_s - latency, 2);
    inside += std::abs(error) < 1.96 * found->seen->rel_sd;
    estimator::EstimateSettings settings;
    settings.heading_sd_deg = 0;
    settings.air_density_kg_m3 = 1.19;
    settings.takeoff = scenario.site.height;
    // The gates' law knows no climb term, and the noise of its tilt is white.
    auto vehicle = v;
    vehicle.drag.climb_linear = vehicle.drag.climb_quadratic = 0;
    const auto series = estimator::estimate_wind(flown->flight, vehicle, settings);
    if (!series) continue;
    const auto scored = score(*series, flown->truth, 0);
    wind += scored.rmse * scored.rmse, wind_10s += scored.rmse_10s * scored.rmse_10s;
  }
  const auto name = fmt::format("S4 latency {:g} s, {} seeds: ", latency, seeds);
  row(name + "answered", answered / seeds, ">=", 1);
  row(name + "drag rms", std::sqrt(square / answered), "<=", 0.03);
  row(name + "drag mean", std::abs(sum / answered), "<=", 0.02);
  row(name + "drag worst", worst, "<=", 0.06);
  row(name + "drag within its 95 %", inside / answered, ">=", 0.9);
  row(name + "latency rms, s", std::sqrt(late / answered), "<=", 0.01);
  row(name + "wind RMSE", std::sqrt(wind / answered), "<=", 0.18);
  if (latency == 0) row(name + "wind 10 s", std::sqrt(wind_10s / answered), "<=", 0.09);
}

void hover_gates(int seeds) {
  double refused = 0, farthest = 0;
  const auto prior = ingest::class_prior();
  for (int seed = 1; seed <= seeds; ++seed) {
    auto scenario = s2_hover();
    scenario.path[0].duration = 300;
    scenario.seed = static_cast<std::uint64_t>(seed);
    const auto found = calibrated(*ingest::simulate(scenario));
    refused += found && found->refused.has_value();
    if (found)
      farthest = std::max(
          farthest, std::abs(found->vehicle.parameter_sd(ingest::p_linear) - prior.parameter_sd(ingest::p_linear)));
  }
  row("hover calibration: refused", refused / seeds, ">=", 1);
  row("hover calibration: sd of the drag moved from its prior", farthest, "<=", 0);
}

}  // namespace
}  // namespace quadsonde::gates

int main(int argc, char** argv) {
  using namespace quadsonde::gates;
  const bool reduced = argc > 1 && std::strcmp(argv[1], "--reduced") == 0;
  const int seeds = reduced ? 6 : 30;
  square_gates(seeds, 0);
  square_gates(seeds, 0.2);
  hover_gates(seeds);
  fmt::print("{} gate{} missed\n", failures, failures == 1 ? "" : "s");
  return failures > 0;
}
