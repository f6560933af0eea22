#include "estimator/calibration/tunnel_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::estimator {
namespace {

using ingest::Kind;
using ingest::Problem;

constexpr double degree = std::numbers::pi / 180;

Problem problem(Kind kind, const std::string& run, std::string what, std::string hint) {
  return {kind, std::move(what), {run, {}, {}, {}}, std::move(hint)};
}

bool positive(double x) { return std::isfinite(x) && x > 0; }

std::optional<Problem> check_stated_run(const TunnelRun& run) {
  if (!std::isfinite(run.wind_speed) || run.wind_speed < 0 || run.wind_speed > 60)
    return problem(Kind::usage, run.name, fmt::format("a wind speed of {} m/s cannot be", run.wind_speed),
                   "give wind_speed_m_s from 0 to 60, in metres per second");
  if (!std::isfinite(run.wind_from_deg) || std::abs(run.wind_from_deg) > 360)
    return problem(Kind::usage, run.name, fmt::format("a wind direction of {} degrees cannot be", run.wind_from_deg),
                   "give wind_from_deg, where the wind comes from, from 0 to 360");
  if (run.wind_speed_sd && !positive(*run.wind_speed_sd))
    return problem(Kind::usage, run.name, fmt::format("a wind speed sd of {} m/s cannot be", *run.wind_speed_sd),
                   "give what the anemometer or the generator is good for, or leave it out");
  if (run.air_density && !(*run.air_density > 0.3 && *run.air_density < 2))
    return problem(Kind::usage, run.name, fmt::format("an air density of {} kg/m3 cannot be", *run.air_density),
                   "give air_density_kg_m3, about 1.2 near the ground, or leave it out");
  if (run.start && run.end && *run.end <= *run.start)
    return problem(Kind::usage, run.name, "the run ends before it starts",
                   "correct start_s and end_s: times of the log's clock");
  return std::nullopt;
}

struct Unit {
  const char* name;
  double in_m_s;
};
constexpr std::array units{Unit{"km/h", 1 / 3.6}, Unit{"knots", 0.514444}, Unit{"mph", 0.44704}, Unit{"ft/s", 0.3048}};

/// "knots instead of m/s": the units whose factor, or its inverse, a ratio is within a tolerance, nearest first; empty
/// if none is.
std::string units_of(double needed_over_stated, double tolerance) {
  std::vector<std::pair<double, std::string>> fitting;
  for (const auto& unit : units) {
    const double as_stated = std::abs(std::log(needed_over_stated / unit.in_m_s));
    const double inverse = std::abs(std::log(needed_over_stated * unit.in_m_s));
    if (as_stated < std::log(tolerance)) fitting.emplace_back(as_stated, fmt::format("{} instead of m/s", unit.name));
    if (inverse < std::log(tolerance))
      fitting.emplace_back(inverse, fmt::format("{} converted the wrong way round", unit.name));
  }
  std::sort(fitting.begin(), fitting.end());
  std::string words;
  for (const auto& [distance, name] : fitting) words += (words.empty() ? "" : ", or ") + name;
  return words;
}

/// linear and quadratic >= 0 by least squares of g A / U = linear + quadratic U, all of one relative weight.
struct Line {
  double linear = 0, quadratic = 0, chi2 = 0;
  double at(double U) const { return linear + quadratic * U; }
};

struct Reading {
  std::size_t run;
  double U, c, rel_sd;
};

double chi2_of(const std::vector<Reading>& all, const Line& line, double scale) {
  double sum = 0;
  for (const auto& r : all) sum += std::pow((r.c - line.at(r.U)) / (r.rel_sd * scale), 2);
  return sum;
}

Line fit_line(const std::vector<Reading>& all, double scale) {
  double w = 0, wu = 0, wuu = 0, wc = 0, wuc = 0;
  for (const auto& r : all) {
    const double weight = 1 / std::pow(r.rel_sd * scale, 2);
    w += weight, wu += weight * r.U, wuu += weight * r.U * r.U, wc += weight * r.c, wuc += weight * r.U * r.c;
  }
  std::vector<Line> candidates{{std::max(0.0, wc / w), 0, 0}, {0, std::max(0.0, wuc / wuu), 0}};
  const double determinant = w * wuu - wu * wu;
  if (determinant > 1e-9 * w * wuu) {
    const Line both{(wuu * wc - wu * wuc) / determinant, (w * wuc - wu * wc) / determinant, 0};
    if (both.linear >= 0 && both.quadratic >= 0) candidates.push_back(both);
  }
  for (auto& line : candidates) line.chi2 = chi2_of(all, line, scale);
  return *std::min_element(candidates.begin(), candidates.end(),
                           [](const Line& a, const Line& b) { return a.chi2 < b.chi2; });
}

double median_c(std::vector<Reading> all) {
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end(), [](const Reading& a, const Reading& b) { return a.c < b.c; });
  return middle->c;
}

/// Chi-square that chance exceeds once in 10 000 (Wilson and Hilferty).
double chi2_limit(double dof) { return dof * std::pow(1 - 2 / (9 * dof) + 3.72 * std::sqrt(2 / (9 * dof)), 3); }

/// The wind that a line wants for an amplitude: linear U + quadratic U^2 = g A.
double wind_for(const Line& line, double gA) {
  if (line.quadratic <= 0) return line.linear > 0 ? gA / line.linear : 0;
  return (std::sqrt(line.linear * line.linear + 4 * line.quadratic * gA) - line.linear) / (2 * line.quadratic);
}

Problem odd_one_out(const std::vector<TunnelRunFit>& runs, const std::vector<Reading>& all, std::size_t odd) {
  std::vector<Reading> others = all;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(odd));
  const Reading& bad = all[odd];
  const double wanted = wind_for(fit_line(others, median_c(others)), bad.c * bad.U);
  const auto& run = runs[bad.run];
  auto what =
      fmt::format("it is stated to fly in {:.4g} m/s, but leans as the other runs lean in {:.2f} m/s", bad.U, wanted);
  auto hint = std::string("check wind_speed_m_s of this run, or leave the run out");
  if (const auto unit = units_of(wanted / bad.U, 1.08); !unit.empty()) {
    what += fmt::format(": that would be {}", unit);
    hint =
        fmt::format("if so, write wind_speed_m_s = {:.2f}; else measure this wind again or leave the run out", wanted);
  }
  return problem(Kind::inconsistent, run.name, what, hint);
}

Problem two_that_differ(const std::vector<TunnelRunFit>& runs, const std::vector<Reading>& all) {
  const auto &a = all[0], &b = all[1];
  auto what = fmt::format(
      "this run shows a drag of {:.3f} 1/s at {:.4g} m/s and {} one of {:.3f} at {:.4g} m/s, which no drag law joins",
      a.c, a.U, runs[b.run].name, b.c, b.U);
  std::string hint = "check both wind speeds, or add a run at a third";
  // With two, the law's own bend is not known: a wider tolerance.
  const auto unit = units_of(a.c < b.c ? a.c / b.c : b.c / a.c, 1.15);
  if (!unit.empty())
    what += fmt::format(": the wind speed of {} may be {}", runs[a.c < b.c ? a.run : b.run].name, unit);
  return problem(Kind::inconsistent, runs[a.run].name, what, hint);
}

}  // namespace

std::optional<Problem> check_stated(const std::vector<TunnelRun>& runs, const TunnelSettings& settings) {
  if (!positive(settings.mass) || settings.mass < 1e-3 || settings.mass > 1e4)
    return Problem{Kind::usage,
                   fmt::format("a mass of {} kg cannot be", settings.mass),
                   {},
                   "give mass_kg: what the vehicle weighs as it flew, battery and payload on"};
  if (runs.size() < 2)
    return Problem{
        Kind::no_answer,
        runs.empty() ? "there is no run"
                     : "there is only one run: nothing checks its wind, its unit or the law of the drag",
        {},
        "fly at least two wind speeds; four from 2 m/s to the highest in use, and one in calm air, are better"};
  for (const auto& run : runs)
    if (auto wrong = check_stated_run(run)) return wrong;
  const auto [low, high] = std::minmax_element(
      runs.begin(), runs.end(), [](const TunnelRun& a, const TunnelRun& b) { return a.wind_speed < b.wind_speed; });
  if (is_calm(high->wind_speed))
    return Problem{
        Kind::no_answer, "no run has wind, so nothing drags", {}, "add runs at wind speeds of 2 m/s and more"};
  if (high->wind_speed - low->wind_speed < std::max(0.2, 0.05 * high->wind_speed))
    return Problem{Kind::no_answer,
                   fmt::format("all {} runs are at one wind speed, about {:.1f} m/s", runs.size(), high->wind_speed),
                   {},
                   "add a run at another wind speed, at least a fifth lower or higher"};
  return std::nullopt;
}

std::optional<Problem> check_steadiness(const TunnelRun& run, std::size_t steady, std::size_t seen,
                                        double median_speed) {
  if (run.flight.attitude.empty() || run.flight.velocity.empty())
    return problem(Kind::missing, run.name,
                   fmt::format("the run has no {}", run.flight.attitude.empty() ? "attitude" : "velocity"),
                   run.start || run.end ? "check start_s and end_s against the log's clock, and that the log has it"
                                        : "calibrate with a log that has attitude and velocity");
  if (seen == 0)
    return problem(Kind::missing, run.name, "no attitude and velocity lie beside each other in this run",
                   "check start_s and end_s against the log's clock (`quadsonde info` shows it)");
  if (static_cast<double>(steady) < 0.5 * static_cast<double>(seen))
    return problem(
        Kind::inconsistent, run.name,
        fmt::format(
            "the aircraft moves: it stands still for only {:.0f} % of the run, and its median speed is {:.2f} m/s",
            100.0 * static_cast<double>(steady) / static_cast<double>(seen), median_speed),
        "fly on the spot (below 0.3 m/s), or cut the run with start_s and end_s; free flight is for `calibrate LOG`");
  if (steady < 200)
    return problem(
        Kind::no_answer, run.name,
        fmt::format("there are only {:.0f} s of standing still in this run", 0.1 * static_cast<double>(steady)),
        "fly at least 20 s, better a full slow turn of 60 s");
  return std::nullopt;
}

std::optional<Problem> check_sinusoids(const TunnelRunFit& run, const SinusoidFit& fit, const TunnelSettings& settings,
                                       std::vector<Problem>& notes) {
  const bool calm = is_calm(run.wind_speed);
  if (!calm && run.turn_deg < settings.min_turn_deg && !settings.trim)
    return problem(
        Kind::no_answer, run.name,
        fmt::format(
            "the nose turns through only {:.0f} degrees; with less than {:.0f} a crooked sensor and wind look alike",
            run.turn_deg, settings.min_turn_deg),
        "turn slowly through a full circle in each wind, or give the trim of a calm hover (trim_roll_deg, "
        "trim_pitch_deg)");
  const bool shows_wind = fit.amplitude() > 5 * run.amplitude_sd && fit.amplitude() > 0.005;
  if (calm && shows_wind && fit.amplitude() > 0.02)
    notes.push_back(
        problem(Kind::doubtful, run.name,
                fmt::format("the run is stated to be calm, but its tilt turns with the nose by {:.1f} degrees",
                            std::atan(fit.amplitude()) / degree),
                "check that the generator was off and the air still"));
  if (calm) return std::nullopt;
  const auto pitch_only = fit_sinusoids(run.samples, false, settings.trim, TiltAxes::pitch_only);
  const auto roll_only = fit_sinusoids(run.samples, false, settings.trim, TiltAxes::roll_only);
  const bool each = explained(run.samples, pitch_only, TiltAxes::pitch_only) > 0.5 &&
                    explained(run.samples, roll_only, TiltAxes::roll_only) > 0.5;
  if (each && explained(run.samples, fit, TiltAxes::both) < 0.5)
    return problem(Kind::inconsistent, run.name,
                   "pitch and roll each follow the turning nose, but tell of different winds",
                   "roll and pitch may be exchanged, or one of them or the yaw reversed: `quadsonde check` on a flight "
                   "that moves names it");
  if (!shows_wind) return std::nullopt;
  const double off = ingest::wrap_angle((run.fitted_from_deg - run.wind_from_deg) * degree) / degree;
  const auto what = fmt::format("the wind is stated to come from {:.0f} degrees, but the tilt says {:.0f} +- {:.1g}",
                                run.wind_from_deg, run.fitted_from_deg, std::max(1.0, run.fitted_from_sd_deg));
  if (std::abs(off) > 160)
    return problem(Kind::inconsistent, run.name, what + ": the opposite",
                   "wind_from_deg is where the wind comes FROM; if it is, the log's roll and pitch are reversed");
  if (std::abs(off) > 20)
    return problem(Kind::inconsistent, run.name, what,
                   fmt::format("correct wind_from_deg, or the log's headings, which may be {:.0f} degrees off (iron "
                               "near the generator, declination)",
                               std::abs(off)));
  if (std::abs(off) > std::max(5.0, 4 * run.fitted_from_sd_deg))
    notes.push_back(problem(Kind::doubtful, run.name, what,
                            "the drag does not suffer; check the compass before measuring wind with it"));
  return std::nullopt;
}

std::optional<Problem> check_against_each_other(const std::vector<TunnelRunFit>& runs, double& spread,
                                                std::vector<Problem>& notes) {
  spread = 1;
  std::vector<Reading> all;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].drag)
      all.push_back({i, runs[i].wind_speed, *runs[i].drag, *runs[i].drag_sd / std::max(1e-6, *runs[i].drag)});
  for (auto& r : all)
    r.rel_sd = std::max(runs[r.run].wind_speed_sd / r.U, 1e-3) +
               runs[r.run].amplitude_sd / std::max(1e-4, runs[r.run].amplitude);
  for (const auto& r : all)
    if (runs[r.run].amplitude < 5 * runs[r.run].amplitude_sd && r.c < 0.03)
      return problem(Kind::inconsistent, runs[r.run].name, fmt::format("no tilt follows the wind of {:.4g} m/s", r.U),
                     "check that the vehicle flew in the stream, and that the log's roll and pitch are its own");
  if (all.size() < 2) {
    notes.push_back({Kind::doubtful,
                     "only one run has wind, so nothing checks its speed, and the drag is linear by assumption",
                     {},
                     "add runs at other wind speeds, up to the highest in use"});
    return std::nullopt;
  }
  const double scale = median_c(all);
  const double chi2 = fit_line(all, scale).chi2;
  const double dof = std::max(1.0, static_cast<double>(all.size()) - 2);
  if (chi2 <= chi2_limit(dof)) return std::nullopt;
  std::size_t odd = 0;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (std::abs(std::log(std::max(all[i].c, 1e-6) / scale)) > std::abs(std::log(std::max(all[odd].c, 1e-6) / scale)))
      odd = i;
  const double worst = all.size() == 2 ? std::abs(std::log(all[0].c / all[1].c))
                                       : std::abs(std::log(std::max(all[odd].c, 1e-6) / scale));
  if (worst > std::log(1.25)) return all.size() == 2 ? two_that_differ(runs, all) : odd_one_out(runs, all, odd);
  spread = std::sqrt(chi2 / dof);
  notes.push_back({Kind::doubtful,
                   fmt::format("the runs scatter {:.1f} times as far about any drag law as their stated wind sds "
                               "allow; the vehicle's sds are widened by that",
                               spread),
                   {},
                   "state honest wind_speed_sd_m_s, or measure the winds again"});
  return std::nullopt;
}

void check_against_class(double c, double airspeed, std::vector<Problem>& notes) {
  const auto prior = ingest::class_prior();
  const double sd = prior.parameter_sd(ingest::p_linear) / prior.drag.linear;
  const double off = std::log(c / prior.drag.linear);
  if (std::abs(off) <= 2 * sd) return;
  auto what = fmt::format(
      "the drag, {:.3f} 1/s at {:.1f} m/s, is unusually {}: recorded multirotors have {:.2f} to {:.2f}", c, airspeed,
      off < 0 ? "low" : "high", prior.drag.linear * std::exp(-2 * sd), prior.drag.linear * std::exp(2 * sd));
  std::string guesses;
  for (const auto& unit : units)
    if (off < 0 && std::abs(off - std::log(unit.in_m_s)) < 1.5 * sd)
      guesses += fmt::format("{}{} would make it {:.2f}", guesses.empty() ? "" : ", ", unit.name, c / unit.in_m_s);
  notes.push_back(
      {Kind::doubtful,
       what,
       {},
       guesses.empty()
           ? "check the unit of wind_speed_m_s and of the log's angles"
           : fmt::format("check the unit of wind_speed_m_s, which is metres per second: stated in {}", guesses)});
}

}  // namespace quadsonde::estimator
