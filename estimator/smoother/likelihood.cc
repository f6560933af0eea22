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

double most_likely_velocity_scale(const std::vector<Step>& steps, PassSettings settings) {
  settings.keep_trace = false;
  const auto likelihood = [&](double ln_scale) {
    settings.velocity_scale = std::exp(ln_scale);
    return run_forward(steps, settings).log_likelihood;
  };
  return std::exp(maximise(likelihood, 0, std::log(100.0), 5, 3));
}

ClimbLaw most_likely_climb_law(const std::vector<Step>& steps, PassSettings settings, const ClimbLaw& prior,
                               ClimbEvidence evidence) {
  if (evidence == ClimbEvidence::none) return prior;
  settings.keep_trace = false;
  settings.model.noise_law = settings.model.drag;
  settings.model.has_noise_law = true;
  const Eigen::Matrix2d prior_information = prior.covariance.inverse();
  const bool both = evidence == ClimbEvidence::with_pauses;
  const auto posterior = [&](const Eigen::Vector2d& law) {
    settings.model.drag.climb_linear = law.x();
    settings.model.drag.climb_quadratic = law.y();
    const Eigen::Vector2d off = law - prior.value;
    return run_forward(steps, settings).log_likelihood - 0.5 * off.dot(prior_information * off);
  };
  ClimbLaw law = prior;
  Eigen::Vector2d width = 0.5 * prior.covariance.diagonal().cwiseSqrt();
  const Eigen::Vector2d prior_sd = prior.covariance.diagonal().cwiseSqrt();
  Eigen::Matrix2d information = prior_information;
  for (int round = 0; round < 4; ++round) {
    // Newton on central differences; without pauses g2 stays where it is.
    const double middle = posterior(law.value);
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    Eigen::Matrix2d bend = -prior_information;
    const auto at = [&](double x, double y) {
      return posterior(law.value + Eigen::Vector2d(x * width.x(), y * width.y()));
    };
    const double right = at(1, 0), left = at(-1, 0);
    slope.x() = (right - left) / (2 * width.x());
    bend(0, 0) = (right - 2 * middle + left) / (width.x() * width.x());
    if (both) {
      const double above = at(0, 1), below = at(0, -1);
      slope.y() = (above - below) / (2 * width.y());
      bend(1, 1) = (above - 2 * middle + below) / (width.y() * width.y());
      bend(0, 1) = bend(1, 0) = (at(1, 1) - right - above + middle) / (width.x() * width.y());
    }
    if (!(bend(0, 0) < 0) || !(bend.determinant() > 0)) break;
    information = -bend;
    Eigen::Vector2d move = information.ldlt().solve(slope);
    if (!both) move = {slope.x() / information(0, 0), 0};
    move = move.cwiseMax(-2 * prior_sd).cwiseMin(2 * prior_sd);
    law.value += move;
    const Eigen::Vector2d sd = information.inverse().diagonal().cwiseSqrt();
    width = (0.7 * sd).cwiseMax(0.05 * prior_sd).cwiseMin(0.5 * prior_sd);
    if ((move.cwiseAbs() - 0.1 * sd).maxCoeff() < 0) break;
  }
  // Formal sds on recorded flights are too small; no single flight is trusted to better than this.
  const Eigen::Vector2d least_sd(0.01, 0.005);
  law.covariance = information.inverse();
  law.covariance.diagonal() = law.covariance.diagonal().cwiseMax(least_sd.cwiseAbs2());
  return law;
}

ClimbEvidence climb_evidence(const std::vector<Step>& steps) {
  double height = 0, up = 0, down = 0, total = 0, paused = 0, pause = 0;
  double up_low = 1e9, up_high = -1e9, down_low = 1e9, down_high = -1e9;
  int pauses = 0;
  bool moved = false;
  for (const auto& step : steps) {
    if (!step.sound) continue;
    const double climb = -step.input.v_down, h = step.input.step;
    height += climb * h;
    total += h;
    if (climb > 0.3) up += h, up_low = std::min(up_low, height), up_high = std::max(up_high, height);
    if (climb < -0.3) down += h, down_low = std::min(down_low, height), down_high = std::max(down_high, height);
    if (std::abs(climb) < 0.3) {
      pause += moved ? h : 0;
    } else {
      // A stop counts once vertical flight goes on behind it.
      if (pause >= 1.5) ++pauses, paused += pause;
      pause = 0;
      moved = true;
    }
  }
  const double common = std::min(up_high, down_high) - std::max(up_low, down_low);
  // A survey at one height that takes off and lands is no pair of legs: its likelihood would read alpha from the noise.
  const double least = std::max(5.0, 0.1 * total);
  if (up < least || down < least || common < 10) return ClimbEvidence::none;
  return pauses >= 2 && paused >= 0.05 * total ? ClimbEvidence::with_pauses : ClimbEvidence::both_legs;
}

}  // namespace quadsonde::estimator
