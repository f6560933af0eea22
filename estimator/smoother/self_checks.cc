#include "estimator/smoother/self_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "estimator/smoother/chi_square.h"
#include "estimator/smoother/window_means.h"

namespace quadsonde::estimator {
namespace {

using Complex = std::complex<double>;

constexpr double level_range = 20;   // m; within it the wind counts as that of one height
constexpr double shortest = 120;     // s; less says little about slow errors

const WindEstimate* wind_at(const WindSeries& series, std::size_t k) {
  return std::get_if<WindEstimate>(&series.points[k].wind);
}
Complex north_east(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }

/// Height range and duration of the points with a wind.
struct Extent {
  double range = 0, seconds = 0;
};
Extent extent_of(const WindSeries& series) {
  double low = 1e300, high = -1e300;
  const WindPoint *first = nullptr, *last = nullptr;
  for (const auto& point : series.points) {
    if (!std::holds_alternative<WindEstimate>(point.wind)) continue;
    if (!first) first = &point;
    last = &point;
    const auto height = point.height_msl   ? std::optional(point.height_msl->m)
                        : point.height_agl ? std::optional(point.height_agl->m)
                                           : std::nullopt;
    if (height) low = std::min(low, *height), high = std::max(high, *height);
  }
  if (!first) return {};
  return {high > low ? high - low : 0, ingest::to_seconds(last->time - first->time)};
}

/// The steps in which the nose turned once round, one after the other: [first, last).
std::vector<std::pair<std::size_t, std::size_t>> whole_turns(const WindSeries& series, const std::vector<Step>& steps) {
  std::vector<std::pair<std::size_t, std::size_t>> turns;
  double turned = 0;
  std::size_t first = 0, previous = 0;
  bool running = false;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!wind_at(series, k)) {
      running = false;
      continue;
    }
    if (!running) {
      running = true, turned = 0, first = k;
    } else {
      turned += std::remainder(steps[k].heading - steps[previous].heading, 2 * std::numbers::pi);
    }
    previous = k;
    if (std::abs(turned) < 2 * std::numbers::pi) continue;
    turns.emplace_back(first, k);
    turned = 0, first = k;
  }
  return turns;
}

/// r of w = p + q t + r exp(i psi) by least squares over one turn: what turns with the nose.
Complex turning_part(const WindSeries& series, const std::vector<Step>& steps, std::size_t first, std::size_t last) {
  Eigen::MatrixXcd A(static_cast<Eigen::Index>(last - first), 3);
  Eigen::VectorXcd w(A.rows());
  for (std::size_t k = first; k < last; ++k) {
    const auto row = static_cast<Eigen::Index>(k - first);
    const double t = (steps[k].seconds - steps[first].seconds) / (steps[last].seconds - steps[first].seconds) - 0.5;
    A.row(row) << 1.0, t, std::polar(1.0, steps[k].heading);
    w(row) = north_east(wind_at(series, k)->v_NA_N);
  }
  const Eigen::Matrix3cd normal = A.adjoint() * A;
  const Eigen::Vector3cd solution = normal.ldlt().solve(Eigen::Vector3cd(A.adjoint() * w));
  return solution(2);
}

/// Standard error of sum(score): their autocovariance up to twice the turbulence's time, with Bartlett's weights.
double score_sd(const std::vector<double>& score, double interval, double time_u) {
  const auto n = score.size();
  const auto lags = std::min<std::size_t>(n / 3, static_cast<std::size_t>(2 * time_u / std::max(interval, 1e-3)));
  // Every tenth lag carries the sum well enough: the autocovariance is smooth over seconds.
  const std::size_t stride = std::max<std::size_t>(1, lags / 40);
  double sum = 0;
  for (std::size_t lag = 0; lag <= lags; lag += stride) {
    double covariance = 0;
    for (std::size_t k = lag; k < n; ++k) covariance += score[k] * score[k - lag];
    const double weight = 1 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    sum += (lag == 0 ? 1.0 : 2.0 * static_cast<double>(stride)) * weight * covariance;
  }
  return std::sqrt(std::max(0.0, sum));
}

}  // namespace

SelfCheck heading_crosstalk(const WindSeries& series, const std::vector<Step>& steps, double sigma_u, double time_u) {
  SelfCheck check{"heading_crosstalk_m_s", "", 0, {}, {}, false, true, Reason::crosstalk_heading};
  const auto turns = whole_turns(series, steps);
  Complex sum = 0;
  double seconds = 0;
  for (const auto& [first, last] : turns) {
    const double span = steps[last].seconds - steps[first].seconds;
    if (last - first < 8 || span <= 0) continue;
    sum += span * turning_part(series, steps, first, last);
    seconds += span;
  }
  if (seconds <= 0) {
    check.sentence = "whether the wind turns with the nose cannot be told: the nose made no whole turn";
    return check;
  }
  check.value = std::abs(sum / seconds);
  // Turbulence has a part at the frequency of the turns by chance: both axes' spectrum there, over the time.
  const double omega = 2 * std::numbers::pi * static_cast<double>(turns.size()) / seconds;
  const double spectrum = 2 * sigma_u * sigma_u * time_u / (1 + std::pow(omega * time_u, 2));
  check.sd = std::sqrt(2 * spectrum / seconds);
  check.limit = std::max(0.1, 3 * *check.sd);
  check.judged = turns.size() >= 3;
  check.passed = check.value <= *check.limit;
  check.sentence = fmt::format("{:.3f} m/s of the wind turns with the nose over {} whole turns (limit {:.2f})",
                               check.value, turns.size(), *check.limit);
  return check;
}

SelfCheck velocity_crosstalk(const WindSeries& series, const std::vector<Step>& steps, double excitation, double time_u) {
  SelfCheck check{"velocity_crosstalk", "", 0, {}, {}, false, true, Reason::crosstalk_velocity};
  const auto extent = extent_of(series);
  Complex mean_w = 0, mean_v = 0;
  double n = 0;
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (const auto* wind = wind_at(series, k)) mean_w += north_east(wind->v_NA_N), mean_v += north_east(steps[k].v), ++n;
  if (n < 10) return check;
  mean_w /= n, mean_v /= n;
  double cross = 0, square = 0;
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (const auto* wind = wind_at(series, k)) {
      const Complex dv = north_east(steps[k].v) - mean_v;
      cross += std::real((north_east(wind->v_NA_N) - mean_w) * std::conj(dv));
      square += std::norm(dv);
    }
  if (square <= 0) return check;
  check.value = cross / square;
  std::vector<double> score;
  score.reserve(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (const auto* wind = wind_at(series, k)) {
      const Complex dv = north_east(steps[k].v) - mean_v;
      score.push_back(std::real((north_east(wind->v_NA_N) - mean_w - check.value * dv) * std::conj(dv)));
    }
  check.sd = score_sd(score, extent.seconds / n, time_u) / square;
  check.limit = 3 * *check.sd;
  check.judged = excitation >= 1 && extent.range <= level_range && extent.seconds >= shortest;
  check.passed = std::abs(check.value) <= *check.limit;
  check.sentence = fmt::format("{:+.1f} +- {:.1f} % of the vehicle's own velocity shows up as wind{}", 100 * check.value,
                               100 * *check.sd,
                               check.judged ? "" : " (not judged: only a level flight that moves about can show it)");
  return check;
}

SelfCheck split_halves(const WindSeries& series, double sigma_u, double time_u) {
  SelfCheck check{"split_halves_m_s", "", 0, {}, {}, false, true, Reason::halves_differ};
  const auto extent = extent_of(series);
  std::vector<Eigen::Vector2d> winds;
  for (std::size_t k = 0; k < series.points.size(); ++k)
    if (const auto* wind = wind_at(series, k)) winds.push_back(wind->v_NA_N);
  if (winds.size() < 20) return check;
  const std::size_t half = winds.size() / 2;
  Eigen::Vector2d first = Eigen::Vector2d::Zero(), second = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < half; ++k) first += winds[k] / static_cast<double>(half);
  for (std::size_t k = winds.size() - half; k < winds.size(); ++k) second += winds[k] / static_cast<double>(half);
  check.value = (first - second).norm();
  // Turbulence sampling of both halves, and weather: half a metre per second may well have changed.
  constexpr double weather = 0.5;
  const double sampling = 2 * sigma_u * sigma_u * std::min(1.0, 2 * time_u / std::max(1.0, extent.seconds / 2));
  check.sd = std::sqrt(sampling + weather * weather);
  check.limit = 4.3 * *check.sd;  // chi-square(2), p 1e-4
  check.judged = extent.range <= level_range && extent.seconds >= shortest;
  check.passed = check.value <= *check.limit;
  check.sentence = fmt::format("the two halves of the flight differ by {:.2f} m/s{}", check.value,
                               check.judged ? fmt::format(" (limit {:.2f})", *check.limit)
                                            : " (not judged: a climb or a short flight)");
  return check;
}

SelfCheck innovation_size(const ForwardPass& pass) {
  SelfCheck check{"nis_mean", "", 0, {}, 4.0, false, true, Reason::noise_misfit};
  if (pass.updates == 0) return check;
  check.value = pass.nis_sum / static_cast<double>(pass.updates);
  check.judged = pass.updates >= 100;
  check.passed = check.value <= *check.limit;
  check.sentence = fmt::format(
      "mean normalised innovation {:.2f}: 2 when the noise is as stated, less where a receiver states too much",
      check.value);
  return check;
}

SelfCheck innovation_whiteness(const ForwardPass& pass) {
  SelfCheck check{"innovation_autocorrelation", "", 0, {}, {}, false, true, Reason::noise_misfit};
  double square = 0, product = 0, n = 0;
  for (std::size_t k = 0; k < pass.whitened.size(); ++k) {
    square += pass.whitened[k].squaredNorm();
    if (k > 0) product += pass.whitened[k].dot(pass.whitened[k - 1]);
    n += pass.whitened[k].squaredNorm() > 0;
  }
  if (square <= 0 || n < 10) return check;
  check.value = product / square;
  check.sd = 1 / std::sqrt(2 * n);
  check.sentence = fmt::format("innovations follow each other with a correlation of {:+.2f} (0 when they are white)",
                               check.value);
  return check;
}

SelfCheck hold_out(std::vector<Step> steps, PassSettings settings, const ConsiderCovariance& consider) {
  SelfCheck check{"hold_out_chi2_per_dof", "", 0, {}, {}, false, true, Reason::hold_out_failed};
  constexpr double window = 20, unknown = 1e8;
  constexpr int every = 5;
  const auto original = steps;
  std::vector<std::size_t> middles;
  int previous = -1;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const int index = static_cast<int>(steps[k].seconds / window);
    if (index % every != every / 2 || steps.back().seconds < (index + 1) * window + window / 2) continue;
    steps[k].variance = unknown;
    if (index == previous || steps[k].seconds < (index + 0.5) * window) continue;
    previous = index;
    middles.push_back(k);
  }
  settings.keep_trace = true;
  settings.jump_test = false;
  auto trace = run_forward(steps, settings).trace;
  smooth(trace);
  double chi2 = 0;
  int dof = 0;
  for (const auto k : middles) {
    const auto at = trace.of_point[k];
    if (at < 0 || !original[k].sound) continue;
    const auto& s = trace.steps[static_cast<std::size_t>(at)];
    const Eigen::Vector2d error = original[k].v - s.x.segment<2>(i_v);
    const Eigen::Matrix<double, 2, consider_count> S = s.S.middleRows<2>(i_v);
    const Eigen::Matrix2d C = s.P.block<2, 2>(i_v, i_v) + S * consider * S.transpose() +
                              settings.velocity_scale * original[k].variance * Eigen::Matrix2d::Identity();
    chi2 += error.dot(C.inverse() * error);
    dof += 2;
  }
  if (dof == 0) {
    check.sentence = "too short to keep a window of 20 s from the filter and foretell it";
    return check;
  }
  check.value = chi2 / dof;
  check.judged = true;
  check.passed = chi_square_tail(chi2, dof) > 1e-3;
  check.sentence = fmt::format("velocities kept from the filter were foretold: chi-square {:.1f} for {} degrees of freedom",
                               chi2, dof);
  return check;
}

namespace {
Eigen::Vector3d itself(const Eigen::Vector3d& f) { return f; }
}  // namespace

SelfCheck accelerometer_path(const ingest::Flight& flight, const ingest::DragLaw<double>& law,
                             const WindSeries& series, const std::vector<Step>& steps) {
  SelfCheck check{"accelerometer_path_m_s", "", 0, {}, {}, false, true, Reason::accelerometer_differs};
  constexpr double window = 5;
  if (flight.accelerometer.empty()) {
    check.sentence = "no accelerometer to hold the attitude against";
    return check;
  }
  WindowMeans<Eigen::Vector3d, Eigen::Vector3d> forces(flight.accelerometer, itself);
  // In windows: drag per mass along forward and right as the attitude's wind has it, and as the accelerometer reads it.
  std::vector<Eigen::Vector2d> told, read;
  double drag = 0;
  std::size_t k = 0;
  while (k < steps.size()) {
    const std::size_t first = k;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0, c_sum = 0;
    for (; k < steps.size() && steps[k].seconds < steps[first].seconds + window; ++k) {
      const auto& point = series.points[k];
      if (!steps[k].sound || !point.v_AB_N) continue;
      const Eigen::Vector2d a = *point.v_AB_N;
      const double c = ingest::drag_coefficient(law, std::hypot(a.norm(), point.v_up), point.v_up);
      const double cos = std::cos(steps[k].heading), sin = std::sin(steps[k].heading);
      // In-plane airspeed: the horizontal one turned to the nose, and the climb's part through the tilt.
      const Eigen::Vector2d s(cos * steps[k].input.slope.x() + sin * steps[k].input.slope.y(),
                              -sin * steps[k].input.slope.x() + cos * steps[k].input.slope.y());
      sum += -c * (Eigen::Vector2d(cos * a.x() + sin * a.y(), -sin * a.x() + cos * a.y()) - s * point.v_up);
      c_sum += c;
      ++count;
    }
    const auto force = forces.over(series.points[first].time, series.points[k - 1].time, 10);
    if (count < 10 || !force || k - first > 1.1 * count) continue;
    told.push_back(sum / count);
    read.push_back(force->head<2>());
    drag += c_sum / count;
  }
  const auto n = static_cast<double>(told.size());
  if (told.size() < 8) {
    check.sentence = "too short to hold the accelerometer against the attitude";
    return check;
  }
  drag /= n;
  Eigen::Vector2d mean_told = Eigen::Vector2d::Zero(), mean_read = mean_told;
  for (std::size_t i = 0; i < told.size(); ++i) mean_told += told[i] / n, mean_read += read[i] / n;
  double tt = 0, tr = 0, rr = 0, off = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    const Eigen::Vector2d t = told[i] - mean_told, r = read[i] - mean_read;
    tt += t.squaredNorm() / (2 * n), tr += t.dot(r) / (2 * n), rr += r.squaredNorm() / (2 * n);
    off += (r - t).squaredNorm() / (2 * n);
  }
  check.value = std::sqrt(off) / drag;
  const double moved = std::sqrt(tt) / drag, correlation = tt > 0 && rr > 0 ? tr / std::sqrt(tt * rr) : 0;
  check.limit = std::max(1.0, 0.5 * moved);
  check.judged = moved >= 1;
  check.passed = check.value <= *check.limit;
  check.sentence = fmt::format(
      "the accelerometer's airspeed differs from the attitude's by {:.2f} m/s per axis over {:g} s (correlation {:.2f}, "
      "slope {:.2f}){}",
      check.value, window, correlation, tt > 0 ? tr / tt : 0,
      check.judged ? fmt::format(" (limit {:.1f})", *check.limit)
                   : " (not judged: the airspeed along the nose hardly changes)");
  return check;
}

}  // namespace quadsonde::estimator
