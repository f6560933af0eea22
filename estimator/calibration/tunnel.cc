#include "estimator/calibration/tunnel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "estimator/calibration/tunnel_checks.h"
#include "estimator/calibration/tunnel_fit.h"
#include "estimator/calibration/tunnel_problem.h"
#include "estimator/calibration/tunnel_samples.h"

namespace quadsonde::estimator {
namespace {

using ingest::DragCovariance;
using ingest::fail;
using ingest::Kind;
using ingest::Problem;
using ingest::standard_gravity;

constexpr double degree = std::numbers::pi / 180;
// Of the prior: how far a quadratic term can be where runs do not tell.
constexpr double class_quadratic_sd = 0.004;

/// By a sensor made for it; empty if there is none.
std::optional<double> measured_density(const ingest::Flight& flight) {
  std::optional<double> pressure;
  for (const auto& b : flight.barometer.value)
    if (b.pressure_pa && !pressure) pressure = b.pressure_pa;
  for (const auto& air : flight.air.value) {
    const auto p = air.pressure_pa ? air.pressure_pa : pressure;
    if (air.temperature_k && p)
      return ingest::air_density(*p, *air.temperature_k, air.relative_humidity_pct.value_or(50));
  }
  return std::nullopt;
}

/// As stated, as measured, else of the standard atmosphere at the log's height, which is counted.
double density_of(const TunnelRun& run, int& assumed) {
  if (run.air_density) return *run.air_density;
  if (const auto measured = measured_density(run.flight)) return *measured;
  ++assumed;
  const auto& heights = run.flight.height_msl;
  return ingest::standard_air_density(heights.empty() ? 0 : heights.value[heights.size() / 2].m);
}

void note_assumed_density(int assumed, std::size_t runs, std::vector<Problem>& notes) {
  if (!assumed) return;
  notes.push_back({Kind::doubtful,
                   fmt::format("the air density of {} of {} runs is not known and taken from the standard atmosphere: "
                               "20 degrees of temperature are 3 % of drag",
                               assumed, runs),
                   {},
                   "give air_density_kg_m3 of each run"});
}

double stated_sd(const TunnelRun& run, const TunnelSettings& settings) {
  return std::max(run.wind_speed_sd.value_or(settings.wind_rel_sd * run.wind_speed), settings.wind_sd_floor);
}

double from_degrees(double chi) {
  const double d = std::fmod(chi / degree + 720, 360);
  return d == 0 ? 360 : d;
}

/// What one run shows by itself.
ingest::Result<TunnelRunFit> fit_run(const TunnelRun& run, const TunnelSettings& settings, int& assumed_densities,
                                     std::vector<Problem>& notes) {
  auto steady = steady_samples(run, settings);
  if (auto wrong = check_steadiness(run, steady.samples.size(), steady.seen, steady.median_speed)) return fail(*wrong);
  TunnelRunFit out;
  out.name = run.name;
  out.wind_speed = run.wind_speed, out.wind_speed_sd = stated_sd(run, settings), out.wind_from_deg = run.wind_from_deg;
  out.steady = steady.samples.size(), out.seen = steady.seen;
  out.turn_deg = turn_covered_deg(steady.samples);
  out.samples = std::move(steady.samples);
  // In calm air with a nose that does not turn only the trims can be told, and need no turn.
  const bool trims_only = is_calm(run.wind_speed) && out.turn_deg < settings.min_turn_deg;
  const auto fit = fit_sinusoids(out.samples, trims_only, settings.trim);
  const double chi_stated = run.wind_from_deg * degree;
  out.amplitude = fit.amplitude();
  const double chi = std::atan2(fit.parameters(1), fit.parameters(0));
  out.amplitude_sd = fit.along_sd(out.amplitude > 0 ? chi : chi_stated);
  out.fitted_from_deg = from_degrees(chi);
  const double across_sd = fit.along_sd(chi + std::numbers::pi / 2);
  out.fitted_from_sd_deg = out.amplitude > 0 ? std::min(180.0, across_sd / out.amplitude / degree) : 180;
  out.trim_pitch = fit.parameters(2), out.trim_roll = fit.parameters(3);
  out.residual_rms = fit.rms * standard_gravity;
  out.noise = fit.noise, out.inflation = fit.inflation;
  if (!is_calm(run.wind_speed)) {
    out.drag = standard_gravity * out.amplitude / run.wind_speed;
    out.drag_sd =
        *out.drag * std::hypot(out.wind_speed_sd / run.wind_speed, out.amplitude_sd / std::max(1e-6, out.amplitude));
  }
  if (auto wrong = check_sinusoids(out, fit, settings, notes)) return fail(*wrong);
  out.air_density = density_of(run, assumed_densities);
  return out;
}

/// The common fit's view of the runs. The law is referred to the mean density.
std::vector<ProblemRun> problem_runs(const std::vector<TunnelRunFit>& runs, double density, double density_exponent) {
  std::vector<ProblemRun> all;
  for (const auto& run : runs) {
    const auto unit =
        ingest::scaled(ingest::DragLaw<double>{1, 1, 0, 0}, run.air_density / density, 1.0, density_exponent);
    all.push_back({&run.samples, run.wind_speed, run.wind_speed_sd, run.wind_from_deg * degree, run.noise,
                   run.inflation, unit.linear, unit.quadratic});
  }
  return all;
}

CommonState first_state(const std::vector<TunnelRunFit>& runs) {
  CommonState state;
  for (const auto& run : runs) {
    state.wind.push_back(run.wind_speed);
    state.trim += Eigen::Vector2d(run.trim_pitch, run.trim_roll) / static_cast<double>(runs.size());
  }
  return state;
}

/// Starts spread evenly over the logarithm of linear (.05 to 2 1/s) and over quadratic (0 to 0.1 1/m).
CommonState start_number(const CommonState& first, int k, int count) {
  constexpr double golden = 0.6180339887498949;
  CommonState start = first;
  const double part = (k + 0.5) / count;
  start.linear = 0.05 * std::pow(40, part);
  start.quadratic = 0.1 * ((k + 0.5) * golden - std::floor((k + 0.5) * golden));
  return start;
}

CommonFit from_many_starts(const std::vector<ProblemRun>& runs, const TunnelSettings& settings,
                           const CommonState& first, TunnelCalibration& out) {
  CommonFit best;
  const int count = std::clamp(settings.starts, 1, 1000);
  for (int k = 0; k < count; ++k) {
    const CommonState start = start_number(first, k, count);
    const auto fit = solve_common(runs, settings.trim, true, start);
    out.ends.push_back({start.linear, start.quadratic, fit.state.linear, fit.state.quadratic, fit.cost, fit.iterations,
                        fit.converged});
    if (k == 0 || fit.cost < best.cost) best = fit, out.best_end = k;
  }
  for (const auto& end : out.ends) out.ends_at_best += end.cost <= best.cost * (1 + 1e-6) + 1e-6;
  if (out.ends_at_best * 2 <= count)
    out.notes.push_back(
        {Kind::doubtful,
         fmt::format("only {} of {} starts of the common fit came to the best end", out.ends_at_best, count),
         {},
         "look at the runs' pictures for one that does not fit"});
  return best;
}

/// Wind that a law wants for a run's tilt [m/s].
double predicted_wind(const ProblemRun& run, const CommonState& law, double gA) {
  const double linear = law.linear * run.linear_scale, quadratic = law.quadratic * run.quadratic_scale;
  if (quadratic < 1e-9) return linear > 0 ? gA / linear : 0;
  return (std::sqrt(linear * linear + 4 * quadratic * std::max(gA, 0.0)) - linear) / (2 * quadratic);
}

/// Runs of one stated speed belong together.
std::vector<std::vector<std::size_t>> speeds_of(const std::vector<TunnelRunFit>& runs) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (!is_calm(runs[i].wind_speed)) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return runs[a].wind_speed < runs[b].wind_speed; });
  std::vector<std::vector<std::size_t>> groups;
  for (const auto i : order) {
    const double first = groups.empty() ? 0 : runs[groups.back().front()].wind_speed;
    if (groups.empty() || runs[i].wind_speed > first + std::max(0.1, 0.02 * first)) groups.emplace_back();
    groups.back().push_back(i);
  }
  return groups;
}

/// Mean error of a left-out speed by the law of the others [m/s].
double left_out_error(const std::vector<TunnelRunFit>& fits, const std::vector<ProblemRun>& runs,
                      const std::vector<std::size_t>& left, const TunnelSettings& settings, bool quadratic,
                      const CommonState& start) {
  std::vector<ProblemRun> others;
  CommonState state = start;
  state.wind.clear();
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (std::find(left.begin(), left.end(), i) == left.end())
      others.push_back(runs[i]), state.wind.push_back(start.wind[i]);
  const auto fit = solve_common(others, settings.trim, quadratic, state);
  double sum = 0;
  for (const auto i : left)
    sum += predicted_wind(runs[i], fit.state, standard_gravity * fits[i].amplitude) - fits[i].wind_speed;
  return sum / static_cast<double>(left.size());
}

struct LeftOutSum {
  double squares = 0, weighted = 0;
  int count = 0;
  void add(double error, double sd) { squares += error * error, weighted += std::pow(error / sd, 2), ++count; }
  std::optional<double> rms() const { return count ? std::optional(std::sqrt(squares / count)) : std::nullopt; }
};

/// Each speed in turn left out. Errors are weighed by the stated sds: a wind good to 3 % errs more where it is strong.
void leave_each_speed_out(const std::vector<ProblemRun>& runs, const TunnelSettings& settings, const CommonFit& linear,
                          const CommonFit& quadratic, TunnelCalibration& out) {
  const auto groups = speeds_of(out.runs);
  LeftOutSum with_linear, with_quadratic;
  for (const auto& group : groups) {
    const auto& run = out.runs[group.front()];
    TunnelLeftOut left{run.wind_speed, run.wind_speed_sd, {}, {}};
    if (groups.size() >= 2) left.linear_error = left_out_error(out.runs, runs, group, settings, false, linear.state);
    if (groups.size() >= 3)
      left.quadratic_error = left_out_error(out.runs, runs, group, settings, true, quadratic.state);
    if (left.linear_error) with_linear.add(*left.linear_error, run.wind_speed_sd);
    if (left.quadratic_error) with_quadratic.add(*left.quadratic_error, run.wind_speed_sd);
    out.left_out.push_back(left);
  }
  out.linear_left_out_rms = with_linear.rms();
  out.quadratic_left_out_rms = with_quadratic.rms();
  if (settings.terms != DragTerms::by_left_out_error) {
    out.quadratic = settings.terms == DragTerms::linear_and_quadratic;
    out.why_terms = "as asked for";
  } else if (!out.quadratic_left_out_rms) {
    out.why_terms = fmt::format("{} wind speed{} cannot judge a quadratic term: three are needed", groups.size(),
                                groups.size() == 1 ? "" : "s");
  } else {
    out.quadratic = with_quadratic.weighted < with_linear.weighted;
    out.why_terms = fmt::format(
        "a speed left out is predicted to {:.2f} stated sds with both terms, {:.2f} with the linear one alone",
        std::sqrt(with_quadratic.weighted / with_quadratic.count), std::sqrt(with_linear.weighted / with_linear.count));
  }
}

/// "linear drag with quadratic drag": the largest parts of the weakest direction.
std::string weakest_words(const Eigen::VectorXd& direction) {
  static const char* const names[] = {"linear drag", "quadratic drag", "pitch trim", "roll trim", "flow direction"};
  std::vector<Eigen::Index> order{0, 1, 2, 3, 4};
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return std::abs(direction(a)) > std::abs(direction(b)); });
  std::string words = names[order[0]];
  for (std::size_t k = 1; k < order.size(); ++k)
    if (std::abs(direction(order[k])) > 0.3)
      words +=
          fmt::format("{}{}", direction(order[k]) * direction(order[0]) < 0 ? " against " : " with ", names[order[k]]);
  return words;
}

using Drag4 = Eigen::Matrix4d;  // linear, quadratic, theta0, phi0

/// The covariance of what is written, about the truth as linear + quadratic sees it: where the linear law is taken its
/// distance to the full one is part of the error, and the quadratic term stays as open as the runs leave it, or as the
/// class allows, whichever is less.
Drag4 covariance_of_choice(const Eigen::MatrixXd& full, const CommonState& chosen, const CommonState& quadratic_fit,
                           bool quadratic) {
  Drag4 C = full.topLeftCorner<4, 4>();
  if (quadratic) return C;
  const double prior = class_quadratic_sd * class_quadratic_sd;
  Eigen::Vector4d off;
  off << chosen.linear - quadratic_fit.linear, -quadratic_fit.quadratic, chosen.trim - quadratic_fit.trim;
  if (C(1, 1) > prior) {
    const Eigen::Vector4d with_quadratic = C.col(1) / C(1, 1);
    C += (prior - C(1, 1)) * with_quadratic * with_quadratic.transpose();
    return C;
  }
  return C + off * off.transpose();
}

/// The same where the runs say nothing of a quadratic term: it is free within the class, about the speed flown.
Drag4 covariance_of_linear(const Eigen::MatrixXd& linear, double speed) {
  Drag4 C = linear.topLeftCorner<4, 4>();
  const Eigen::Vector4d lever(-speed, 1, 0, 0);
  return C + class_quadratic_sd * class_quadratic_sd * lever * lever.transpose();
}

void set_drag(ingest::Vehicle& v, const CommonState& state, const Drag4& C) {
  const auto prior = ingest::class_prior();
  v.drag = {state.linear, state.quadratic, 0, 0};
  v.trim_pitch_deg = std::atan(state.trim(0)) / degree;
  v.trim_roll_deg = std::atan(state.trim(1)) / degree;
  v.latency_s = prior.latency_s;
  // File order and units: linear, quadratic, climb, climb, latency, roll [deg], pitch [deg].
  const int place[] = {ingest::p_linear, ingest::p_quadratic, ingest::p_trim_pitch, ingest::p_trim_roll};
  const double unit[] = {1, 1, 1 / degree / (1 + state.trim(0) * state.trim(0)),
                         1 / degree / (1 + state.trim(1) * state.trim(1))};
  v.covariance = DragCovariance::Zero();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) v.covariance(place[i], place[j]) = unit[i] * unit[j] * 0.5 * (C(i, j) + C(j, i));
  v.covariance(ingest::p_latency, ingest::p_latency) = prior.covariance(ingest::p_latency, ingest::p_latency);
  ingest::set_climb_prior(v);
}

void describe_vehicle(const std::vector<TunnelRun>& runs, const TunnelSettings& settings, double density,
                      TunnelCalibration& out) {
  auto& v = out.vehicle;
  v.name = v.id = runs.front().flight.vehicle.name;
  v.rotors = runs.front().flight.vehicle.rotors;
  v.mass_kg = settings.mass;
  v.air_density_kg_m3 = density;
  v.between_flights_rel_sd = 0.06;  // repeats of one vehicle moved by 7 to 15 %; design notes, section 12
  v.method = "tunnel";
  double low = 1e9, high = 0, squares = 0, samples = 0;
  for (const auto& run : out.runs) {
    low = std::min(low, std::max(0.0, run.wind_estimate)), high = std::max(high, run.wind_estimate);
    squares += run.residual_rms * run.residual_rms * static_cast<double>(run.steady),
        samples += static_cast<double>(run.steady);
  }
  v.airspeed_range_m_s = {low, high};
  v.residual_rms_m_s2 = std::sqrt(squares / samples);
  v.leave_one_out_m_s = out.quadratic ? out.quadratic_left_out_rms : out.linear_left_out_rms;
}

ingest::Result<void> fit_together(const TunnelSettings& settings, double density, TunnelCalibration& out) {
  const auto runs = problem_runs(out.runs, density, out.vehicle.density_exponent);
  const CommonState first = first_state(out.runs);
  const CommonFit quadratic = from_many_starts(runs, settings, first, out);
  const CommonFit linear = solve_common(runs, settings.trim, false, quadratic.state);
  leave_each_speed_out(runs, settings, linear, quadratic, out);
  const auto full = uncertainty_of(runs, settings.trim, quadratic.state);
  out.rank = full.rank, out.parameters = static_cast<int>(full.singular_values.size());
  out.singular_values.assign(full.singular_values.begin(), full.singular_values.end());
  out.weakest = weakest_words(full.weakest);
  if (!full.covariance)
    out.quadratic = false, out.why_terms = "the runs do not tell a quadratic term from the linear one";
  const CommonState& state = out.quadratic ? quadratic.state : linear.state;
  Eigen::MatrixXd C = full.covariance ? *full.covariance : Eigen::MatrixXd();
  if (!full.covariance) {
    const auto only_linear = uncertainty_of(runs, settings.trim, linear.state, false);
    if (!only_linear.covariance)
      return fail(Kind::no_answer, "the runs together do not determine the drag", {},
                  "add runs with a full turn of the nose in stronger wind");
    C = *only_linear.covariance;
  }
  if (state.linear + state.quadratic <= 0)
    return fail(Kind::no_answer, "no drag is left when all runs are fitted together", {},
                "look at each run for one that does not belong");
  const double widen = out.spread * out.spread;
  double speed = 0;
  for (const auto& run : runs) speed = std::max(speed, run.wind_speed);
  const Drag4 chosen = full.covariance ? covariance_of_choice(C * widen, state, quadratic.state, out.quadratic)
                                       : covariance_of_linear(C * widen, speed);
  set_drag(out.vehicle, state, chosen);
  out.flow_offset_deg = state.offset / degree;
  out.flow_offset_sd_deg = std::sqrt(C(4, 4)) / degree;
  for (std::size_t i = 0; i < out.runs.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(5 + i);
    out.runs[i].wind_estimate = state.wind[i], out.runs[i].wind_estimate_sd = std::sqrt(C(k, k));
  }
  return {};
}

}  // namespace

DragAt drag_at(const ingest::Vehicle& v, double airspeed) {
  const Eigen::Vector2d lever(1, airspeed);
  const auto C = v.covariance.topLeftCorner<2, 2>();
  return {v.drag.linear + v.drag.quadratic * airspeed, std::sqrt(std::max(0.0, lever.dot(C * lever)))};
}

ingest::Result<TunnelCalibration> calibrate_tunnel(const std::vector<TunnelRun>& runs, const TunnelSettings& settings) {
  if (auto wrong = check_stated(runs, settings)) return fail(*wrong);
  TunnelCalibration out;
  double density = 0;
  int assumed = 0;
  for (const auto& run : runs) {
    auto fit = fit_run(run, settings, assumed, out.notes);
    if (!fit) return fail(fit.error());
    density += fit->air_density / static_cast<double>(runs.size());
    out.runs.push_back(std::move(*fit));
  }
  note_assumed_density(assumed, runs.size(), out.notes);
  for (auto& run : out.runs)
    if (run.drag) {
      const double to_mean = std::pow(density / run.air_density, out.vehicle.density_exponent);
      *run.drag *= to_mean, *run.drag_sd *= to_mean;
    }
  if (auto wrong = check_against_each_other(out.runs, out.spread, out.notes)) return fail(*wrong);
  if (auto done = fit_together(settings, density, out); !done) return fail(done.error());
  describe_vehicle(runs, settings, density, out);
  const double middle = out.vehicle.airspeed_range_m_s.mean();
  check_against_class(drag_at(out.vehicle, middle).value, middle, out.notes);
  return out;
}

}  // namespace quadsonde::estimator
