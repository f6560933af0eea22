#include "estimator/calibration/referee.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "estimator/calibration/slow_steps.h"

namespace quadsonde::estimator {
namespace {

constexpr double window = 3;  // [s]
// The bend of f is not free to run where one airspeed is flown: it is held within this [1/m], loosely.
constexpr double bend_sd = 0.02;

using Balances = std::vector<std::vector<Balance>>;

/// Parameters: f0, f1, then per flight wind N, E and trim x, y.
struct Solution {
  Eigen::VectorXd at;
  Eigen::MatrixXd covariance;
  double square = 0, airspeed_2 = 0, airspeed_3 = 0;
  std::size_t windows = 0;
};

/// Residual of one window and its derivatives by the six parameters that it knows.
void add_window(const Balance& b, double scale, Eigen::Index first, const Eigen::VectorXd& x, bool turned,
                Eigen::MatrixXd& normal, Eigen::VectorXd& right, Solution& sums) {
  const Eigen::Vector2d a = b.velocity - x.segment<2>(first);
  const double size = std::max(a.norm(), 1e-3), f = scale * (x(0) + x(1) * size);
  Eigen::Matrix2d R;
  R << b.nose.x(), -b.nose.y(), b.nose.y(), b.nose.x();
  const Eigen::Vector2d residual = b.force - b.acceleration - f * a + R * x.segment<2>(first + 2);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, x.size());
  J.col(0) = -scale * a;
  J.col(1) = -scale * size * a;
  J.middleCols<2>(first) = f * Eigen::Matrix2d::Identity() + scale * x(1) * a * a.transpose() / size;
  if (turned) J.middleCols<2>(first + 2) = R;
  normal += J.transpose() * J;
  right -= J.transpose() * residual;
  sums.square += residual.squaredNorm();
  sums.airspeed_2 += size * size, sums.airspeed_3 += size * size * size;
}

std::optional<Solution> solve(const Balances& all, const std::vector<RefereeFlight>& flights) {
  const auto count = static_cast<Eigen::Index>(2 + 4 * all.size());
  Solution out;
  out.at = Eigen::VectorXd::Zero(count);
  out.at(0) = 0.2;
  for (int round = 0; round < 25; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    out.square = out.airspeed_2 = out.airspeed_3 = 0, out.windows = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto first = static_cast<Eigen::Index>(2 + 4 * k);
      for (const auto& b : all[k])
        add_window(b, flights[k].drag_scale, first, out.at, flights[k].turned, normal, right, out);
      out.windows += all[k].size();
      if (!flights[k].turned) normal(first + 2, first + 2) += 1, normal(first + 3, first + 3) += 1;
    }
    if (out.windows < 10) return std::nullopt;
    // Windows overlap by half, so that two of them are worth one.
    const double dof = std::max(1.0, static_cast<double>(out.windows) - static_cast<double>(count));
    const double variance = std::max(1e-8, out.square / dof);
    normal(1, 1) += variance / (bend_sd * bend_sd);
    right(1) -= variance / (bend_sd * bend_sd) * out.at(1);
    const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
    Eigen::VectorXd step = factor.solve(right);
    if (!step.allFinite()) return std::nullopt;
    const double most = std::max(step.cwiseAbs().head<2>().maxCoeff() / 0.2, step.cwiseAbs().maxCoeff() / 10);
    if (most > 1) step /= most;
    out.at += step;
    out.covariance = variance * factor.solve(Eigen::MatrixXd::Identity(count, count));
    if (step.cwiseAbs().maxCoeff() < 1e-7) return out;
  }
  return out;
}

}  // namespace

std::optional<Referee> judge_without_law(const std::vector<RefereeFlight>& flights, std::optional<double> about) {
  std::map<double, Solution> tried;  // by latency
  const auto attempt = [&](double at) {
    if (tried.contains(at)) return;
    Balances all;
    for (const auto& f : flights) all.push_back(force_balances(*f.flight, at, window));
    if (auto solution = solve(all, flights)) tried.emplace(at, std::move(*solution));
  };
  // The number of windows may change with the latency, by one at an end.
  const auto mean_square = [](const Solution& s) { return s.square / static_cast<double>(s.windows); };
  const auto best = [&] {
    return std::min_element(tried.begin(), tried.end(), [&](const auto& a, const auto& b) {
      return mean_square(a.second) < mean_square(b.second);
    });
  };
  if (about)
    for (double beside = -0.1; beside < 0.11; beside += 0.05) attempt(*about + beside);
  else
    for (double at = -0.3; at < 0.75; at += 0.1) attempt(at);
  if (tried.empty()) return std::nullopt;
  // Parabolas through the best and its neighbours.
  for (int round = 0; round < 3; ++round) {
    const auto middle = best();
    if (middle == tried.begin() || std::next(middle) == tried.end()) break;
    const auto left = std::prev(middle), right = std::next(middle);
    const double a = middle->first - left->first, b = right->first - middle->first;
    const double down = (mean_square(left->second) - mean_square(middle->second)) / a;
    const double up = (mean_square(right->second) - mean_square(middle->second)) / b;
    if (!(down + up > 0)) break;
    attempt(middle->first + 0.5 * (down * b - up * a) / (down + up));
  }
  const auto found = best();
  const Solution& solution = found->second;
  if (!solution.at.allFinite()) return std::nullopt;
  Referee out;
  out.airspeed = solution.airspeed_3 / solution.airspeed_2;
  out.latency = found->first;
  out.windows = solution.windows;
  out.drag = solution.at(0) + solution.at(1) * out.airspeed;
  const Eigen::Vector2d lever(1, out.airspeed);
  out.drag_sd = std::sqrt(std::max(0.0, lever.dot(solution.covariance.topLeftCorner<2, 2>() * lever)));
  out.residual_rms = std::sqrt(solution.square / (2 * static_cast<double>(solution.windows)));
  for (std::size_t k = 0; k < flights.size(); ++k)
    out.wind.push_back(solution.at.segment<2>(static_cast<Eigen::Index>(2 + 4 * k)));
  if (!(out.drag > 0)) return std::nullopt;
  return out;
}

}  // namespace quadsonde::estimator
