#include "estimator/calibration/identifiability.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "ingest/motion/simulator.h"

namespace quadsonde::estimator {
namespace {

using ingest::HeadingRule;
using ingest::PathLeg;

struct Named {
  const char *name, *unit;
  double in_unit;  ///< of one unit of the parameter
};
constexpr std::array<Named, fit_count> named{Named{"drag", "%", 100}, Named{"quadratic drag", "1/m", 1},
                                             Named{"latency", "s", 1}, Named{"trim in roll", "deg", 1},
                                             Named{"trim in pitch", "deg", 1}};

/// "drag against latency": the parts of a direction that weigh, largest first.
std::string combination(const FitVector& direction) {
  std::array<int, fit_count> order{0, 1, 2, 3, 4};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(direction(a)) > std::abs(direction(b)); });
  std::string text;
  for (const int i : order) {
    if (std::abs(direction(i)) < 0.3) continue;
    const bool against = direction(i) * direction(order[0]) < 0;
    text += (text.empty() ? ""
             : against    ? " against "
                          : " with ") +
            std::string(named[static_cast<std::size_t>(i)].name);
  }
  return text;
}

PathLeg leg(PathLeg::Kind kind, double speed, double duration, double yaw_rate) {
  PathLeg out;
  out.kind = kind;
  out.speed = speed;
  out.duration = duration;
  out.heading = {HeadingRule::Kind::turning, 0, yaw_rate};
  return out;
}

std::vector<PathLeg> path(Manoeuvre manoeuvre) {
  switch (manoeuvre) {
    case Manoeuvre::square_turning:
      return {leg(PathLeg::Kind::square, 4, 300, 17)};
    case Manoeuvre::hover_turning:
      return {leg(PathLeg::Kind::hover, 0, 120, 20)};
    case Manoeuvre::reversals: {
      auto back_and_forth = leg(PathLeg::Kind::line, 4, 180, 17);
      back_and_forth.back_and_forth = true;
      back_and_forth.side_duration = 5;
      return {back_and_forth};
    }
    case Manoeuvre::two_speeds:
      break;
  }
  return {leg(PathLeg::Kind::square, 3, 150, 17), leg(PathLeg::Kind::square, 8, 150, 17)};
}

/// What a simulated flight of the manoeuvre would add.
std::optional<FitMatrix> information_of(Manoeuvre manoeuvre, const FitVector& at, FitSettings settings,
                                        const ingest::Vehicle& vehicle) {
  ingest::Scenario scenario;
  scenario.vehicle = vehicle;
  scenario.vehicle.drag = settings.climb;
  scenario.vehicle.drag.linear = std::exp(at(f_drag));
  scenario.vehicle.drag.quadratic = at(f_quadratic);
  scenario.wind.toward = {2.6, 1.5};
  scenario.path = path(manoeuvre);
  scenario.start_height = 20;
  scenario.sensors.tilt_sd_deg = settings.noise.sd_deg;
  scenario.sensors.tilt_correlation = settings.noise.correlation_s;
  scenario.sensors.trim_roll_deg = at(f_trim_roll);
  scenario.sensors.trim_pitch_deg = at(f_trim_pitch);
  scenario.sensors.latency = std::clamp(at(f_latency), 0.0, 0.5);
  const auto flown = ingest::simulate(scenario);
  if (!flown) return std::nullopt;
  SlowMotion motion(flown->flight, {});
  settings.trim_between_deg = 0;
  const Whitened w = whiten({{&motion, 1, true}}, settings, at, {scenario.wind.sigma_u});
  return FitMatrix(w.information());
}

FitMatrix covariance_of(const FitMatrix& information, const FitVector& prior_sd) {
  FitMatrix sum = information;
  sum.diagonal() += prior_sd.cwiseAbs2().cwiseInverse();
  return sum.inverse();
}

}  // namespace

std::string words(Manoeuvre manoeuvre) {
  switch (manoeuvre) {
    case Manoeuvre::square_turning:
      return "fly a square or back and forth at 3 to 5 m/s for 5 min, turning the nose steadily (about 17 deg/s) and "
             "independently of the track";
    case Manoeuvre::hover_turning:
      return "hover for 2 min, turning the nose through several full turns";
    case Manoeuvre::reversals:
      return "fly straight legs of 5 s at 4 m/s with abrupt reversals for 3 min";
    case Manoeuvre::two_speeds:
      break;
  }
  return "fly squares at two speeds, 3 m/s and near the limit of use (8 m/s), 150 s each, turning the nose steadily";
}

Identifiability identify(const FitMatrix& information, const FitVector& prior_sd, double drag_rel_sd) {
  Identifiability out;
  const FitMatrix scaled = prior_sd.asDiagonal() * information * prior_sd.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<FitMatrix> eigen(scaled);
  for (int i = fit_count; i-- > 0;) out.singular_values.push_back(std::sqrt(std::max(0.0, eigen.eigenvalues()(i))));
  out.rank = static_cast<int>(
      std::count_if(out.singular_values.begin(), out.singular_values.end(), [](double value) { return value > 1; }));
  out.condition = out.singular_values.front() / std::max(1e-9, out.singular_values.back());
  out.weakest = combination(eigen.eigenvectors().col(0));
  const FitMatrix covariance = covariance_of(information, prior_sd);
  for (int i = 0; i < fit_count; ++i) {
    const auto& n = named[static_cast<std::size_t>(i)];
    const double sd = i == f_drag ? drag_rel_sd : std::sqrt(covariance(i, i)), share = sd / prior_sd(i);
    out.determined.push_back(
        share > 0.7 ? fmt::format("{}: not determined (stays at +-{:.2g} {})", n.name, prior_sd(i) * n.in_unit, n.unit)
                    : fmt::format("{}: to +-{:.2g} {} (before: {:.2g})", n.name, sd * n.in_unit, n.unit,
                                  prior_sd(i) * n.in_unit));
  }
  return out;
}

Advice advise(const FitMatrix& information, const FitVector& prior_sd, const FitVector& at, const FitSettings& settings,
              const ingest::Vehicle& vehicle, bool drag_known, bool simulate) {
  const FitMatrix now = covariance_of(information, prior_sd);
  const auto sd = [](const FitMatrix& C, int i) { return std::sqrt(C(i, i)); };
  struct Wish {
    int parameter;
    Manoeuvre manoeuvre;
    const char* what;
  };
  // What serves best, the most needed first.
  Wish wish{f_quadratic, Manoeuvre::two_speeds, "the quadratic drag"};
  if (sd(now, f_latency) > 0.02) wish = {f_latency, Manoeuvre::reversals, "the latency"};
  if (std::max(sd(now, f_trim_roll), sd(now, f_trim_pitch)) > 0.3)
    wish = {f_trim_roll, Manoeuvre::hover_turning, "the tilt trim"};
  if (!drag_known || sd(now, f_drag) > 0.05) wish = {f_drag, Manoeuvre::square_turning, "the drag"};
  const auto& n = named[static_cast<std::size_t>(wish.parameter)];
  Advice advice{wish.manoeuvre, wish.what, n.unit, sd(now, wish.parameter) * n.in_unit, 0, false};
  if (!drag_known) advice.now = prior_sd(wish.parameter) * n.in_unit;
  if (!simulate) return advice;
  const auto more = information_of(wish.manoeuvre, at, settings, vehicle);
  if (!more) return advice;
  const FitMatrix sum = drag_known ? FitMatrix(information + *more) : *more;
  advice.then = sd(covariance_of(sum, prior_sd), wish.parameter) * n.in_unit;
  advice.simulated = true;
  return advice;
}

}  // namespace quadsonde::estimator
