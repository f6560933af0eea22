#include "estimator/smoother/steps.h"

#include <algorithm>
#include <cmath>

#include "ingest/flight/rotation.h"
#include "ingest/motion/drag.h"

namespace quadsonde::estimator {
namespace {

using ingest::LogTime;

double median_interval(const std::vector<LogTime>& time) {
  if (time.size() < 2) return 0.1;
  std::vector<double> gaps;
  gaps.reserve(time.size());
  for (std::size_t i = 1; i < time.size(); ++i)
    if (time[i] > time[i - 1]) gaps.push_back(ingest::to_seconds(time[i] - time[i - 1]));
  if (gaps.empty()) return 0.1;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return std::max(*middle, 1e-4);
}

/// The attitude's course as columns: seconds, thrust slope, unwrapped heading, tilt.
struct SlopeColumn {
  std::vector<double> time, heading, tilt;
  std::vector<Eigen::Vector2d> slope;
  double longest_hole = 0.5;  ///< [s]; a longer one is a gap

  std::size_t size() const { return time.size(); }
};

SlopeColumn slope_column(const ingest::Stream<Eigen::Quaterniond>& attitude, LogTime origin, double interval) {
  SlopeColumn column;
  column.longest_hole = std::max(0.5, 5 * interval);
  double turned = 0;
  for (std::size_t i = 0; i < attitude.size(); ++i) {
    const double t = ingest::to_seconds(attitude.time[i] - origin);
    if (!column.time.empty() && t <= column.time.back()) continue;  // a repeated time adds nothing
    const Eigen::Vector3d n = attitude.value[i] * Eigen::Vector3d::UnitZ();
    const double psi = ingest::heading(attitude.value[i]);
    turned = column.heading.empty() ? psi : turned + ingest::wrap_angle(psi - turned);
    column.time.push_back(t);
    column.heading.push_back(turned);
    column.tilt.push_back(std::acos(std::clamp(n.z(), -1.0, 1.0)));
    // Beyond 80 degrees the slope is meaningless; such steps are refused by their tilt.
    column.slope.push_back(n.z() > 0.17 ? ingest::thrust_slope<double>(n) : Eigen::Vector2d::Zero());
  }
  return column;
}

/// Means over [from, to]; `at` is where the search begins, and is moved forward.
class SlopeWalker {
 public:
  SlopeWalker(const SlopeColumn& column, double drag) : c_(column), drag_(drag) {}

  /// False if the attitude does not cover the interval without a hole.
  bool mean(double from, double to, StepInput<double>& in, Step& step) {
    while (at_ + 1 < c_.size() && c_.time[at_ + 1] <= from) ++at_;
    // Half a sample beyond either end is extrapolated by holding the last value.
    if (c_.size() < 2 || from < c_.time.front() - c_.longest_hole || to > c_.time.back() + c_.longest_hole) return false;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weights = 0, tilt = 0;
    std::size_t i = at_;
    double a = from;
    while (a < to) {
      const bool last = i + 1 >= c_.size();
      const double b = last ? to : std::min(to, std::max(c_.time[i + 1], a));
      if (!last && c_.time[i + 1] - c_.time[i] > c_.longest_hole) return false;
      const double middle = 0.5 * (a + b);
      const double w = (b - a) * std::exp(-drag_ * (to - middle));
      sum += w * slope_at(i, middle);
      weights += w;
      tilt = std::max(tilt, c_.tilt[i]);
      if (last) break;
      a = b;
      if (b >= c_.time[i + 1]) ++i;
    }
    in.slope = weights > 0 ? Eigen::Vector2d(sum / weights) : slope_at(i, to);
    in.slope_rate = (slope_at(i, to) - slope_at(at_, from)) / std::max(to - from, 1e-6);
    in.heading = heading_at(at_, 0.5 * (from + to));
    step.heading = heading_at(i, to);
    step.tilt = std::max(tilt, c_.tilt[i]);
    return true;
  }

 private:
  double part(std::size_t i, double t) const {
    return std::clamp((t - c_.time[i]) / (c_.time[i + 1] - c_.time[i]), 0.0, 1.0);
  }
  Eigen::Vector2d slope_at(std::size_t i, double t) const {
    if (i + 1 >= c_.size()) return c_.slope.back();
    return c_.slope[i] + part(i, t) * (c_.slope[i + 1] - c_.slope[i]);
  }
  double heading_at(std::size_t i, double t) const {
    while (i + 1 < c_.size() && c_.time[i + 1] < t) ++i;
    if (i + 1 >= c_.size()) return c_.heading.back();
    return c_.heading[i] + part(i, t) * (c_.heading[i + 1] - c_.heading[i]);
  }

  const SlopeColumn& c_;
  double drag_;
  std::size_t at_ = 0;
};

/// Value and slope of the down velocity: a straight line through the samples of a second.
class DownVelocity {
 public:
  DownVelocity(const ingest::VelocityStream& velocity, LogTime origin, bool causal) : causal_(causal) {
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      time_.push_back(ingest::to_seconds(velocity.time[i] - origin));
      v_.push_back(velocity.value[i].z());
    }
    noise_ = sample_noise();
  }
  struct Line {
    double value = 0, slope = 0, residual = 0;
  };
  Line at(std::size_t i) {
    const double t0 = time_[i], half = 0.5001;
    if (!causal_) return fit(i, t0 - half, t0 + half);
    // Looking back only, the slope is half a second late. Where the line does not fit the past second, the vehicle has
    // begun to brake or to pull up, and a noisier slope of less age errs less.
    const Line line = fit(i, t0 - 2 * half, t0);
    return line.residual > 1.7 * noise_ ? fit(i, t0 - 0.4001, t0) : line;
  }

 private:
  Line fit(std::size_t i, double begin, double end) {
    while (first_ < i && time_[first_] < time_[i] - 1.1) ++first_;
    double n = 0, st = 0, stt = 0, sv = 0, stv = 0, svv = 0;
    for (std::size_t k = first_; k < time_.size() && time_[k] <= end; ++k) {
      if (time_[k] < begin) continue;
      const double t = time_[k] - time_[i], v = v_[k] - v_[i];
      n += 1, st += t, stt += t * t, sv += v, stv += t * v, svv += v * v;
    }
    const double spread = stt - st * st / n;
    if (n < 3 || spread < 1e-9) return {v_[i], two_point_slope(i), 0};
    const double slope = (stv - st * sv / n) / spread;
    const double left = svv - sv * sv / n - slope * slope * spread;
    return {v_[i] + (sv - slope * st) / n, slope, std::sqrt(std::max(0.0, left) / n)};
  }
  /// White noise of the samples, from their second differences: whatever moves slowly drops out.
  double sample_noise() const {
    std::vector<double> bends;
    for (std::size_t i = 1; i + 1 < v_.size(); ++i) bends.push_back(std::abs(v_[i + 1] - 2 * v_[i] + v_[i - 1]));
    if (bends.empty()) return 0.1;
    const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
    std::nth_element(bends.begin(), middle, bends.end());
    return std::max(0.02, 1.4826 * *middle / std::sqrt(6.0));
  }
  double two_point_slope(std::size_t i) const {
    if (i == 0) return 0;
    const double dt = time_[i] - time_[i - 1];
    return dt > 0 ? (v_[i] - v_[i - 1]) / dt : 0;
  }
  bool causal_;
  std::vector<double> time_, v_;
  double noise_ = 0.1;
  std::size_t first_ = 0;
};

}  // namespace

Steps make_steps(const ingest::Flight& flight, const StepSettings& settings) {
  const auto& velocity = flight.velocity;
  Steps out;
  out.attitude_interval = median_interval(flight.attitude.time);
  out.velocity_interval = median_interval(velocity.time);
  if (velocity.empty() || flight.attitude.empty()) return out;
  const LogTime origin = velocity.time.front();
  const SlopeColumn column = slope_column(flight.attitude, origin, out.attitude_interval);
  SlopeWalker walker(column, settings.drag);
  DownVelocity down(velocity, origin, settings.causal);
  out.steps.reserve(velocity.size());
  DownVelocity::Line before{};
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    Step step;
    step.time = velocity.time[i];
    step.seconds = ingest::to_seconds(step.time - origin);
    step.v = velocity.value[i].head<2>();
    const bool stated = !velocity.sd.empty() && std::isfinite(velocity.sd[i]);
    const double sd = stated ? std::max(velocity.sd[i], 0.05) : settings.velocity_sd;
    step.variance = sd * sd;
    const auto now = down.at(i);
    const double since = out.steps.empty() ? 0 : step.seconds - out.steps.back().seconds;
    if (!out.steps.empty() && since <= 0) continue;  // the same instant twice
    StepInput<double>& in = step.input;
    in.step = since;
    in.v_down = out.steps.empty() ? now.value : 0.5 * (now.value + before.value);
    in.lift = settings.gravity - (out.steps.empty() ? now.slope : 0.5 * (now.slope + before.slope));
    before = now;
    const double to = step.seconds - settings.latency;
    const bool covered = walker.mean(out.steps.empty() ? to - 1e-3 : to - since, to, in, step);
    constexpr double tilt_limit = 0.7853981633974483;
    step.gap_before = since > settings.max_gap;
    step.sound = covered && step.tilt < tilt_limit && !step.gap_before;
    if (!covered)
      step.fault = Reason::no_attitude;
    else if (step.tilt >= tilt_limit)
      step.fault = Reason::tilt_over_45_deg;
    else if (step.gap_before)
      step.fault = Reason::data_gap;
    out.steps.push_back(step);
  }
  return out;
}

}  // namespace quadsonde::estimator
