#pragma once
// Flights with a known wind, and short courses of steps, for the tests of the passes.
#include <numbers>

#include "estimator/smoother/estimate.h"
#include "estimator/smoother/passes.h"
#include "ingest/motion/random.h"
#include "ingest/motion/simulator.h"

namespace quadsonde::estimator {

inline ingest::LogTime at(double s) { return ingest::LogTime{} + ingest::seconds(s); }

/// A hover of the published vehicle in 4 m/s toward 60 degrees; the nose turns at a rate.
inline ingest::Scenario hover(double duration, double yaw_rate_deg_s = 20) {
  ingest::Scenario s;
  s.vehicle = ingest::published_vehicle();
  s.wind.toward = 4 * Eigen::Vector2d(0.5, std::sqrt(0.75));
  ingest::PathLeg leg;
  leg.duration = duration;
  if (yaw_rate_deg_s != 0) leg.heading = {ingest::HeadingRule::Kind::turning, 0, yaw_rate_deg_s};
  s.path = {leg};
  return s;
}

inline WindSeries estimated(const ingest::Simulation& flown, const EstimateSettings& settings = {}) {
  auto series = estimate_wind(flown.flight, flown.vehicle, settings);
  if (!series) throw std::runtime_error(to_string(series.error()));
  return *series;
}

/// Root mean square of both components' errors over the points that have a wind, from a time on [s].
inline double rmse(const WindSeries& series, const ingest::Truth& truth, double from_s) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    const auto* wind = std::get_if<WindEstimate>(&series.points[i].wind);
    if (!wind || ingest::to_seconds(series.points[i].time - truth.front().time) < from_s) continue;
    sum += (wind->v_NA_N - truth[i].v_NA_N.head<2>()).squaredNorm(), n += 2;
  }
  return std::sqrt(sum / n);
}

/// A course of sound steps at 10 Hz with everything changing.
inline std::vector<Step> course(int count, std::uint64_t seed) {
  ingest::Gaussian noise(seed);
  std::vector<Step> steps;
  for (int k = 0; k < count; ++k) {
    Step s;
    s.time = at(0.1 * k);
    s.seconds = 0.1 * k;
    s.input.slope = {0.08 * std::sin(0.2 * k) - 0.06, 0.05 * std::cos(0.15 * k) + 0.02 * noise()};
    s.input.slope_rate = {0.1 * noise(), 0.1 * noise()};
    s.input.lift = 9.8 + 0.1 * noise();
    s.input.v_down = -1.5 * std::sin(0.05 * k);
    s.input.heading = s.heading = 0.05 * k;
    s.input.step = k ? 0.1 : 0;
    s.v = {0.3 * std::sin(0.07 * k) + 0.1 * noise(), 0.1 * noise()};
    s.variance = 0.01;
    s.sound = true;
    steps.push_back(s);
  }
  return steps;
}

inline PassSettings open_settings() {
  PassSettings p;
  p.model.drag = {0.257, 0, 0.03, 0.002};
  p.limits.gate_nis = 1e9;  // every sample counts, so that the problem is linear
  p.trim = {0.05, -0.02};
  p.trim_covariance << 0.2, 0.03, 0.03, 0.1;
  p.jump_test = false;
  p.keep_trace = true;
  return p;
}

/// The joint Gaussian of all states of a course, conditioned on all its velocities: dense linear algebra, nothing
/// recursive but the model's own transition. Linear law only.
struct DensePosterior {
  Eigen::VectorXd mean;  ///< 8 per step
  Eigen::MatrixXd covariance;

  DensePosterior(const std::vector<Step>& steps, const PassSettings& p) {
    const Eigen::Index n = static_cast<Eigen::Index>(steps.size());
    Eigen::VectorXd prior(8 * n);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(8 * n, 8 * n);
    WindFilter<double> start(p.model, p.limits);
    start.start(steps[0].v, p.trim, p.trim_covariance);
    prior.head<8>() = start.state();
    C.topLeftCorner<8, 8>() = start.covariance();
    std::vector<Eigen::Index> measured;
    for (Eigen::Index k = 1; k < n; ++k) {
      const auto& step = steps[static_cast<std::size_t>(k)];
      Transition<double> t;
      if (step.gap_before) {
        WindFilter<double> fresh(p.model, p.limits);
        t = fresh.restart(step.v);
        // W starts again at the mean it had, with an sd of 20 m/s.
        const std::vector<Step> before(steps.begin(), steps.begin() + k);
        t.x.segment<2>(i_W) = run_forward(before, p).x.segment<2>(i_W);
        t.x.segment<2>(i_b) = prior.segment<2>(8 * (k - 1) + i_b);
      } else {
        t = propagate(p.model, State<double>(prior.segment<8>(8 * (k - 1))), step.input);
        measured.push_back(k);
      }
      prior.segment<8>(8 * k) = t.x;
      C.block(8 * k, 0, 8, 8 * k) = t.Phi * C.block(8 * (k - 1), 0, 8, 8 * k);
      C.block(0, 8 * k, 8 * k, 8) = C.block(8 * k, 0, 8, 8 * k).transpose();
      C.block<8, 8>(8 * k, 8 * k) = t.Phi * C.block<8, 8>(8 * (k - 1), 8 * (k - 1)) * t.Phi.transpose() + t.Q;
    }
    const Eigen::Index m = 2 * static_cast<Eigen::Index>(measured.size());
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m, 8 * n);
    Eigen::VectorXd z(m), R(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index k = measured[static_cast<std::size_t>(i / 2)];
      H(i, 8 * k + i % 2) = 1;
      z(i) = steps[static_cast<std::size_t>(k)].v(i % 2);
      R(i) = steps[static_cast<std::size_t>(k)].variance;
    }
    const Eigen::MatrixXd S = H * C * H.transpose() + Eigen::MatrixXd(R.asDiagonal());
    const Eigen::MatrixXd K = S.ldlt().solve(H * C).transpose();
    mean = prior + K * (z - H * prior);
    covariance = C - K * S * K.transpose();
  }
  State<double> x(std::size_t k) const { return mean.segment<8>(static_cast<Eigen::Index>(8 * k)); }
  StateMatrix<double> P(std::size_t k, std::size_t j) const {
    return covariance.block<8, 8>(static_cast<Eigen::Index>(8 * k), static_cast<Eigen::Index>(8 * j));
  }
};

}  // namespace quadsonde::estimator
