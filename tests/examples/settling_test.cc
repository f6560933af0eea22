// How fast the filters follow the published indoor run: the stream's step from nothing to 3.8 m/s at 100 s.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimator/smoother/estimate.h"
#include "ingest/motion/scenario.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde {
namespace {

using estimator::Mode;

constexpr int seeds = 20;
constexpr double step_at = 100, step_ends = 200, speed = 3.8, within = 0.1 * speed;  // [s], [m/s]
constexpr double never = 1e9;
constexpr double slot = 0.1;  ///< the filters' step [s]

struct Settling {
  double mean = never;         ///< the mean of all runs stays within 10 % from then on [s after the step]
  double first_median = 0;     ///< of single runs: first within 10 % of the wind that blew
  double for_good_median = 0;  ///< and from then on within 20 %, gusts included, to the end of the step
};

std::string shown(double seconds) { return seconds >= never ? "never" : fmt::format("{:.1f} s", seconds); }

ingest::Scenario indoor_run(int seed) {
  auto scenario = ingest::read_scenario(std::string(QUADSONDE_EXAMPLES) + "/scenarios/indoor_run.toml").value();
  scenario.seed = static_cast<std::uint64_t>(seed);
  return scenario;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// The estimate's and the true wind toward south, by slots from the step on.
using Track = std::vector<std::pair<double, double>>;

Track track_of(const estimator::WindSeries& series, const ingest::Truth& truth, double until) {
  Track track;
  std::size_t at = 0;
  for (const auto& point : series.points) {
    const double t = ingest::to_seconds(point.time - truth.front().time);
    if (t < step_at || t >= until) continue;
    while (at + 1 < truth.size() && truth[at].time < point.time) ++at;
    const auto* wind = std::get_if<estimator::WindEstimate>(&point.wind);
    track.emplace_back(wind ? -wind->v_NA_N.x() : 0, -truth[at].v_NA_N.x());
  }
  return track;
}

double first_within(const Track& track, double share_of_speed) {
  for (std::size_t i = 0; i < track.size(); ++i)
    if (std::abs(track[i].first - track[i].second) <= share_of_speed * speed) return slot * static_cast<double>(i);
  return never;
}

double within_for_good(const Track& track, double share_of_speed) {
  std::size_t i = track.size();
  while (i > 0 && std::abs(track[i - 1].first - track[i - 1].second) <= share_of_speed * speed) --i;
  return i == track.size() ? never : slot * static_cast<double>(i);
}

Settling fly(Mode mode, bool with_trim, bool knows_everything, double until) {
  const auto vehicle = ingest::read_vehicle(std::string(QUADSONDE_EXAMPLES) + "/vehicles/published.toml").value();
  std::vector<double> sum, first, good;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto scenario = indoor_run(seed);
    if (!with_trim) scenario.sensors.trim_roll_deg = scenario.sensors.trim_pitch_deg = 0;
    const auto flown = ingest::simulate(scenario).value();
    estimator::EstimateSettings settings;
    settings.mode = mode;
    settings.air_density_kg_m3 = vehicle.air_density_kg_m3;
    if (knows_everything) settings.heading_sd_deg = 0, settings.turbulence_sd_m_s = scenario.wind.sigma_u;
    auto told = vehicle;
    if (knows_everything) told = flown.vehicle, told.latency_s = scenario.sensors.latency;
    const auto series = estimator::estimate_wind(flown.flight, told, settings).value();
    const auto track = track_of(series, flown.truth, until);
    sum.resize(std::max(sum.size(), track.size()));
    for (std::size_t i = 0; i < track.size(); ++i) sum[i] += track[i].first / seeds;
    first.push_back(first_within(track, 0.1));
    good.push_back(within_for_good(track, 0.2));
  }
  Settling s;
  std::size_t i = sum.size();
  while (i > 0 && std::abs(sum[i - 1] - speed) <= within) --i;
  if (i < sum.size()) s.mean = slot * static_cast<double>(i);
  s.first_median = median(first);
  s.for_good_median = median(good);
  return s;
}

Settling told(const char* what, Mode mode, bool with_trim = true, bool knows_everything = false,
              double until = step_ends) {
  const auto s = fly(mode, with_trim, knows_everything, until);
  fmt::print(
      "{:<24} mean of {} runs within 10 % for good after {}, single run first within 10 % after {} (median), "
      "within 20 % for good after {} (median)\n",
      what, seeds, shown(s.mean), shown(s.first_median), shown(s.for_good_median));
  return s;
}

// Design notes, section 10, S1: 2.5 s, where noise, turbulence and drag are known to the filter.
TEST(IndoorRun, IsFollowedWithinTwoAndAHalfSecondsWhereTheFilterKnowsItsNoise) {
  const auto ours = told("causal, noise known", Mode::causal, true, true);
  EXPECT_LE(ours.mean, 2.5);
  EXPECT_LE(ours.first_median, 2.5);
}

// With the vehicle's file it expects tilt errors that last 0.5 s, ten times the noise density of this flight's white
// ones, and is slower for it: outside of what the gate of section 10 supposes. Limit: the least the publication tells.
TEST(IndoorRun, IsFollowedFasterThanThePublicationTellsWithTheVehicleFileAlone) {
  EXPECT_LE(told("causal", Mode::causal).mean, 10);
}

// Until 195 s: before the small step at 200 s, which no jump test finds, the two-sided filter already leans toward it
// and leaves the 10 % in the last seconds.
TEST(IndoorRun, IsSmoothedToTheStepItself) { EXPECT_LE(told("smoothed", Mode::smoothed, true, false, 195).mean, 1); }

// The publication speaks of 10 to 20 s. With its constants at 10 Hz the four-state filter is slower: 64.5 s without
// trim, as section 10 has it.
TEST(IndoorRun, KeepsThePublishedFilterBusyForLongerThanThePublicationTells) {
  const auto classic = told("classic", Mode::classic);
  const auto without_trim = told("classic, no trim", Mode::classic, false);
  EXPECT_GT(classic.mean, 20);
  EXPECT_NEAR(without_trim.mean, 64.5, 5);
}

}  // namespace
}  // namespace quadsonde
