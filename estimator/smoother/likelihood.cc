#include "estimator/smoother/likelihood.h"

#include <Eigen/Eigenvalues>
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

constexpr int most_rounds = 8;

struct Parabola {
  double middle = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  Eigen::Matrix2d bend = Eigen::Matrix2d::Zero();
};

/// Slope and curvature by central differences; of the first parameter only, unless both.
Parabola local_parabola(const std::function<double(const Eigen::Vector2d&)>& f, const Eigen::Vector2d& at,
                        const Eigen::Vector2d& width, bool both) {
  const auto value = [&](double x, double y) { return f(at + Eigen::Vector2d(x * width.x(), y * width.y())); };
  Parabola p;
  p.middle = f(at);
  const double right = value(1, 0), left = value(-1, 0);
  p.slope.x() = (right - left) / (2 * width.x());
  p.bend(0, 0) = (right - 2 * p.middle + left) / (width.x() * width.x());
  if (!both) return p;
  const double above = value(0, 1), below = value(0, -1);
  p.slope.y() = (above - below) / (2 * width.y());
  p.bend(1, 1) = (above - 2 * p.middle + below) / (width.y() * width.y());
  p.bend(0, 1) = p.bend(1, 0) = (value(1, 1) - right - above + p.middle) / (width.x() * width.y());
  return p;
}

/// -bend, in units of the prior's sds made at least as sharp as the prior: on a flank the likelihood bends the other
/// way, and Newton's own step would lead downhill.
struct Information {
  Eigen::Matrix2d information;
  bool mended = false;
};
Information positive_information(const Eigen::Matrix2d& bend, const Eigen::Vector2d& prior_sd, bool both) {
  const Eigen::Matrix2d scale = prior_sd.asDiagonal();
  Eigen::Matrix2d scaled = -(scale * bend * scale);
  if (!both) scaled = Eigen::Vector2d(scaled(0, 0), 1).asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scaled);
  Information out;
  out.mended = solver.eigenvalues().minCoeff() < 0.99;
  const Eigen::Vector2d values = solver.eigenvalues().cwiseMax(1.0);
  const Eigen::Matrix2d back = prior_sd.cwiseInverse().asDiagonal();
  out.information =
      back * (solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose()) * back;
  return out;
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
  const Eigen::Vector2d prior_sd = prior.covariance.diagonal().cwiseSqrt();
  Eigen::Vector2d width = 0.5 * prior_sd;
  Eigen::Matrix2d information = prior_information;
  for (int round = 0; round < most_rounds; ++round) {
    const auto local = local_parabola(posterior, law.value, width, both);
    const auto bent = positive_information(local.bend, prior_sd, both);
    information = bent.information;
    Eigen::Vector2d move = information.ldlt().solve(local.slope);
    if (!both) move = {local.slope.x() / information(0, 0), 0};
    move = move.cwiseMax(-2 * prior_sd).cwiseMin(2 * prior_sd);
    // A step that does not help is halved: far from the maximum the parabola is wrong.
    double share = 1;
    while (share > 0.1 && posterior(law.value + share * move) < local.middle) share /= 2;
    if (share <= 0.1) break;
    law.value += share * move;
    const Eigen::Vector2d sd = information.inverse().diagonal().cwiseSqrt();
    width = (0.7 * sd).cwiseMax(0.05 * prior_sd).cwiseMin(0.5 * prior_sd);
    if (!bent.mended && ((share * move).cwiseAbs() - 0.1 * sd).maxCoeff() < 0) break;
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
