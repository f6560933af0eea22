#include "ingest/motion/fault_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double degree = std::numbers::pi / 180;

ShootingPrior prior_of(const DragArguments& drag) {
  ShootingPrior prior;
  prior.drag = drag.drag;
  prior.drag_log_sd = drag.drag_log_sd;
  prior.trim = prior.gravity * Vector2d(std::tan(drag.trim_pitch_deg * degree), -std::tan(drag.trim_roll_deg * degree));
  prior.trim_sd = Vector2d::Constant(prior.gravity * std::tan(std::max(drag.trim_sd_deg, 0.01) * degree));
  return prior;
}

Matrix2d single(int row, int column) {
  Matrix2d m = Matrix2d::Zero();
  m(row, column) = 1;
  return m;
}

const std::vector<GainMap>& turning_gains() {
  Matrix2d quarter;
  quarter << 0, -1, 1, 0;
  static const std::vector<GainMap> gains{{Matrix2d::Identity(), false}, {quarter, false}};
  return gains;
}

/// The share of the tilt in the motion as a complex number: 1 where all is well.
Vector2d complex_gain(const ShootingFit& fit) { return {1 + fit.gain(0), fit.gain(1)}; }

/// A heading of steady rate within a window instead of the logged one.
Telemetry spinning(const Telemetry& base, const ShootingWindow& window, double angle, double rate) {
  Telemetry out = base;
  const double from = base.velocity_time[window.first] - 2, to = base.velocity_time[window.last] + 2;
  const double middle = 0.5 * (from + to);
  for (std::size_t i = 0; i < out.attitude_time.size(); ++i) {
    if (out.attitude_time[i] < from || out.attitude_time[i] > to) continue;
    out.heading[i] = angle + rate * (out.attitude_time[i] - middle);
    out.slope[i] = turned(out.tilt[i], out.heading[i]);
  }
  return out;
}

/// Low-frequency PSD per axis of s c w_d, the share of a vertical gust (Ornstein-Uhlenbeck) that the slope turns into
/// the horizontal: 2 (c sigma_w)^2 times the integral of R_s(tau) exp(-tau/T), R_s the slope's own autocorrelation. A
/// slope that turns about, as on the legs of a square, lets less of it through than one that stands.
/// @param drag_gust  c sigma_w [m/s2 per unit of slope]
double gust_psd(const Telemetry& t, double drag_gust, double gust_time) {
  Vector2d faded = Vector2d::Zero();  // integral of s(t - tau) exp(-tau/T)
  double product = 0, duration = 0;
  for (std::size_t i = 1; i < t.slope.size(); ++i) {
    const double h = t.attitude_time[i] - t.attitude_time[i - 1];
    if (h > gust_time) faded.setZero();
    if (h <= 0 || h > gust_time) continue;
    faded = std::exp(-h / gust_time) * faded + h * t.slope[i];
    product += h * t.slope[i].dot(faded), duration += h;
  }
  constexpr double axes = 2;
  return duration > 0 ? 2 * drag_gust * drag_gust * std::max(0.0, product / duration) / axes : 0;
}

double span_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

}  // namespace

FaultSearch::FaultSearch(std::shared_ptr<const Telemetry> telemetry, std::vector<ShootingWindow> windows,
                         const DragArguments& drag, const ConsistencySettings& settings, bool velocity_confirmed)
    : telemetry_(std::move(telemetry)),
      drag_(drag),
      settings_(settings),
      confirmed_(velocity_confirmed),
      shooting_(std::move(windows), prior_of(drag), NoiseLevels{}.turbulence_time) {}

void FaultSearch::measure_noise() {
  const Telemetry& t = *telemetry_;
  const auto velocity = difference_noise(t.velocity_time, t.v, t.velocity_interval);
  const auto tilt = difference_noise(t.attitude_time, t.slope, t.attitude_interval);
  noise_known_ = velocity.white() && tilt.white();
  if (drag_.turbulence_sd) noise_.turbulence_sd = *drag_.turbulence_sd;
  if (noise_known_) {
    noise_.velocity_sd = velocity.sd;
    noise_.acceleration_psd = std::pow(standard_gravity * tilt.sd, 2) * t.attitude_interval;
  } else {
    // An autopilot's attitude errs slowly and its velocity is smooth: a beginning, the likelihood finds the rest.
    noise_.velocity_sd = std::max(velocity.sd, 0.05);
    noise_.acceleration_psd = 2 * std::pow(standard_gravity * 0.5 * degree, 2) * 1.0;
  }
  const double c = drag_.drag.linear + 3 * drag_.drag.quadratic;
  noise_.acceleration_psd += gust_psd(t, c * settings_.vertical_gust, settings_.vertical_gust_time);
}

LogReading FaultSearch::reading_of(const TelemetryMap& map, const Telemetry& base) const {
  return {std::make_shared<const Telemetry>(mapped(base, map)), map.velocity_scale, drag_.latency_s + map.latency};
}

std::optional<FaultSearch::Tried> FaultSearch::attempt(FaultCandidate candidate, double size, double extra) {
  Tried tried{std::move(candidate), size, extra, {}, {}};
  tried.reading = reading_of(tried.candidate.undo, *telemetry_);
  NoiseLevels noise = noise_;
  // What scales the tilt scales its measured noise.
  if (noise_known_) noise.acceleration_psd *= std::pow(tried.candidate.undo.tilt_scale, 2);
  auto fit = shooting_.fit(tried.reading, noise);
  if (!fit) return std::nullopt;
  tried.fit = std::move(*fit);
  return tried;
}

void FaultSearch::try_turned_or_scaled() {
  const auto turned_fit =
      shooting_.fit({telemetry_, 1, drag_.latency_s}, noise_, Shooting::Solver::closed_form, turning_gains());
  if (!turned_fit) return;
  const Vector2d gain = complex_gain(*turned_fit);
  const double angle = std::atan2(gain.y(), gain.x());
  if (std::abs(angle) > 3 * degree)
    if (auto t = attempt(turned_by(angle), angle / degree, 1)) tried_.push_back(std::move(*t));
  double factor = gain.norm();
  if (factor < 1e-4 || gain.x() <= 0) return;
  for (int round = 0; round < 2; ++round) {
    LogReading reading{telemetry_, factor, drag_.latency_s};
    const auto again = shooting_.fit(reading, noise_, Shooting::Solver::closed_form, turning_gains());
    if (again) factor *= std::clamp(1 + again->gain(0), 0.5, 2.0);
  }
  if (std::abs(std::log(factor)) > 0.05)
    if (auto t = attempt(scaled_by(factor, confirmed_), factor, 1)) tried_.push_back(std::move(*t));
}

void FaultSearch::try_late() {
  std::optional<Tried> best;
  const auto consider = [&](double late) {
    auto tried = attempt(late_by(late), late, 1);
    if (tried && (!best || tried->fit.chi2 < best->fit.chi2)) best = std::move(tried);
  };
  for (const double late : {-0.6, -0.3, -0.15, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.1}) consider(late);
  for (double stride = 0.08; best && stride > 0.004; stride /= 2) {
    const double middle = best->size;
    consider(middle - stride);
    consider(middle + stride);
  }
  if (best && std::abs(best->size) > 0.02) tried_.push_back(std::move(*best));
}

/// A heading that never changes while tilt and motion turn against each other: per window, a steady turn is fitted.
void FaultSearch::try_missing_heading() {
  if (span_of(telemetry_->heading) > 1 * degree) return;
  Telemetry restored = *telemetry_;
  double rates = 0;
  for (const auto& window : shooting_.windows()) {
    Shooting one({window}, shooting_.prior(), NoiseLevels{}.turbulence_time);
    double best_chi2 = std::numeric_limits<double>::max(), best_rate = 0, best_angle = 0;
    const auto consider = [&](double rate) {
      const LogReading reading{std::make_shared<const Telemetry>(spinning(*telemetry_, window, 0, rate)), 1,
                               drag_.latency_s};
      const auto fit = one.fit(reading, noise_, Shooting::Solver::closed_form, turning_gains());
      if (!fit || fit->chi2 >= best_chi2) return;
      const Vector2d gain = complex_gain(*fit);
      best_chi2 = fit->chi2, best_rate = rate, best_angle = std::atan2(gain.y(), gain.x());
    };
    for (double rate = -60; rate <= 60; rate += 4) consider(rate * degree);
    for (double stride = 2 * degree; stride > 0.2 * degree; stride /= 2) {
      const double middle = best_rate;
      consider(middle - stride);
      consider(middle + stride);
    }
    restored = spinning(restored, window, best_angle, best_rate);
    rates += std::abs(best_rate) / static_cast<double>(shooting_.windows().size());
  }
  FaultCandidate candidate{FaultClass::yaw_not_applied, "heading-missing", "", {}, {}};
  candidate.sentence = fmt::format(
      "the heading stands still while the tilt turns by about {:.0f} degrees a second: it is missing from the attitude",
      rates / degree);
  Tried tried{candidate, rates / degree, 2 * static_cast<double>(shooting_.windows().size()), {}, {}};
  tried.reading = {std::make_shared<const Telemetry>(std::move(restored)), 1, drag_.latency_s};
  auto fit = shooting_.fit(tried.reading, noise_);
  if (!fit) return;
  tried.fit = std::move(*fit);
  tried_.push_back(std::move(tried));
}

void FaultSearch::try_all() {
  tried_.clear();
  named_ = shooting_.fit({telemetry_, 1, drag_.latency_s}, noise_);
  for (const auto& fault : discrete_faults())
    if (auto tried = attempt(fault, 0, 0)) tried_.push_back(std::move(*tried));
  try_turned_or_scaled();
  try_late();
  try_missing_heading();
}

/// The few best of a first look, at another noise.
void FaultSearch::try_again() {
  named_ = shooting_.fit({telemetry_, 1, drag_.latency_s}, noise_);
  std::stable_sort(tried_.begin(), tried_.end(),
                   [](const auto& a, const auto& b) { return a.badness() < b.badness(); });
  constexpr std::size_t few = 6;
  if (tried_.size() > few) tried_.erase(tried_.begin() + few, tried_.end());
  for (auto& tried : tried_) {
    NoiseLevels noise = noise_;
    if (noise_known_) noise.acceleration_psd *= std::pow(tried.candidate.undo.tilt_scale, 2);
    if (auto fit = shooting_.fit(tried.reading, noise)) tried.fit = std::move(*fit);
  }
}

/// The likeliest reading, if its chi2 is `enough` times smaller than that of the log as named.
void FaultSearch::pick(double enough) {
  winner_.reset();
  double least = named_->badness() - 12;
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    if (tried_[i].badness() >= least || tried_[i].fit.ratio() * enough > named_->ratio()) continue;
    least = tried_[i].badness();
    winner_ = i;
  }
}

void FaultSearch::settle_noise(const Tried& at) {
  if (noise_known_ && drag_.turbulence_sd) return;
  NoiseLevels start = noise_;
  const double tilt2 = noise_known_ ? std::pow(at.candidate.undo.tilt_scale, 2) : 1;
  start.acceleration_psd *= tilt2;
  noise_ = shooting_.likeliest_noise(at.reading, at.fit, start, !noise_known_);
  noise_.acceleration_psd /= tilt2;
}

/// Finds noise and winner together. The noise is that of the best reading: with the noise of a faulty one, which
/// takes the fault for noise, every reading looks alike, so there any gain counts, and the winner's noise decides.
bool FaultSearch::fit_within_noise() {
  constexpr double any_gain = 1.02;
  // Where the noise had to be found in the same residual, an improvement by a third is nothing to speak of.
  const double enough = noise_known_ ? 1.1 : 1.4;
  const auto as_named = [&] { return Tried{{}, 0, 0, {telemetry_, 1, drag_.latency_s}, *named_}; };
  if (!noise_known_) settle_noise(as_named());
  try_all();
  if (!named_) return false;
  pick(any_gain);
  for (int round = 0; round < 2; ++round) {
    settle_noise(winner_ ? tried_[*winner_] : as_named());
    try_again();
    if (!named_) return false;
    pick(round == 0 ? any_gain : enough);
  }
  if (winner_) return true;
  settle_noise(as_named());
  try_again();
  return named_.has_value();
}

bool FaultSearch::run() {
  measure_noise();
  named_ = shooting_.fit({telemetry_, 1, drag_.latency_s}, noise_);
  if (!named_ || !fit_within_noise()) return false;
  if (winner_) {
    const Tried& w = tried_[*winner_];
    best_ = Found{w.candidate, w.size, {}};
    for (const auto& t : tried_)
      if (&t != &w && t.candidate.fault != w.candidate.fault && t.fit.ratio() < 1.05 * w.fit.ratio())
        best_->alternatives.push_back(t.candidate.sentence);
  }
  foretell();
  return true;
}

void FaultSearch::foretell() {
  const LogReading base = winner_ ? tried_[*winner_].reading : LogReading{telemetry_, 1, drag_.latency_s};
  const double restored = winner_ ? tried_[*winner_].fit.ratio() : named_->ratio();
  for (const auto& fault : typical_faults()) {
    LogReading reading = base;
    reading.telemetry = std::make_shared<const Telemetry>(mapped(*base.telemetry, fault.commit));
    reading.velocity_scale *= fault.commit.velocity_scale;
    reading.latency += fault.commit.latency;
    const auto fit = shooting_.fit(reading, noise_);
    if (fit) foretold_.push_back({fault.id, fault.sentence, fit->ratio() / restored});
  }
}

namespace {

/// Means of the thrust's pull over the second around each velocity sample.
std::vector<Vector2d> smoothed_pull(const Telemetry& t, double latency) {
  std::vector<Vector2d> out;
  std::size_t begin = 0;
  for (const double time : t.velocity_time) {
    while (begin + 1 < t.attitude_time.size() && t.attitude_time[begin] + latency < time - 0.5) ++begin;
    Vector2d sum = Vector2d::Zero();
    double n = 0;
    for (std::size_t k = begin; k < t.attitude_time.size() && t.attitude_time[k] + latency <= time + 0.5; ++k)
      sum += t.slope[k], n += 1;
    out.push_back(n > 0 ? Vector2d(standard_gravity * sum / n) : Vector2d::Zero());
  }
  return out;
}

struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  void add(double a, double b) { n += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b; }
  double correlation() const {
    const double vx = xx - x * x / n, vy = yy - y * y / n;
    return n > 2 && vx > 0 && vy > 0 ? (xy - x * y / n) / std::sqrt(vx * vy) : 0;
  }
};

}  // namespace

void FaultSearch::follow_axes(ConsistencyReport& report) {
  const Telemetry& t = *telemetry_;
  std::vector<double> north, east;
  for (const auto& v : t.v) north.push_back(v.x()), east.push_back(v.y());
  const auto acc_n = smoothed_slope(t.velocity_time, north), acc_e = smoothed_slope(t.velocity_time, east);
  const auto pull = smoothed_pull(t, drag_.latency_s);
  Moments own[4], other[4];
  for (const auto& window : shooting_.windows())
    for (std::size_t i = window.first; i <= window.last; ++i) {
      const Vector2d a(acc_n[i], acc_e[i]);
      const double psi = interpolated(t.attitude_time, t.heading, t.velocity_time[i]);
      const Vector2d ah = turned(a, -psi), ph = turned(pull[i], -psi);
      for (int k = 0; k < 2; ++k) {
        own[k].add(pull[i](k), a(k)), other[k].add(pull[i](1 - k), a(k));
        own[2 + k].add(ph(k), ah(k)), other[2 + k].add(ph(1 - k), ah(k));
      }
    }
  const char* names[] = {"north", "east", "forward", "right"};
  const LogReading restored = winner_ ? tried_[*winner_].reading : LogReading{telemetry_, 1, drag_.latency_s};
  for (int frame = 0; frame < 2; ++frame) {
    const std::vector<GainMap> gains{{single(0, 0), frame == 1}, {single(1, 1), frame == 1}};
    const auto fit = shooting_.fit(restored, noise_, Shooting::Solver::closed_form, gains);
    for (int k = 0; k < 2; ++k) {
      const int i = 2 * frame + k;
      FollowedAxis axis{
          names[i], std::sqrt(own[i].yy / std::max(own[i].n, 1.0)), own[i].correlation(), other[i].correlation(), 1, 1};
      if (fit) {
        axis.gain = 1 + fit->gain(k);
        axis.gain_sd = std::sqrt(fit->gain_covariance(k, k) * std::max(1.0, fit->ratio()));
      }
      report.axes.push_back(axis);
    }
  }
}

void FaultSearch::confirm(ConsistencyReport& report) {
  const auto most = static_cast<std::size_t>(std::max(1.0, settings_.confirmed_windows));
  const auto& all = shooting_.windows();
  std::vector<ShootingWindow> some;
  const std::size_t count = std::min(most, all.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
  Shooting integrated(some, shooting_.prior(), NoiseLevels{}.turbulence_time);
  const auto ratio = [&](const LogReading& reading, const NoiseLevels& noise) -> std::optional<double> {
    const auto start = integrated.fit(reading, noise);
    if (!start) return std::nullopt;
    const auto fit = integrated.fit(reading, noise, Shooting::Solver::cvodes, {}, &*start);
    return fit ? std::optional(fit->ratio()) : std::nullopt;
  };
  report.chi2_integrated = ratio({telemetry_, 1, drag_.latency_s}, noise_);
  report.chi2_restored_integrated = report.chi2_integrated;
  if (!winner_) return;
  const auto& w = tried_[*winner_];
  NoiseLevels noise = noise_;
  if (noise_known_) noise.acceleration_psd *= std::pow(w.candidate.undo.tilt_scale, 2);
  report.chi2_restored_integrated = ratio(w.reading, noise);
}

void FaultSearch::fill(ConsistencyReport& report) {
  const ShootingFit& restored = winner_ ? tried_[*winner_].fit : *named_;
  report.chi2_per_dof = named_->ratio();
  report.chi2_restored = restored.ratio();
  report.noise_is_known = noise_known_;
  report.noise = noise_;
  report.windows = named_->window_ratio;
  report.drag_linear_per_s = drag_.drag.linear * std::exp(restored.drag_log_factor);
  report.trim_pitch_deg = std::atan(restored.trim.x() / standard_gravity) / degree;
  report.trim_roll_deg = -std::atan(restored.trim.y() / standard_gravity) / degree;
  follow_axes(report);
  confirm(report);
}

}  // namespace quadsonde::ingest
