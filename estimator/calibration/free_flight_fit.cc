#include "estimator/calibration/free_flight_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "estimator/filter/wind_filter.h"

namespace quadsonde::estimator {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double least_ln_turbulence = -4, most_ln_turbulence = 1.8;
// A turbulence nobody has seen yet: ln sigma_u about 0.5 m/s, wide; keeps calm flights from running to nothing.
constexpr double turbulence_prior = -0.693, turbulence_prior_sd = 1.2;
// Differences for derivatives, and the longest step of one iteration, in the order of FitParameter.
constexpr std::array<double, fit_count> width{0.02, 0.001, 0.01, 0.1, 0.1};
constexpr std::array<double, fit_count> longest{0.4, 0.01, 0.15, 2, 2};

ingest::DragLaw<double> law_at(const FitSettings& s, const FitFlight& flight, const FitVector& at) {
  ingest::DragLaw<double> law = s.climb;
  law.linear = std::exp(at(f_drag));
  law.quadratic = at(f_quadratic);
  return ingest::scaled(law, flight.density_ratio, 1.0, s.density_exponent);
}

Eigen::Vector2d trim_at(const FitSettings& s, const FitFlight& flight, const FitVector& at) {
  // Where the nose never turned, the likelihood would read the controller's wander as trim.
  const FitVector& trim = flight.turned ? at : s.prior;
  return ingest::standard_gravity *
         Eigen::Vector2d(std::tan(trim(f_trim_pitch) * degree), -std::tan(trim(f_trim_roll) * degree));
}

WindModel<double> model_at(const FitSettings& s, const FitFlight& flight, const FitVector& at, double turbulence_sd,
                           double attitude_interval) {
  WindModel<double> model;
  model.drag = law_at(s, flight, at);
  model.turbulence_sd = turbulence_sd;
  const double tilt = ingest::standard_gravity * s.noise.sd_deg * degree;
  model.tilt_psd = tilt * tilt * (s.noise.correlation_s > 0 ? 2 * s.noise.correlation_s : attitude_interval);
  model.trim_is_state = flight.turned;
  return model;
}

const SlowSteps& steps_at(const FitFlight& flight, const FitSettings& s, const FitVector& at) {
  return flight.motion->steps(at(f_latency), law_at(s, flight, at).linear);
}

/// What a run of the filter at one place leaves for runs beside it: its gains and the innovations' spread.
struct StandingStep {
  enum class Kind { skipped, started, updated } kind = Kind::skipped;
  bool accepted = false;
  Eigen::Matrix<double, 8, 2> gain = Eigen::Matrix<double, 8, 2>::Zero();
  Eigen::Matrix2d whitener = Eigen::Matrix2d::Identity();  ///< inverse Cholesky factor of the innovation's covariance
};

struct Standing {
  std::vector<StandingStep> steps;
  double log_likelihood = 0;
  std::size_t accepted = 0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< mean of what the filter found [m/s]
  Eigen::Vector2d trim = Eigen::Vector2d::Zero();  ///< b as it was found last [m/s2]
};

/// Runs the filter over one flight. @param gate  chi-square(2) beyond which a window is left out
Standing stand(const FitFlight& flight, const FitSettings& s, const FitVector& at, double ln_turbulence, double gate) {
  const SlowSteps& slow = steps_at(flight, s, at);
  Standing out;
  out.steps.resize(slow.steps.size());
  FilterLimits<double> limits;
  limits.gate_nis = gate;
  WindFilter<double> filter(model_at(s, flight, at, std::exp(ln_turbulence), slow.attitude_interval), limits);
  const double trim_sd = ingest::standard_gravity * std::max(s.trim_between_deg, 1e-3) * degree;
  bool running = false, broken = true;
  double settled = 0;  // steps whose wind counts: those of a filter that has found one
  int since_start = 0;
  for (std::size_t k = 0; k < slow.steps.size(); ++k) {
    const Step& step = slow.steps[k];
    StandingStep& now = out.steps[k];
    if (!step.sound) {
      broken = true;
    } else if (broken) {
      now.kind = StandingStep::Kind::started;
      if (running)
        filter.restart(step.v);
      else
        filter.start(step.v, trim_at(s, flight, at), trim_sd * trim_sd * Eigen::Matrix2d::Identity());
      running = true, broken = false;
      since_start = 0;
    } else {
      now.kind = StandingStep::Kind::updated;
      filter.predict(step.input);
      const Eigen::Matrix<double, 8, 2> PH = filter.covariance().leftCols<2>();
      const Eigen::Matrix2d S = PH.topRows<2>() + step.variance * Eigen::Matrix2d::Identity();
      now.gain = PH * S.inverse();
      now.whitener = Eigen::Matrix2d(S.llt().matrixL()).inverse();
      now.accepted = filter.update(step.v, step.variance) == Outcome::updated;
      out.accepted += now.accepted;
      out.log_likelihood += filter.innovation().log_likelihood;
      if (++since_start > 5) out.wind += filter.wind(), settled += 1;
    }
  }
  out.wind = settled > 0 ? Eigen::Vector2d(out.wind / settled) : filter.wind();
  out.trim = filter.state().segment<2>(i_b);
  return out;
}

/// Innovations at a place, whitened and weighed by the gains of a filter that stood at another. Only the means depend
/// on the parameters here. Were the spread to follow them too, the drag would be bent to fit the noise level assumed: a
/// larger drag damps the effect of a tilt noise sooner, which is likelier wherever too much of it is assumed.
void append_residuals(const FitFlight& flight, const FitSettings& s, const FitVector& at, const Standing& standing,
                      const std::vector<Step>& steps, std::vector<double>& into) {
  const auto model = model_at(s, flight, at, 0.5, 0.1);  // of the noise nothing is used
  State<double> x = State<double>::Zero();
  x.segment<2>(i_b) = trim_at(s, flight, at);
  for (std::size_t k = 0; k < standing.steps.size() && k < steps.size(); ++k) {
    const Step& step = steps[k];
    const StandingStep& then = standing.steps[k];
    if (then.kind == StandingStep::Kind::skipped) continue;
    if (then.kind == StandingStep::Kind::started) {
      x.segment<2>(i_v) = step.v;
      x.segment<2>(i_u).setZero();
      continue;
    }
    x = propagate(model, x, step.input).x;
    if (!then.accepted) continue;
    const Eigen::Vector2d innovation = step.v - x.segment<2>(i_v);
    const Eigen::Vector2d white = then.whitener * innovation;
    into.push_back(white.x());
    into.push_back(white.y());
    x += then.gain * innovation;
  }
}

/// The same motion flown in calm air that moves as a whole: every step's thrust slope is replaced by the one that the
/// vehicle's own velocity asks for in a constant wind. What the controller added against gusts is not in it.
class CalmTwin {
 public:
  CalmTwin(const FitFlight& flight, const FitSettings& s, const FitVector& at, const Standing& standing)
      : steps_(steps_at(flight, s, at).steps), slope_by_latency_(steps_.size(), Eigen::Vector2d::Zero()) {
    const auto& acceleration = steps_at(flight, s, at).acceleration;
    const auto model = model_at(s, flight, at, 0.5, 0.1);
    const Eigen::Vector2d b = flight.turned ? standing.trim : trim_at(s, flight, at);
    std::vector<Eigen::Vector2d> push(steps_.size());  // thrust's mean over each window [m/s2]
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const Step& step = steps_[k];
      const Eigen::Vector2d a = step.v - standing.wind;
      const Eigen::Vector2d trim = Eigen::Rotation2Dd(step.heading) * b;
      push[k] = acceleration[k] + ingest::drag_coefficient(model.drag, a.norm(), 0.0) * a - trim;
      if (k == 0 || standing.steps[k].kind != StandingStep::Kind::updated) continue;
      State<double> x = State<double>::Zero();
      x.segment<2>(i_v) = steps_[k - 1].v;
      x.segment<2>(i_W) = standing.wind;
      x.segment<2>(i_b) = b;
      StepInput<double>& in = steps_[k].input;
      in.slope.setZero();
      // The mean of a force over the step moves the velocity by nearly that times the step; two rounds settle kappa.
      for (int round = 0; round < 3; ++round) {
        const auto moved = propagate(model, x, in);
        const double c = model.drag.linear;
        const double by_slope = in.lift * -std::expm1(-c * in.step) / c;
        in.slope += (step.v - moved.x.segment<2>(i_v)) / by_slope;
      }
      slope_by_latency_[k] = -(push[k] - push[k - 1]) / (in.step * in.lift);
    }
  }
  std::vector<Step> at_latency(double later) const {
    auto steps = steps_;
    for (std::size_t k = 0; k < steps.size(); ++k) steps[k].input.slope += later * slope_by_latency_[k];
    return steps;
  }

 private:
  std::vector<Step> steps_;
  std::vector<Eigen::Vector2d> slope_by_latency_;  ///< [1/s]
};

class Search {
 public:
  Search(const std::vector<FitFlight>& flights, const FitSettings& s)
      : flights_(flights), s_(s), ln_turbulence_(flights.size(), turbulence_prior) {}

  FreeFit run(const FitVector& start) {
    FreeFit fit;
    fit.at = start;
    if (!s_.quadratic) fit.at(f_quadratic) = s_.prior(f_quadratic);
    for (; fit.iterations < 40 && !fit.converged; ++fit.iterations) {
      forget();
      // Far from the end every window counts; then those beyond the gate are left out.
      gate_ = fit.iterations < 4 ? 1e9 : 18.4;
      const double moved = fit_turbulence(fit.at);
      const Whitened w = whitened(fit.at);
      const FitVector step = newton(w, fit.at);
      const double part = try_step(w, fit.at, step);
      fit.at += part * step;
      const FitMatrix precision = w.instruments.transpose() * w.instruments + s_.prior_information;
      const double size = std::sqrt(step.dot(precision * step));
      fit.converged = fit.iterations >= 5 && size < 0.03 && moved < 0.05;
    }
    forget();
    stand_at(fit.at);
    const Whitened w = whitened(fit.at);
    fit.information = w.information();
    fit.covariance = (fit.information + s_.prior_information).inverse();
    for (const auto& one : standing_) fit.log_likelihood += one.log_likelihood;
    for (const double ln : ln_turbulence_) fit.turbulence_sd.push_back(std::exp(ln));
    return fit;
  }

  void set_turbulence(const std::vector<double>& sd) {
    for (std::size_t k = 0; k < sd.size(); ++k) ln_turbulence_[k] = std::log(sd[k]);
  }
  void stand_at(const FitVector& at) {
    standing_.clear();
    for (std::size_t k = 0; k < flights_.size(); ++k)
      standing_.push_back(stand(flights_[k], s_, at, ln_turbulence_[k], gate_));
  }
  Whitened whitened(const FitVector& at) const {
    Whitened w;
    w.residual = residuals(at);
    w.jacobian.resize(w.residual.size(), fit_count);
    w.instruments.resize(w.residual.size(), fit_count);
    std::vector<CalmTwin> twins;
    for (std::size_t k = 0; k < flights_.size(); ++k) twins.emplace_back(flights_[k], s_, at, standing_[k]);
    for (int i = 0; i < fit_count; ++i) {
      FitVector up = at, down = at;
      const double h = width[static_cast<std::size_t>(i)];
      up(i) += h, down(i) -= h;
      w.jacobian.col(i) = (residuals(up) - residuals(down)) / (2 * h);
      w.instruments.col(i) = (twin_residuals(twins, up, up(f_latency) - at(f_latency)) -
                              twin_residuals(twins, down, down(f_latency) - at(f_latency))) /
                             (2 * h);
    }
    return w;
  }

 private:
  void forget() {
    for (const auto& flight : flights_) flight.motion->forget();
  }
  Eigen::VectorXd residuals(const FitVector& at) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < flights_.size(); ++k)
      append_residuals(flights_[k], s_, at, standing_[k], steps_at(flights_[k], s_, at).steps, all);
    return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
  Eigen::VectorXd twin_residuals(const std::vector<CalmTwin>& twins, const FitVector& at, double later) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < flights_.size(); ++k)
      append_residuals(flights_[k], s_, at, standing_[k], twins[k].at_latency(later), all);
    return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
  /// sigma_u of each flight by the likelihood of its innovations at this drag. Leaves the filter standing there.
  double fit_turbulence(const FitVector& at) {
    double moved = 0;
    standing_.clear();
    for (std::size_t k = 0; k < flights_.size(); ++k) {
      const auto likelihood = [&](double ln) {
        return stand(flights_[k], s_, at, ln, gate_).log_likelihood -
               0.5 * std::pow((ln - turbulence_prior) / turbulence_prior_sd, 2);
      };
      const double before = ln_turbulence_[k], h = 0.3;
      const double low = likelihood(before - h), here = likelihood(before), high = likelihood(before + h);
      const double bend = high - 2 * here + low;
      double move = bend < 0 ? -0.5 * h * (high - low) / bend : (high > low ? 0.8 : -0.8);
      move = std::clamp(std::clamp(move, -0.8, 0.8), least_ln_turbulence - before, most_ln_turbulence - before);
      ln_turbulence_[k] += move;
      moved = std::max(moved, std::abs(move));
      standing_.push_back(stand(flights_[k], s_, at, ln_turbulence_[k], gate_));
    }
    return moved;
  }

  /// What must vanish at the end: the residuals' part along the instruments, and the prior's pull.
  FitVector pull(const Whitened& w, const Eigen::VectorXd& residual, const FitVector& at) const {
    return w.instruments.transpose() * residual + s_.prior_information * (at - s_.prior);
  }
  void hold_quadratic(FitMatrix& M, FitVector& g) const {
    if (s_.quadratic) return;
    M.row(f_quadratic).setZero();
    M.col(f_quadratic).setZero();
    M(f_quadratic, f_quadratic) = 1;
    g(f_quadratic) = 0;
  }
  FitVector newton(const Whitened& w, const FitVector& at) const {
    FitMatrix slope = w.instruments.transpose() * w.jacobian + s_.prior_information;
    FitVector g = pull(w, w.residual, at);
    hold_quadratic(slope, g);
    FitVector step = -slope.partialPivLu().solve(g);
    double shrink = 1;
    for (int i = 0; i < fit_count; ++i)
      shrink = std::min(shrink, longest[static_cast<std::size_t>(i)] / std::max(1e-12, std::abs(step(i))));
    return shrink * step;
  }

  /// The part of the step that makes the pull smaller, in units of its own spread.
  double try_step(const Whitened& w, const FitVector& at, const FitVector& step) const {
    const auto size = [&](const FitVector& x) {
      FitMatrix M = w.instruments.transpose() * w.instruments + s_.prior_information;
      FitVector g = pull(w, residuals(x), x);
      hold_quadratic(M, g);
      return g.dot(M.ldlt().solve(g));
    };
    const double now = size(at);
    for (double part = 1; part > 0.01; part /= 2)
      if (size(at + part * step) <= now) return part;
    return 0;
  }

  const std::vector<FitFlight>& flights_;
  const FitSettings& s_;
  std::vector<double> ln_turbulence_;
  std::vector<Standing> standing_;
  double gate_ = 18.4;
};

}  // namespace

std::string TiltNoise::words() const {
  return correlation_s > 0 ? fmt::format("{:g} deg over {:g} s", sd_deg, correlation_s)
                           : fmt::format("{:g} deg white", sd_deg);
}

FitMatrix Whitened::information() const {
  const FitMatrix by_motion = instruments.transpose() * jacobian;
  FitMatrix spread = instruments.transpose() * instruments;
  spread.diagonal().array() += 1e-9;
  return by_motion.transpose() * spread.ldlt().solve(by_motion);
}

double fitted_drag(const FitVector& at, double airspeed) { return std::exp(at(f_drag)) + at(f_quadratic) * airspeed; }

FreeFit fit_free_flights(const std::vector<FitFlight>& flights, const FitSettings& s, const FitVector& start) {
  return Search(flights, s).run(start);
}

Whitened whiten(const std::vector<FitFlight>& flights, const FitSettings& s, const FitVector& at,
                const std::vector<double>& turbulence_sd) {
  Search search(flights, s);
  search.set_turbulence(turbulence_sd);
  search.stand_at(at);
  return search.whitened(at);
}

}  // namespace quadsonde::estimator
