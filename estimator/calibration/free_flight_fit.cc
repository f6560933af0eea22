#include "estimator/calibration/free_flight_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
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
    }
  }
  return out;
}

/// Innovations at a place, whitened and weighed by the gains of a filter that stood at another. Only the means depend
/// on the parameters here. Were the spread to follow them too, the drag would be bent to fit the noise level assumed: a
/// larger drag damps the effect of a tilt noise sooner, which is likelier wherever too much of it is assumed.
void append_residuals(const FitFlight& flight, const FitSettings& s, const FitVector& at, const Standing& standing,
                      std::vector<double>& into) {
  const SlowSteps& slow = steps_at(flight, s, at);
  const auto model = model_at(s, flight, at, 0.5, slow.attitude_interval);
  State<double> x = State<double>::Zero();
  x.segment<2>(i_b) = trim_at(s, flight, at);
  for (std::size_t k = 0; k < standing.steps.size() && k < slow.steps.size(); ++k) {
    const Step& step = slow.steps[k];
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
      const FitVector step = gauss_newton(w, fit.at);
      const double part = try_step(fit.at, step);
      fit.at += part * step;
      const FitMatrix precision = w.jacobian.transpose() * w.jacobian + s_.prior_information;
      const double size = std::sqrt(step.dot(precision * step));
      fit.converged = fit.iterations >= 5 && size < 0.03 && moved < 0.05;
    }
    forget();
    stand_at(fit.at);
    const Whitened w = whitened(fit.at);
    fit.information = w.jacobian.transpose() * w.jacobian;
    fit.covariance = (fit.information + s_.prior_information).inverse();
    fit.fit = value(w.residual, fit.at);
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
    for (int i = 0; i < fit_count; ++i) {
      FitVector up = at, down = at;
      const double h = width[static_cast<std::size_t>(i)];
      up(i) += h, down(i) -= h;
      w.jacobian.col(i) = (residuals(up) - residuals(down)) / (2 * h);
    }
    return w;
  }

 private:
  void forget() {
    for (const auto& flight : flights_) flight.motion->forget();
  }
  Eigen::VectorXd residuals(const FitVector& at) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < flights_.size(); ++k) append_residuals(flights_[k], s_, at, standing_[k], all);
    return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
  double value(const Eigen::VectorXd& residual, const FitVector& at) const {
    const FitVector off = at - s_.prior;
    return -0.5 * residual.squaredNorm() - 0.5 * off.dot(s_.prior_information * off);
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

  FitVector gauss_newton(const Whitened& w, const FitVector& at) const {
    FitMatrix information = w.jacobian.transpose() * w.jacobian + s_.prior_information;
    FitVector slope = -w.jacobian.transpose() * w.residual - s_.prior_information * (at - s_.prior);
    if (!s_.quadratic) {
      information.row(f_quadratic).setZero();
      information.col(f_quadratic).setZero();
      information(f_quadratic, f_quadratic) = 1;
      slope(f_quadratic) = 0;
    }
    FitVector step = information.ldlt().solve(slope);
    double shrink = 1;
    for (int i = 0; i < fit_count; ++i)
      shrink = std::min(shrink, longest[static_cast<std::size_t>(i)] / std::max(1e-12, std::abs(step(i))));
    return shrink * step;
  }

  /// The part of the step that makes the squares smaller.
  double try_step(const FitVector& at, const FitVector& step) const {
    const double now = value(residuals(at), at);
    for (double part = 1; part > 0.01; part /= 2) {
      const FitVector next = at + part * step;
      if (value(residuals(next), next) >= now) return part;
    }
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
