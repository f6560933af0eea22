// Computes the gates of ESTIMATION.md section 10 and prints each value beside its limit; exit 1 if one does not hold.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <vector>

#include "estimator/smoother/estimate.h"
#include "profiles/make_profile.h"
#include "tests/gates/scenarios.h"
#include "tests/gates/scores.h"

namespace quadsonde::gates {
namespace {

using estimator::EstimateSettings;
using estimator::Mode;

int failures = 0;

constexpr double never = 1e9;  // [s]
std::string shown(double value) { return value >= never ? "never" : fmt::format("{:.3f}", value); }

void row(const std::string& what, double value, const char* relation, double limit, double classic = NAN) {
  const bool upper = relation[0] == '<';
  const bool holds = upper ? value <= limit : value >= limit;
  failures += !holds;
  fmt::print("{:<52} {:>8} {:>2} {:<7g} {:<5}", what, shown(value), relation, limit, holds ? "ok" : "MISS");
  if (!std::isnan(classic)) fmt::print(" classic {}", shown(classic));
  fmt::print("\n");
  std::fflush(stdout);
}
void range(const std::string& what, double value, double low, double high) {
  const bool holds = value >= low && value <= high;
  failures += !holds;
  fmt::print("{:<52} {:>8.3f} in {:g} to {:g} {}\n", what, value, low, high, holds ? "ok" : "MISS");
  std::fflush(stdout);
}

/// The filter's word on a gate flight: what section 10 says is known to it.
EstimateSettings known_settings(Mode mode) {
  EstimateSettings s;
  s.mode = mode;
  s.heading_sd_deg = 0;
  s.air_density_kg_m3 = 1.19;
  return s;
}

struct Mean {
  Score smoothed, causal, classic;
  double bin_rmse = 0, bin_coverage = 0;
};

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
  for (const auto& leg : profile->legs) {
    if (leg.name == profiles::LegName::all) continue;
    for (const auto& bin : leg.bins) {
      const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind);
      if (!wind || bin.samples < 10) continue;
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      double n = 0;
      for (std::size_t i = 0; i < series.points.size() && i < flown.truth.size(); ++i) {
        const auto& p = series.points[i];
        const bool same_leg = (p.v_up > 0) == (leg.name == profiles::LegName::up);
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

Mean fly(const std::function<ingest::Scenario(int)>& scenario, int seeds, double latency_told,
         const std::function<void(EstimateSettings&, ingest::Vehicle&)>& adjust = {}) {
  Mean mean;
  double bin_square = 0, bin_inside = 0, bins = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto s = scenario(seed);
    s.seed = static_cast<std::uint64_t>(seed);
    const auto flown = ingest::simulate(s);
    auto vehicle = flown->vehicle;
    vehicle.latency_s = latency_told;
    for (const auto mode : {Mode::smoothed, Mode::causal, Mode::classic}) {
      auto settings = known_settings(mode);
      settings.takeoff = s.site.height;
      // The causal filter is judged with the turbulence known; the smoother finds its own.
      if (mode == Mode::causal) settings.turbulence_sd_m_s = s.wind.sigma_u;
      if (adjust) adjust(settings, vehicle);
      const auto series = estimator::estimate_wind(flown->flight, vehicle, settings);
      if (!series) {
        fmt::print("no answer: {}\n", series.error().what);
        continue;
      }
      auto& into = mode == Mode::smoothed ? mean.smoothed : mode == Mode::causal ? mean.causal : mean.classic;
      accumulate(into, score(*series, flown->truth, mode == Mode::smoothed ? 0 : 60), 1.0 / seeds);
      if (mode == Mode::smoothed) score_bins(*series, *flown, bin_square, bin_inside, bins);
    }
  }
  for (auto* s : {&mean.smoothed, &mean.causal, &mean.classic}) finish(*s);
  if (bins > 0) mean.bin_rmse = std::sqrt(bin_square / bins), mean.bin_coverage = bin_inside / bins;
  return mean;
}

// -- S1: the step

struct StepResult {
  std::vector<double> first_within;  // s after the step
  double mean_settles = NAN;         // the mean of the runs stays within 10 % from here on
  int detected = 0, false_jumps = 0;
  double hours_calm = 0;
};

StepResult fly_step(double sigma_u, int seeds, Mode mode) {
  StepResult out;
  std::vector<double> sum(1600, 0.0);
  for (int seed = 1; seed <= seeds; ++seed) {
    auto s = s1_step(sigma_u);
    s.seed = static_cast<std::uint64_t>(seed);
    const auto flown = ingest::simulate(s);
    auto settings = known_settings(mode);
    settings.turbulence_sd_m_s = sigma_u;
    const auto series = estimator::estimate_wind(flown->flight, flown->vehicle, settings);
    double first = NAN;
    for (std::size_t i = 0; i < series->points.size() && i < sum.size(); ++i) {
      const auto* wind = std::get_if<estimator::WindEstimate>(&series->points[i].wind);
      const double toward_south = wind ? -wind->v_NA_N.x() : 0;
      sum[i] += toward_south / seeds;
      const double t = 0.1 * static_cast<double>(i) - 100;
      // Against the wind that blew, turbulence included: with sigma_u .5 the truth itself leaves 3.8 +- 10 % for long.
      const double truth = i < flown->truth.size() ? -flown->truth[i].v_NA_N.x() : 3.8;
      if (std::isnan(first) && t >= 0 && std::abs(toward_south - truth) <= 0.38) first = t;
    }
    out.first_within.push_back(first);
    out.detected += series->diagnostics.jumps > 0;
    out.false_jumps += std::max(0, series->diagnostics.jumps - 1);
    out.hours_calm += 160.0 / 3600;
  }
  for (std::size_t i = sum.size(); i-- > 1000;) {
    if (std::abs(sum[i] - 3.8) > 0.38) break;
    out.mean_settles = 0.1 * static_cast<double>(i) - 100;
  }
  std::sort(out.first_within.begin(), out.first_within.end(), [](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a < b; });
  return out;
}

double quantile(const std::vector<double>& sorted, double q) {
  const double value = sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
  return std::isnan(value) ? never : value;
}

double settles(const StepResult& result) { return std::isnan(result.mean_settles) ? never : result.mean_settles; }

void step_gates(int seeds) {
  for (const double sigma_u : {0.1, 0.5}) {
    const auto ours = fly_step(sigma_u, seeds, Mode::causal);
    const auto classic = fly_step(sigma_u, seeds, Mode::classic);
    const auto name = fmt::format("S1 sigma_u {} ({} seeds): ", sigma_u, seeds);
    row(name + "mean settles, s", settles(ours), "<=", 2.5, settles(classic));
    row(name + "first, median, s", quantile(ours.first_within, 0.5), "<=", 2.5, quantile(classic.first_within, 0.5));
    row(name + "first, p90, s", quantile(ours.first_within, 0.9), "<=", 3.0, quantile(classic.first_within, 0.9));
    row(name + "false jumps per hour", ours.false_jumps / ours.hours_calm, "<=", 0.3);
    row(name + "detected", static_cast<double>(ours.detected) / seeds, ">=", 0.99);
  }
}

void hover_gates(int seeds) {
  const auto m = fly([](int) { return s2_hover(); }, seeds, 0);
  row("S2 smoothed RMSE", m.smoothed.rmse, "<=", 0.16, m.classic.rmse);
  row("S2 smoothed 10 s", m.smoothed.rmse_10s, "<=", 0.06, m.classic.rmse_10s);
  row("S2 flight mean", m.smoothed.mean_error, "<=", 0.02, m.classic.mean_error);
  row("S2 direction of 10 s means, deg", m.smoothed.direction, "<=", 1.0, m.classic.direction);
  row("S2 causal RMSE", m.causal.rmse, "<=", 0.26, m.classic.rmse);
  range("S2 coverage smoothed", m.smoothed.coverage, 0.93, 0.975);
  range("S2 coverage causal", m.causal.coverage, 0.93, 0.975);
}

void ascent_gates(int seeds, double rate) {
  const auto m = fly([&](int) { return s3_ascent(rate); }, seeds, 0);
  const bool fast = rate > 2;
  const auto name = fmt::format("S3 {} m/s ", rate);
  row(name + "RMSE", m.smoothed.rmse, "<=", fast ? 0.17 : 0.16, m.classic.rmse);
  row(name + "bin", m.bin_rmse, "<=", fast ? 0.13 : 0.06, m.classic.rmse_bin);
  row(name + "lag, m", std::abs(m.smoothed.lag), "<=", fast ? 1 : 0.5, m.classic.lag);
  row(name + "causal RMSE", m.causal.rmse, "<=", fast ? 0.31 : 0.28, m.classic.rmse);
  row(name + "causal lag, m", m.causal.lag, "<=", fast ? 10 : 4.5, m.classic.lag);
  range(name + "coverage smoothed", m.smoothed.coverage, 0.93, fast ? 0.985 : 0.975);
  if (!fast) range(name + "coverage causal", m.causal.coverage, 0.93, 0.975);
  range(name + "coverage of bins", m.bin_coverage, 0.93, 0.985);
}

void square_gates(int seeds) {
  const auto m = fly([](int) { return s4_square(0); }, seeds, 0);
  row("S4 latency 0: RMSE, drag and latency given", m.smoothed.rmse, "<=", 0.17, m.classic.rmse);
  row("S4 latency 0: 10 s", m.smoothed.rmse_10s, "<=", 0.09, m.classic.rmse_10s);
  range("S4 coverage smoothed", m.smoothed.coverage, 0.93, 0.975);
  range("S4 coverage causal", m.causal.coverage, 0.93, 0.975);
  const auto late = fly([](int) { return s4_square(0.2); }, seeds, 0.2);
  row("S4 latency .2 s known: RMSE", late.smoothed.rmse, "<=", 0.17, late.classic.rmse);
}

void law_gates(int seeds) {
  const auto fast = fly([](int) { return fast_hover(); }, seeds, 0);
  row("10 m/s, linear + quadratic: RMSE", fast.smoothed.rmse, "<=", 0.17, fast.classic.rmse);
  const auto trimmed = fly([](int) { return trimmed_hover(); }, seeds, 0);
  row("trim (2, -6) deg: RMSE", trimmed.smoothed.rmse, "<=", 0.17, trimmed.classic.rmse);
  range("trim (2, -6) deg: coverage", trimmed.smoothed.coverage, 0.93, 0.975);
  const auto fixed = fly([](int) { return fixed_heading(); }, seeds, 0, [](EstimateSettings&, ingest::Vehicle& v) {
    v.covariance.block<2, 2>(ingest::p_trim_roll, ingest::p_trim_roll) = Eigen::Matrix2d::Identity();
  });
  row("fixed heading, 1 deg: sd", fixed.smoothed.mean_sd, ">=", 0.6, fixed.classic.rmse);
  row("fixed heading, 1 deg: coverage", fixed.smoothed.coverage, ">=", 0.95);
}

}  // namespace
}  // namespace quadsonde::gates

int main(int argc, char** argv) {
  using namespace quadsonde::gates;
  const bool reduced = argc > 1 && std::strcmp(argv[1], "--reduced") == 0;
  const int seeds = reduced ? 6 : 30;
  step_gates(reduced ? 30 : 200);
  hover_gates(seeds);
  ascent_gates(seeds, 1);
  ascent_gates(seeds, 5);
  square_gates(seeds);
  law_gates(seeds);
  fmt::print("{} gate{} missed\n", failures, failures == 1 ? "" : "s");
  return failures > 0;
}
