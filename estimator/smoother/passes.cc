#include "estimator/smoother/passes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

namespace quadsonde::estimator {
namespace {

constexpr double turned_enough = 0.4;  // heading index from which the trim is told apart from wind

using Gain = StateMatrix<double>;

/// P+ Phi' (P-)^-1; with a frozen trim the last two states are constants and take no part.
Gain smoother_gain(const StateMatrix<double>& P, const Transition<double>& t, const StateMatrix<double>& P_minus,
                   bool trim_is_state) {
  if (trim_is_state) return P_minus.llt().solve(t.Phi * P).transpose();
  Gain gain = Gain::Zero();
  const Eigen::Matrix<double, 6, 6> moving = P_minus.topLeftCorner<6, 6>();
  const Eigen::Matrix<double, 6, 6> forward = (t.Phi * P).topLeftCorner<6, 6>();
  gain.topLeftCorner<6, 6>() = moving.llt().solve(forward).transpose();
  gain.bottomRightCorner<2, 2>().setIdentity();
  return gain;
}

/// No single flight is believed beyond this: squares in turbulence come out 0.02 to 0.03 high (MODEL.md section 15).
constexpr double least_drag_sd = 0.025;

/// The thrust slope read so much later or earlier than the steps have it: its integral over time, read between steps.
class LaterSlope {
 public:
  explicit LaterSlope(const std::vector<Step>& steps) : steps_(steps), integral_(steps.size()) {
    for (std::size_t k = 1; k < steps.size(); ++k)
      integral_[k] = integral_[k - 1] + steps[k].input.step * steps[k].input.slope;
  }
  /// The step's input with the attitude `latency` older. Beyond either end, and where the steps leave out time, it is
  /// the step's own.
  StepInput<double> at(std::size_t k, double latency) const {
    StepInput<double> in = steps_[k].input;
    const double to = steps_[k].seconds - latency, from = to - in.step;
    if (latency == 0 || k == 0 || in.step <= 0 || from < 0 || to > steps_.back().seconds) return in;
    in.slope = (integral(k, to) - integral(k, from)) / in.step;
    return in;
  }

 private:
  Eigen::Vector2d integral(std::size_t k, double t) const {
    while (k > 1 && steps_[k - 1].seconds >= t) --k;
    while (k + 1 < steps_.size() && steps_[k].seconds < t) ++k;
    return integral_[k] - (steps_[k].seconds - t) * steps_[k].input.slope;
  }
  const std::vector<Step>& steps_;
  std::vector<Eigen::Vector2d> integral_;
};

/// Drag and latency on their way through a pass.
class Learner {
 public:
  Learner(const std::vector<Step>& steps, const PassSettings& settings)
      : steps_(steps),
        settings_(settings),
        slope_(steps),
        known_(settings.model.drag, settings.consider, least_drag_sd) {
    if (settings.learning == Learning::gather) known_.set_mean(settings.ln_factor_ahead, settings.latency_ahead);
  }

  void see(const Step& step) { excitation_.add(step.seconds, step.v.x(), step.v.y(), step.heading, step.input.step); }
  StepInput<double> input(std::size_t k) const { return slope_.at(k, latency_); }

  /// Between prediction and update.
  void learn(WindFilter<double>& filter, std::size_t k, double variance, LearnedStep& out) {
    if (known_.learn(filter, steps_[k].v, variance, settings_.limits.gate_nis, steps_[k].input.step,
                     excitation_.enough())) {
      out.updated = true;
      seconds_ += steps_[k].input.step;
      if (settings_.learning == Learning::adopt) adopt(filter);
    }
    out.ln_factor = static_cast<float>(ln_factor_ + known_.mean()(c_linear));
    out.ln_factor_sd = static_cast<float>(std::sqrt(known_.ln_factor_variance()));
  }

  ConsiderCovariance covariance(const ingest::DragLaw<double>& law) const { return known_.covariance(law); }
  bool moving() const { return excitation_.enough(); }
  void forget_trim() { known_.forget_trim(); }

  LearnedDrag result(const ingest::DragLaw<double>& law) const {
    LearnedDrag out;
    out.ln_factor = ln_factor_ + known_.mean()(c_linear);
    out.ln_factor_sd = std::sqrt(known_.ln_factor_variance());
    out.latency = latency_ + known_.mean()(c_latency);
    out.latency_sd = std::sqrt(std::max(0.0, known_.latency_variance()));
    out.seconds = seconds_;
    auto learned_law = law;
    if (settings_.learning == Learning::gather) {
      learned_law.linear *= std::exp(known_.mean()(c_linear));
      learned_law.quadratic *= std::exp(known_.mean()(c_linear));
    }
    out.covariance = known_.covariance(learned_law);
    return out;
  }

 private:
  void adopt(WindFilter<double>& filter) {
    const double move = std::clamp(known_.mean()(c_linear), -0.1, 0.1);
    const double latency =
        std::clamp(latency_ + known_.mean()(c_latency), settings_.least_latency, settings_.most_latency);
    filter.adopt(move, latency - latency_);
    ln_factor_ += move;
    latency_ = latency;
    known_.adopted();
  }

  const std::vector<Step>& steps_;
  const PassSettings& settings_;
  LaterSlope slope_;
  DragKnowledge<double> known_;
  RecentExcitation excitation_;
  double ln_factor_ = 0, latency_ = 0, seconds_ = 0;
};

/// Runs the filter over the steps; the pieces of one step in the order in which they happen.
class Runner {
 public:
  Runner(const std::vector<Step>& steps, const PassSettings& settings)
      : steps_(steps),
        settings_(settings),
        filter_(settings.model, settings.limits),
        jump_test_(settings.limits.jump_threshold),
        turbulence_(square(settings.model.turbulence_sd)) {
    out_.outcome.assign(steps.size(), Outcome::predicted);
    out_.active.assign(steps.size(), false);
    if (settings.keep_trace) out_.whitened.assign(steps.size(), Eigen::Vector2d::Zero());
    if (settings.causal) out_.causal.resize(steps.size());
    if (settings.learning != Learning::off) {
      learner_.emplace(steps, settings);
      out_.learning.resize(steps.size());
    }
    if (settings.keep_trace) {
      out_.trace.steps.reserve(steps.size());
      out_.trace.of_point.assign(steps.size(), -1);
    }
  }

  ForwardPass run() {
    auto next_jump = settings_.jumps.begin();
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const Step& step = steps_[k];
      count_heading(step);
      bool open = false;
      for (; next_jump != settings_.jumps.end() && *next_jump <= k; ++next_jump) open = true;
      if (!step.sound && !step.gap_before) {
        broken_ = running_;
        continue;
      }
      if (!running_) {
        begin(k);
      } else if (broken_ || step.gap_before || step.seconds - last_update_ > settings_.restart_after) {
        restart(k);
      } else {
        advance(k, open);
      }
      keep(k);
    }
    finish();
    return std::move(out_);
  }

 private:
  static double square(double a) { return a * a; }

  void count_heading(const Step& step) {
    if (!step.sound) return;
    if (learner_) learner_->see(step);
    heading_sum_ += std::polar(1.0, step.heading);
    ++headings_;
    if (!settings_.causal || filter_.model().trim_is_state || headings_ < 10) return;
    const double coherence = std::abs(heading_sum_) / headings_;
    if (running_ && std::sqrt(std::max(0.0, 1 - coherence * coherence)) >= turned_enough) {
      filter_.thaw_trim();
      if (learner_) learner_->forget_trim();
    }
  }

  void begin(std::size_t k) {
    if (steps_[k].gap_before) return;
    filter_.start(steps_[k].v, settings_.trim, settings_.trim_covariance);
    running_ = true;
    last_update_ = steps_[k].seconds;
    out_.active[k] = true;
  }

  void restart(std::size_t k) {
    remember();
    const auto transition = filter_.restart(steps_[k].v);
    close_previous(transition);
    if (settings_.keep_trace) out_.trace.breaks.push_back(out_.trace.steps.size());
    jump_test_.clear();
    broken_ = false;
    last_update_ = steps_[k].seconds;
    ++out_.restarts;
    out_.active[k] = true;
  }

  void advance(std::size_t k, bool open) {
    const Step& step = steps_[k];
    remember();
    const Jump<double> jump = open ? Jump<double>{settings_.limits.jump_variance, 0} : pending_jump_;
    pending_jump_ = {};
    filter_.predict(learner_ ? learner_->input(k) : step.input, jump);
    close_previous(filter_.transition());
    const double variance = settings_.velocity_scale * step.variance;
    if (learner_) learner_->learn(filter_, k, variance, out_.learning[k]);
    out_.outcome[k] = filter_.update(step.v, variance);
    out_.active[k] = true;
    out_.log_likelihood += filter_.innovation().log_likelihood;
    watch_for_jump(k);
    if (out_.outcome[k] == Outcome::rejected) {
      ++out_.rejected;
      return;
    }
    last_update_ = step.seconds;
    out_.nis_sum += filter_.innovation().nis;
    ++out_.updates;
    if (settings_.keep_trace) out_.whitened[k] = filter_.innovation().whitened;
    adapt(step);
  }

  /// Rejected samples count too, cut to the gate's length: a real step of the wind soon fails the gate, and the test
  /// would otherwise starve; one outlier alone stays far below the threshold.
  void watch_for_jump(std::size_t k) {
    if (!settings_.jump_test) return;
    Eigen::Vector2d z = filter_.innovation().whitened;
    if (learner_ && learner_->moving()) return;  // what a wrong drag does in every turn is no weather
    const double longest = std::sqrt(settings_.limits.gate_nis);
    if (z.norm() > longest) z *= longest / z.norm();
    if (!jump_test_.add(z, steps_[k].seconds)) return;
    out_.found_jumps.push_back(k);
    pending_jump_ = {settings_.limits.jump_variance, settings_.limits.jump_age};
  }

  /// EM over the past 120 s: sigma_u^2 follows the mean of u^2 + P_uu.
  void adapt(const Step& step) {
    if (!settings_.adapt_turbulence) return;
    const auto& P = filter_.covariance();
    const double seen = 0.5 * (filter_.state().segment<2>(i_u).squaredNorm() + P(i_u, i_u) + P(i_u + 1, i_u + 1));
    turbulence_ += std::min(1.0, step.input.step / 120) * (seen - turbulence_);
    filter_.set_turbulence_sd(std::sqrt(std::max(turbulence_, 1e-4)));
  }

  void remember() {
    if (!settings_.keep_trace) return;
    x_ = filter_.state();
    P_ = filter_.covariance();
    S_ = filter_.sensitivity();
  }
  /// Once the next step's prediction is known, what backward needs of the step before is complete.
  void close_previous(const Transition<double>& t) {
    if (!settings_.keep_trace || out_.trace.steps.empty()) return;
    SmoothedStep& previous = out_.trace.steps.back();
    const Gain gain = smoother_gain(P_, t, filter_.covariance(), filter_.model().trim_is_state);
    previous.gain = gain;
    previous.x = x_ - gain * filter_.state();
    previous.P = P_ - gain * filter_.covariance() * gain.transpose();
    previous.S = S_ - gain * filter_.sensitivity();
  }

  void keep(std::size_t k) {
    if (!out_.active[k]) return;
    if (settings_.causal)
      out_.causal[k] = {
          wind_posterior(filter_.state(), filter_.covariance(), filter_.sensitivity(), filter_.model().trim_is_state),
          filter_.model().trim_is_state, considered()};
    if (!settings_.keep_trace) return;
    out_.trace.of_point[k] = static_cast<std::ptrdiff_t>(out_.trace.steps.size());
    out_.trace.steps.push_back({filter_.state(), filter_.covariance(), Gain::Zero(), filter_.sensitivity()});
  }

  Eigen::Matrix2d considered() const {
    if (!learner_) return Eigen::Matrix2d::Zero();
    const auto& S = filter_.sensitivity();
    const Eigen::Matrix<double, 2, consider_count> HS = S.middleRows<2>(i_W) + S.middleRows<2>(i_u);
    return HS * learner_->covariance(filter_.model().drag) * HS.transpose();
  }

  void finish() {
    if (learner_) out_.learned = learner_->result(filter_.model().drag);
    out_.x = filter_.state();
    out_.P = filter_.covariance();
    out_.trace.turbulence_sd = filter_.model().turbulence_sd;
    out_.trace.turbulence_time = filter_.model().turbulence_time;
    out_.trace.trim_is_state = filter_.model().trim_is_state;
  }

  const std::vector<Step>& steps_;
  const PassSettings& settings_;
  WindFilter<double> filter_;
  JumpTest<double> jump_test_;
  ForwardPass out_;
  bool running_ = false, broken_ = false;
  double last_update_ = 0, turbulence_;
  Jump<double> pending_jump_;
  std::optional<Learner> learner_;
  std::complex<double> heading_sum_ = 0;
  double headings_ = 0;
  State<double> x_;
  StateMatrix<double> P_;
  Sensitivity<double> S_;
};

}  // namespace

WindPosterior wind_posterior(const State<double>& x, const StateMatrix<double>& P, const Sensitivity<double>& S,
                             bool trim_is_state) {
  WindPosterior out;
  out.wind = x.segment<2>(i_W) + x.segment<2>(i_u);
  out.velocity = x.segment<2>(i_v);
  const Eigen::Matrix<double, 2, 8> HP = P.middleRows<2>(i_W) + P.middleRows<2>(i_u);
  out.covariance = HP.middleCols<2>(i_W) + HP.middleCols<2>(i_u);
  out.without_trim = out.covariance;
  if (trim_is_state) {
    const Eigen::Matrix2d P_wb = HP.middleCols<2>(i_b), P_bb = P.block<2, 2>(i_b, i_b);
    if (P_bb.determinant() > 0) out.without_trim -= P_wb * P_bb.inverse() * P_wb.transpose();
  }
  out.sensitivity = S.middleRows<2>(i_W) + S.middleRows<2>(i_u);
  return out;
}

ForwardPass run_forward(const std::vector<Step>& steps, const PassSettings& settings) {
  return Runner(steps, settings).run();
}

void smooth(SmootherTrace& trace) {
  auto& steps = trace.steps;
  for (std::size_t k = steps.size(); k-- > 1;) {
    const SmoothedStep& next = steps[k];
    SmoothedStep& now = steps[k - 1];
    now.x += now.gain * next.x;
    now.P += now.gain * next.P * now.gain.transpose();
    now.P = (0.5 * (now.P + now.P.transpose())).eval();
    now.S += now.gain * next.S;
  }
}

double heading_index(const std::vector<Step>& steps, std::size_t until) {
  std::complex<double> sum = 0;
  double count = 0;
  for (std::size_t k = 0; k <= until && k < steps.size(); ++k) {
    if (!steps[k].sound) continue;
    sum += std::polar(1.0, steps[k].heading);
    ++count;
  }
  if (count == 0) return 0;
  const double coherence = std::abs(sum) / count;
  return std::sqrt(std::max(0.0, 1 - coherence * coherence));
}

}  // namespace quadsonde::estimator
