#include "estimator/smoother/likelihood.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace quadsonde::estimator {
namespace {

struct Peak {
  double at, value, curvature;
};

/// Vertex of the parabola through three points; the middle one is the highest.
Peak vertex(double a, double fa, double b, double fb, double c, double fc) {
  const double left = (fb - fa) / (b - a), right = (fc - fb) / (c - b);
  const double curvature = 2 * (right - left) / (c - a);
  if (!(curvature < 0)) return {b, fb, curvature};
  const double at = std::clamp(0.5 * (a + b) - left / curvature, a, c);
  return {at, fb, curvature};
}

/// Highest point of f on [low, high]: a coarse scan, then parabolas through the best three. f is smooth but noisy
/// (the gate drops samples), so nothing finer is asked for.
double maximise(const std::function<double(double)>& f, double low, double high, int scan, int refine) {
  std::vector<std::pair<double, double>> seen;
  for (int i = 0; i < scan; ++i) {
    const double at = low + (high - low) * i / (scan - 1);
    seen.emplace_back(at, f(at));
  }
  const auto best_index = [&] {
    return static_cast<std::size_t>(
        std::max_element(seen.begin(), seen.end(), [](auto& p, auto& q) { return p.second < q.second; }) - seen.begin());
  };
  for (int i = 0; i < refine; ++i) {
    const std::size_t best = best_index();
    if (best == 0 || best + 1 == seen.size()) break;
    const Peak peak = vertex(seen[best - 1].first, seen[best - 1].second, seen[best].first, seen[best].second,
                             seen[best + 1].first, seen[best + 1].second);
    if (std::abs(peak.at - seen[best].first) < 1e-3 * (high - low)) break;
    const auto place = std::lower_bound(seen.begin(), seen.end(), std::pair{peak.at, -1e300});
    seen.insert(place, {peak.at, f(peak.at)});
  }
  return seen[best_index()].first;
}

}  // namespace

double most_likely_turbulence(const std::vector<Step>& steps, PassSettings settings) {
  settings.keep_trace = false;
  const auto likelihood = [&](double ln_sd) {
    settings.model.turbulence_sd = std::exp(ln_sd);
    return run_forward(steps, settings).log_likelihood;
  };
  return std::exp(maximise(likelihood, std::log(0.03), std::log(4.0), 5, 4));
}

ClimbLawEstimate most_likely_climb_law(const std::vector<Step>& steps, PassSettings settings, double prior,
                                       double prior_sd) {
  settings.keep_trace = false;
  const auto posterior = [&](double alpha) {
    settings.model.drag.climb_linear = alpha;
    const double off = (alpha - prior) / prior_sd;
    return run_forward(steps, settings).log_likelihood - 0.5 * off * off;
  };
  double at = prior, width = prior_sd;
  double curvature = -1 / (prior_sd * prior_sd);
  for (int i = 0; i < 3; ++i) {
    const double middle = posterior(at), low = posterior(at - width), high = posterior(at + width);
    const double slope = (high - low) / (2 * width);
    const double bend = (high - 2 * middle + low) / (width * width);
    if (!(bend < 0)) break;
    curvature = bend;
    const double move = std::clamp(-slope / bend, -3 * prior_sd, 3 * prior_sd);
    at += move;
    width = std::max(1 / std::sqrt(-bend), prior_sd / 20);
    if (std::abs(move) < 0.1 / std::sqrt(-bend)) break;
  }
  return {at, 1 / std::sqrt(-curvature)};
}

bool flies_up_and_down(const std::vector<Step>& steps) {
  double height = 0, up = 0, down = 0;
  double up_low = 1e9, up_high = -1e9, down_low = 1e9, down_high = -1e9;
  for (const auto& step : steps) {
    if (!step.sound) continue;
    const double climb = -step.input.v_down;
    height += climb * step.input.step;
    if (climb > 0.3) up += step.input.step, up_low = std::min(up_low, height), up_high = std::max(up_high, height);
    if (climb < -0.3)
      down += step.input.step, down_low = std::min(down_low, height), down_high = std::max(down_high, height);
  }
  const double common = std::min(up_high, down_high) - std::max(up_low, down_low);
  return up >= 5 && down >= 5 && common >= 10;
}

}  // namespace quadsonde::estimator
