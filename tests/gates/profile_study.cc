// Profiles of simulated flights by the rigid body, against the wind that blew: winds of 1 to 12 m/s, climbs of .5 to
// 5 m/s, three levels of turbulence. Bins against the truth over the same samples, optimal estimation against the mean
// wind of the scenario. Prints; nothing here has a limit but the coverage of all bins together (.92 to .98).
#include <fmt/format.h>

#include <cstdlib>
#include <map>

#include "profiles/legs.h"
#include "profiles/make_profile.h"
#include "tests/gates/flying.h"
#include "tests/gates/scenarios.h"

namespace quadsonde::gates {
namespace {

using profiles::LegName;

struct Tally {
  double square = 0, inside = 0, bias = 0, n = 0;
  void add(const Eigen::Vector2d& error, const Eigen::Matrix2d& C, const Eigen::Vector2d& truth) {
    square += error.squaredNorm() / 2;
    for (int k = 0; k < 2; ++k) inside += 0.5 * (std::abs(error(k)) <= 1.96 * std::sqrt(C(k, k)));
    if (truth.norm() > 0.1) bias += error.dot(truth.normalized());
    n += 1;
  }
  void print(const std::string& what) const {
    if (n == 0) return;
    fmt::print("{:<44} {:5.0f} bins  RMSE {:.3f}  speed bias {:+.3f}  coverage {:.3f}\n", what, n,
               std::sqrt(square / n), bias / n, inside / n);
  }
};

/// Flight number i of the study: every wind with every climb and turbulence in turn.
ingest::Scenario flight(int i) {
  constexpr double speeds[] = {1, 3, 6, 9, 12}, climbs[] = {0.5, 1, 2, 3, 5}, turbulence[] = {0.2, 0.5, 1.0};
  auto s = s3_ascent(climbs[(i / 5) % 5]);
  s.wind.model = ingest::WindField::Model::power_law;
  const double speed = speeds[i % 5], toward = 0.7 * i;
  s.wind.toward = speed * Eigen::Vector2d(std::cos(toward), std::sin(toward));
  s.wind.reference_height = 60;
  s.wind.veer_deg_per_m = 0.1;
  s.wind.sigma_u = turbulence[i % 3];
  s.path[0].to_height = 120;
  s.seed = static_cast<std::uint64_t>(i) + 1;
  return s;
}

std::map<std::pair<LegName, int>, Eigen::Vector2d> truth_by_bin(const estimator::WindSeries& series,
                                                                const ingest::Truth& truth, double bin_m) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : series.points) heights.push_back(p.height_agl ? std::optional(p.height_agl->m) : std::nullopt);
  const auto parts = profiles::find_parts(series.points, heights, bin_m);
  std::map<std::pair<LegName, int>, std::pair<Eigen::Vector2d, double>> sums;
  for (std::size_t i = 0; i < series.points.size() && i < truth.size(); ++i) {
    if (!heights[i] || parts[i] == profiles::Part::level) continue;
    if (!std::holds_alternative<estimator::WindEstimate>(series.points[i].wind)) continue;
    auto& [sum, n] = sums.try_emplace({parts[i] == profiles::Part::up ? LegName::up : LegName::down,
                                       static_cast<int>(std::floor(*heights[i] / bin_m))},
                                      Eigen::Vector2d::Zero(), 0.0).first->second;
    sum += truth[i].v_NA_N.head<2>(), n += 1;
  }
  std::map<std::pair<LegName, int>, Eigen::Vector2d> means;
  for (const auto& [key, value] : sums) means[key] = value.first / value.second;
  return means;
}

struct Study {
  std::map<std::string, Tally> classes;
  Tally all, optimal, bins_as_mean;
  Score lag;
  int flights = 0;

  void judge(const ingest::Scenario& s, const ingest::Simulation& flown, const estimator::WindSeries& series) {
    const auto profile = profiles::make_profile(series);
    if (!profile) return;
    ++flights;
    lag.lag += score(series, flown.truth, 0).lag;
    const auto truth = truth_by_bin(series, flown.truth, profile->bin_m);
    for (const auto& leg : profile->legs)
      for (const auto& bin : leg.bins) {
        const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind);
        if (!wind || bin.samples < 10) continue;
        const Eigen::Vector2d mean = s.wind.mean((bin.bottom + bin.top) / 2, 0);
        if (leg.name == LegName::all) {
          const double sampling = bin.sd_sampling.value_or(0);
          bins_as_mean.add(wind->v_NA_N - mean, wind->covariance + sampling * sampling * Eigen::Matrix2d::Identity(), mean);
          continue;
        }
        const auto found = truth.find({leg.name, static_cast<int>(std::lround(bin.bottom / profile->bin_m))});
        if (found == truth.end()) continue;
        const Eigen::Vector2d error = wind->v_NA_N - found->second;
        const auto name = std::string(profiles::name(leg.name));
        for (const auto& key : {fmt::format("wind {:4.0f} m/s, {}", s.wind.toward.norm(), name),
                                fmt::format("climb {:3.1f} m/s, {}", s.path[0].speed, name),
                                fmt::format("turbulence {:3.1f} m/s, {}", s.wind.sigma_u, name)})
          classes[key].add(error, wind->covariance, found->second);
        all.add(error, wind->covariance, found->second);
      }
    profiles::ProfileSettings optimal_settings;
    optimal_settings.method = profiles::Method::optimal;
    const auto nodes = profiles::make_profile(series, optimal_settings);
    if (!nodes) return;
    for (const auto& bin : nodes->legs[0].bins) {
      const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind);
      const Eigen::Vector2d mean = s.wind.mean((bin.bottom + bin.top) / 2, 0);
      if (wind) optimal.add(wind->v_NA_N - mean, wind->covariance, mean);
    }
  }

  void print() const {
    for (const auto& [name, tally] : classes) tally.print(name);
    bins_as_mean.print("all legs, bins against the mean wind");
    optimal.print("optimal estimation against the mean wind");
    fmt::print("{:<44} {:+.2f} m\n", "height lag, mean over the flights", lag.lag / std::max(1, flights));
    all.print(fmt::format("{} flights, legs, all bins", flights));
  }
};

}  // namespace
}  // namespace quadsonde::gates

int main(int argc, char** argv) {
  using namespace quadsonde;
  const int flights = argc > 1 ? std::max(1, std::atoi(argv[1])) : 100;
  const auto tunnel = gates::tunnel_vehicle();
  if (!tunnel) {
    fmt::print("no vehicle from the tunnel: {}\n", tunnel.error().what);
    return 1;
  }
  gates::Study study;
  for (int i = 0; i < flights; ++i) {
    const auto s = gates::drawn_errors(gates::flight(i), i + 1);
    const auto flown = ingest::simulate(s);
    if (!flown) continue;
    auto vehicle = flown->vehicle;
    auto settings = gates::known_settings(estimator::Mode::smoothed);
    settings.takeoff = s.site.height;
    gates::told_to_filter(*tunnel, i + 1, settings, vehicle);
    const auto series = estimator::estimate_wind(flown->flight, vehicle, settings);
    if (series) study.judge(s, *flown, *series);
  }
  study.print();
  const double coverage = study.all.inside / std::max(1.0, study.all.n);
  return coverage >= 0.92 && coverage <= 0.98 ? 0 : 1;
}
