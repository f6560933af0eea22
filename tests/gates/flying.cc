#include "tests/gates/flying.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "estimator/smoother/passes.h"
#include "profiles/legs.h"
#include "profiles/make_profile.h"

namespace quadsonde::gates {
namespace {

int failures = 0;

std::string shown(double value) { return value >= never ? "never" : fmt::format("{:.3f}", value); }

void print_beside(const Beside& beside) {
  if (!std::isnan(beside.classic)) fmt::print(" classic {}", shown(beside.classic));
  if (!std::isnan(beside.still)) fmt::print(" static {}", shown(beside.still));
  fmt::print("\n");
  std::fflush(stdout);
}

/// The wind as if drag and tilt were in balance at every instant: w = v - s g / c, with the vehicle's drag.
estimator::WindSeries static_tilt(const estimator::WindSeries& series, const ingest::Vehicle& vehicle) {
  auto still = series;
  still.mode = Mode::classic;
  const auto& steps = series.trace->input;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Eigen::Vector2d pull = ingest::standard_gravity * steps[k].input.slope;
    // c depends on the airspeed that it makes: a few rounds settle it.
    double c = vehicle.drag.linear;
    for (int i = 0; i < 8; ++i) c = vehicle.drag.linear + vehicle.drag.quadratic * pull.norm() / c;
    if (steps[k].sound)
      still.points[k].wind = estimator::WindEstimate{steps[k].v - pull / c, Eigen::Matrix2d::Zero(), false};
    else
      still.points[k].wind = estimator::NoEstimate{};
  }
  return still;
}

void accumulate(Score& sum, const Score& s, double weight) {
  // Squares for what is an rms, plain means for the rest.
  sum.rmse += weight * s.rmse * s.rmse;
  sum.rmse_10s += weight * s.rmse_10s * s.rmse_10s;
  sum.rmse_bin += weight * s.rmse_bin * s.rmse_bin;
  sum.mean_error += weight * s.mean_error * s.mean_error / 2;
  sum.direction += weight * s.direction * s.direction;
  sum.lag += weight * s.lag;
  sum.coverage += weight * s.coverage;
  sum.mean_sd += weight * s.mean_sd;
}
void finish(Score& s) {
  for (double* v : {&s.rmse, &s.rmse_10s, &s.rmse_bin, &s.mean_error, &s.direction}) *v = std::sqrt(*v);
}

/// Error and coverage of the profile's own bins, legs up and down, against the truth's mean over the same samples.
void score_bins(const estimator::WindSeries& series, const ingest::Simulation& flown, double& square, double& inside,
                double& count) {
  const auto profile = profiles::make_profile(series);
  if (!profile) return;
  // Which samples are a leg's: a pause in a climb belongs to it.
  std::vector<std::optional<double>> heights;
  for (const auto& p : series.points) heights.push_back(p.height_agl ? std::optional(p.height_agl->m) : std::nullopt);
  const auto parts = profiles::find_parts(series.points, heights, profile->bin_m);
  for (const auto& leg : profile->legs) {
    if (leg.name == profiles::LegName::all) continue;
    for (const auto& bin : leg.bins) {
      const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind);
      if (!wind || bin.samples < 10) continue;
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      double n = 0;
      for (std::size_t i = 0; i < series.points.size() && i < flown.truth.size(); ++i) {
        const auto& p = series.points[i];
        const bool same_leg =
            parts[i] == (leg.name == profiles::LegName::up ? profiles::Part::up : profiles::Part::down);
        if (!same_leg || !p.height_agl || p.height_agl->m < bin.bottom || p.height_agl->m >= bin.top) continue;
        sum += flown.truth[i].v_NA_N.head<2>(), n += 1;
      }
      const Eigen::Vector2d e = wind->v_NA_N - sum / std::max(n, 1.0);
      square += e.squaredNorm() / 2;
      for (int k = 0; k < 2; ++k) inside += 0.5 * (std::abs(e(k)) <= 1.96 * std::sqrt(wind->covariance(k, k)));
      count += 1;
    }
  }
}

}  // namespace

void row(const std::string& what, double value, const char* relation, double limit, const Beside& beside) {
  const bool upper = relation[0] == '<';
  const bool holds = upper ? value <= limit : value >= limit;
  failures += !holds;
  fmt::print("{:<52} {:>8} {:>2} {:<7g} {:<5}", what, shown(value), relation, limit, holds ? "ok" : "MISS");
  print_beside(beside);
}
void range(const std::string& what, double value, double low, double high) {
  const bool holds = value >= low && value <= high;
  failures += !holds;
  fmt::print("{:<52} {:>8.3f} in {:g} to {:g} {}\n", what, value, low, high, holds ? "ok" : "MISS");
  std::fflush(stdout);
}
void told(const std::string& what, double value, const Beside& beside) {
  fmt::print("{:<52} {:>8}                 ", what, shown(value));
  print_beside(beside);
}
int missed() { return failures; }

EstimateSettings known_settings(Mode mode) {
  EstimateSettings s;
  s.mode = mode;
  s.heading_sd_deg = 0;
  s.air_density_kg_m3 = 1.19;
  return s;
}

Mean fly(const std::function<ingest::Scenario(int)>& scenario, int seeds, std::optional<double> latency_told,
         const Adjust& adjust, const std::vector<Mode>& modes) {
  Mean mean;
  double bin_square = 0, bin_inside = 0, bins = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto s = scenario(seed);
    s.seed = static_cast<std::uint64_t>(seed);
    const auto flown = ingest::simulate(s);
    for (const auto mode : modes) {
      auto vehicle = flown->vehicle;
      if (latency_told) vehicle.latency_s = *latency_told;
      auto settings = known_settings(mode);
      settings.takeoff = s.site.height;
      // The causal filter is judged with the turbulence known; the smoother finds its own.
      if (mode == Mode::causal) settings.turbulence_sd_m_s = s.wind.sigma_u;
      if (adjust) adjust(seed, settings, vehicle);
      const auto series = estimator::estimate_wind(flown->flight, vehicle, settings);
      if (!series) {
        fmt::print("no answer: {}\n", series.error().what);
        continue;
      }
      auto& into = mode == Mode::smoothed ? mean.smoothed : mode == Mode::causal ? mean.causal : mean.classic;
      accumulate(into, score(*series, flown->truth, mode == Mode::smoothed ? 0 : 60), 1.0 / seeds);
      if (mode != Mode::smoothed) continue;
      score_bins(*series, *flown, bin_square, bin_inside, bins);
      accumulate(mean.still, score(static_tilt(*series, vehicle), flown->truth, 60), 1.0 / seeds);
    }
  }
  for (auto* s : {&mean.smoothed, &mean.causal, &mean.classic, &mean.still}) finish(*s);
  // What did not fly has no error, rather than none.
  const auto flew = [&](Mode mode) { return std::find(modes.begin(), modes.end(), mode) != modes.end(); };
  const Score none{NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  if (!flew(Mode::classic)) mean.classic = none;
  if (!flew(Mode::smoothed)) mean.still = none;
  if (bins > 0) mean.bin_rmse = std::sqrt(bin_square / bins), mean.bin_coverage = bin_inside / bins;
  return mean;
}

}  // namespace quadsonde::gates
