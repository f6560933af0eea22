#include "estimator/calibration/slow_steps.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace quadsonde::estimator {
namespace {

constexpr int parts = 25;  // of a window, in which a step's input is weighed

/// What is averaged, each as its integral from the flight's first sample.
struct Sums {
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero(), force = Eigen::Vector2d::Zero();
  double lift = 0, v_down = 0;
  std::complex<double> nose = 0;
  double unsound = 0;  ///< seconds

  Sums operator-(const Sums& o) const {
    return {velocity - o.velocity, force - o.force, lift - o.lift,
            v_down - o.v_down,     nose - o.nose,   unsound - o.unsound};
  }
  Sums operator+(const Sums& o) const {
    return {velocity + o.velocity, force + o.force, lift + o.lift,
            v_down + o.v_down,     nose + o.nose,   unsound + o.unsound};
  }
  Sums operator*(double k) const { return {k * velocity, k * force, k * lift, k * v_down, k * nose, k * unsound}; }
};

/// The flight's quantities integrated over time, to be read at any time.
class Integrals {
 public:
  explicit Integrals(const std::vector<Step>& steps) : steps_(steps) {
    at_.resize(steps.size());
    for (std::size_t i = 1; i < steps.size(); ++i) at_[i] = at_[i - 1] + piece(i, steps[i].input.step);
  }
  double end() const { return steps_.back().seconds; }
  Sums at(double t) {
    if (t <= 0) return at_.front();
    if (t >= end()) return at_.back();
    if (steps_[hint_].seconds > t) hint_ = 0;
    while (hint_ + 1 < steps_.size() && steps_[hint_ + 1].seconds <= t) ++hint_;
    return at_[hint_] + piece(hint_ + 1, t - steps_[hint_].seconds);
  }
  Eigen::Vector2d velocity(double t) {
    at(t);
    if (hint_ + 1 >= steps_.size() || t <= steps_[hint_].seconds) return steps_[hint_].v;
    const double part = (t - steps_[hint_].seconds) / steps_[hint_ + 1].input.step;
    return steps_[hint_].v + std::min(part, 1.0) * (steps_[hint_ + 1].v - steps_[hint_].v);
  }
  Sums mean(double from, double to) { return (at(to) - at(from)) * (1 / (to - from)); }

 private:
  /// From sample i-1 on for so many seconds: the velocity is a straight line, all else the step's own mean.
  Sums piece(std::size_t i, double seconds) const {
    const Step& step = steps_[i];
    const double part = step.input.step > 0 ? seconds / step.input.step : 0;
    Sums s;
    s.velocity = seconds * (steps_[i - 1].v + 0.5 * part * (step.v - steps_[i - 1].v));
    s.force = seconds * step.input.lift * step.input.slope;
    s.lift = seconds * step.input.lift;
    s.v_down = seconds * step.input.v_down;
    s.nose = std::polar(seconds, step.input.heading);
    s.unsound = step.sound ? 0 : seconds;
    return s;
  }
  const std::vector<Step>& steps_;
  std::vector<Sums> at_;
  std::size_t hint_ = 0;
};

/// The input of the step that ends at the window around t: running means of a window's length, weighed as their effect
/// decays until then.
Sums weighed_input(Integrals& integrals, double t, double window, double drag) {
  Sums sum;
  double weights = 0;
  for (int i = 0; i < parts; ++i) {
    const double before = (i + 0.5) / parts * window;
    const double weight = std::exp(-drag * before), middle = t - before;
    sum = sum + integrals.mean(middle - 0.5 * window, middle + 0.5 * window) * weight;
    weights += weight;
  }
  return sum * (1 / weights);
}

/// Between means of half a second around both ends.
Eigen::Vector2d acceleration_over(Integrals& integrals, double from, double to) {
  constexpr double half = 0.25;
  const double first = std::max(from, half), last = std::min(to, integrals.end() - half);
  const Eigen::Vector2d change =
      integrals.mean(last - half, last + half).velocity - integrals.mean(first - half, first + half).velocity;
  return change / (last - first);
}

SlowSteps make_steps_of(const Steps& all, const SlowSettings& settings, double drag, bool white) {
  SlowSteps out;
  out.attitude_interval = all.attitude_interval;
  const double T = settings.window;
  if (all.steps.size() < 3 || all.steps.back().seconds < 3 * T) return out;
  Integrals integrals(all.steps);
  // Velocities that a filter or a difference of positions has made err alike for a while.
  const double repeats = white ? all.velocity_interval : std::max(all.velocity_interval, 1.0);
  const auto windows = static_cast<std::size_t>(integrals.end() / T);
  std::size_t fine = 0;
  for (std::size_t k = 0; k < windows; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * T;
    while (fine + 1 < all.steps.size() && all.steps[fine].seconds < t) ++fine;
    Step step;
    step.seconds = t;
    step.time = all.steps.front().time + ingest::seconds(t);
    const Sums here = integrals.mean(t - 0.5 * T, t + 0.5 * T);
    step.v = here.velocity;
    step.variance = std::max(1e-4, all.steps[fine].variance * std::min(1.0, repeats / T));
    step.heading = std::arg(here.nose);
    const Sums in = k > 0 ? weighed_input(integrals, t, T, drag) : here;
    step.input.step = k > 0 ? T : 0;
    step.input.lift = in.lift;
    step.input.slope = in.force / in.lift;
    step.input.v_down = in.v_down;
    step.input.heading = std::arg(in.nose);
    step.tilt = std::atan(step.input.slope.norm());
    step.sound = in.unsound <= 0 && here.unsound <= 0 && std::abs(here.v_down) <= settings.most_climb;
    out.sound += step.sound;
    out.steps.push_back(step);
    out.acceleration.push_back(acceleration_over(integrals, t - 0.5 * T, t + 0.5 * T));
  }
  return out;
}

}  // namespace

const SlowSteps& SlowMotion::steps(double latency, double drag) {
  const auto known = made_.find({latency, drag});
  if (known != made_.end()) return known->second;
  auto fast = fast_.find(latency);
  if (fast == fast_.end()) {
    StepSettings s;
    s.latency = latency;
    s.velocity_sd = settings_.velocity_sd;
    fast = fast_.emplace(latency, make_steps(flight_, s)).first;
  }
  const bool white = flight_.velocity.origin == ingest::VelocityOrigin::receiver;
  return made_.emplace(std::pair{latency, drag}, make_steps_of(fast->second, settings_, drag, white)).first->second;
}

std::vector<Balance> force_balances(const ingest::Flight& flight, double latency, double window) {
  StepSettings s;
  s.latency = latency;
  const Steps all = make_steps(flight, s);
  std::vector<Balance> out;
  if (all.steps.size() < 3) return out;
  Integrals integrals(all.steps);
  for (double from = 0; from + window <= integrals.end(); from += 0.5 * window) {
    const double to = from + window;
    const Sums mean = integrals.mean(from, to);
    if (mean.unsound > 0 || std::abs(mean.v_down) > SlowSettings{}.most_climb) continue;
    Balance b;
    b.acceleration = (integrals.velocity(to) - integrals.velocity(from)) / window;
    b.force = mean.force;
    b.velocity = mean.velocity;
    b.nose = {mean.nose.real(), mean.nose.imag()};
    out.push_back(b);
  }
  return out;
}

}  // namespace quadsonde::estimator
