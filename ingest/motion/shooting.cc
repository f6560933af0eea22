#include "ingest/motion/shooting.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "ingest/motion/shooting_prediction.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr Index local_columns = 4, common_columns = 3;

std::vector<double> times_of(const Telemetry& t, const ShootingWindow& window) {
  std::vector<double> times;
  for (std::size_t i = window.first; i <= window.last; ++i)
    times.push_back(t.velocity_time[i] - t.velocity_time[window.first]);
  return times;
}

/// Times in units of the usual interval: small jitter does not change a covariance worth telling.
std::vector<int> ticks_of(const std::vector<double>& times, double interval) {
  std::vector<int> ticks;
  for (const double t : times) ticks.push_back(static_cast<int>(std::lround(t / interval)));
  for (std::size_t i = 1; i < ticks.size(); ++i) ticks[i] = std::max(ticks[i], ticks[i - 1] + 1);
  return ticks;
}

VectorXd logged(const Telemetry& t, const ShootingWindow& window) {
  const auto n = static_cast<Index>(window.samples());
  VectorXd v(2 * n);
  for (Index i = 0; i < n; ++i)
    v(i) = t.v[window.first + static_cast<std::size_t>(i)].x(),
    v(n + i) = t.v[window.first + static_cast<std::size_t>(i)].y();
  return v;
}

/// P(u) and covariance with v of an Ornstein-Uhlenbeck drive, step by step.
struct DrivenVelocity {
  double vv = 0, vu = 0, uu;
  double e, f, g;  // v+ = e v + g u, u+ = f u, plus noise
  double noise_vv, noise_vu, noise_uu;
};

/// Exact over h: v' = -c v + c u, u' = -u/T + noise of stationary variance 1.
DrivenVelocity driven(double c, double time, double h) {
  DrivenVelocity d{};
  const double l = 1 / time;
  d.e = std::exp(-c * h), d.f = std::exp(-l * h);
  const bool equal = std::abs(c - l) < 1e-6 * c;
  const double cc = equal ? c * (1 + 1e-5) : c;
  d.g = cc * (d.f - d.e) / (cc - l);
  // The stationary pair (v, u) has covariances below; the noise of a step is what the step must bring back to them.
  const double s_vu = cc / (cc + l), s_vv = s_vu;
  d.noise_uu = 1 - d.f * d.f;
  d.noise_vu = s_vu - (d.e * d.f * s_vu + d.g * d.f);
  d.noise_vv = s_vv - (d.e * d.e * s_vv + 2 * d.e * d.g * s_vu + d.g * d.g);
  d.uu = 1;
  return d;
}

}  // namespace

const NoiseShapes::Shape& NoiseShapes::at(const std::vector<int>& ticks, double interval) {
  auto key = ticks;
  key.push_back(static_cast<int>(std::lround(interval * 1e6)));
  auto [it, fresh] = shapes_.try_emplace(std::move(key));
  if (!fresh) return it->second;
  const auto n = static_cast<Index>(ticks.size());
  Shape& shape = it->second;
  shape.turbulence.resize(n, n);
  shape.acceleration.resize(n, n);
  double vv = 0, vu = 0, tilt = 0;
  for (Index j = 0; j < n; ++j) {
    const auto J = static_cast<std::size_t>(j);
    if (j > 0) {
      const double h = interval * (ticks[J] - ticks[J - 1]);
      const auto d = driven(drag_, time_, h);
      vv = d.e * d.e * vv + 2 * d.e * d.g * vu + d.g * d.g + d.noise_vv;
      vu = d.e * d.f * vu + d.g * d.f + d.noise_vu;
      tilt = d.e * d.e * tilt - std::expm1(-2 * drag_ * h) / (2 * drag_);
    }
    double v = vv, u = vu, t = tilt;  // covariance of the later state with v at j
    for (Index i = j; i < n; ++i) {
      if (i > j) {
        const auto I = static_cast<std::size_t>(i);
        const auto d = driven(drag_, time_, interval * (ticks[I] - ticks[I - 1]));
        v = d.e * v + d.g * u;
        u *= d.f;
        t *= d.e;
      }
      shape.turbulence(i, j) = shape.turbulence(j, i) = v;
      shape.acceleration(i, j) = shape.acceleration(j, i) = t;
    }
  }
  return shape;
}

/// Cholesky factors of the covariances of one noise level, each pattern of times once.
class NoiseFactors {
 public:
  NoiseFactors(NoiseShapes& shapes, const NoiseLevels& noise, double scale, double interval)
      : shapes_(shapes), noise_(noise), scale_(scale), interval_(interval) {}
  const Eigen::LLT<MatrixXd>& at(const std::vector<int>& ticks) {
    auto [it, fresh] = factors_.try_emplace(ticks);
    if (!fresh) return it->second;
    const auto& shape = shapes_.at(ticks, interval_);
    const double k2 = scale_ * scale_;
    MatrixXd c = k2 * noise_.turbulence_sd * noise_.turbulence_sd * shape.turbulence +
                 k2 * noise_.acceleration_psd * shape.acceleration;
    c.diagonal().array() += noise_.velocity_sd * noise_.velocity_sd;
    it->second.compute(c);
    return it->second;
  }
  static double log_det(const Eigen::LLT<MatrixXd>& factor) {
    return 2 * factor.matrixLLT().diagonal().array().log().sum();
  }
  /// Both axes' rows, one after the other.
  static void whiten(const Eigen::LLT<MatrixXd>& factor, MatrixXd& m) {
    const Index n = m.rows() / 2;
    factor.matrixL().solveInPlace(m.topRows(n));
    factor.matrixL().solveInPlace(m.bottomRows(n));
  }

 private:
  NoiseShapes& shapes_;
  NoiseLevels noise_;
  double scale_, interval_;
  std::map<std::vector<int>, Eigen::LLT<MatrixXd>> factors_;
};

namespace {

/// One whitened window with its own parameters projected out.
struct ReducedWindow {
  MatrixXd common;  // rows left x common parameters
  VectorXd residual;
  Eigen::ColPivHouseholderQR<MatrixXd> own;
  MatrixXd own_common;  // what is needed to find the window's own step again
  VectorXd own_residual;

  ReducedWindow(const Eigen::LLT<MatrixXd>& factor, const VectorXd& r, const MatrixXd& jacobian) {
    MatrixXd all(jacobian.rows(), jacobian.cols() + 1);
    all << jacobian, r;
    NoiseFactors::whiten(factor, all);
    own.compute(all.leftCols(local_columns));
    all.rightCols(all.cols() - local_columns).applyOnTheLeft(own.householderQ().adjoint());
    const Index left = all.rows() - local_columns, m = jacobian.cols() - local_columns;
    common = all.block(local_columns, local_columns, left, m);
    residual = all.col(all.cols() - 1).tail(left);
    own_common = all.block(0, local_columns, local_columns, m);
    own_residual = all.col(all.cols() - 1).head(local_columns);
  }
  Eigen::Vector4d own_step(const VectorXd& common_step) const {
    const VectorXd rhs = own_residual - own_common * common_step;
    VectorXd x = own.matrixR().topLeftCorner(local_columns, local_columns).triangularView<Eigen::Upper>().solve(rhs);
    return own.colsPermutation() * x;
  }
};

/// Step of the common parameters, trim and drag kept within three sd of what is known of them: a Gaussian prior alone
/// is no hold against a residual fifty times too large, which then bends the drag to any size and hides half of itself.
VectorXd bounded_step(const MatrixXd& normal, const VectorXd& right, const ShootingPrior& prior,
                      const ShootingFit& fit) {
  const Eigen::Vector3d sd(prior.trim_sd.x(), prior.trim_sd.y(), prior.drag_log_sd);
  const Eigen::Vector3d off(prior.trim.x() - fit.trim.x(), prior.trim.y() - fit.trim.y(), -fit.drag_log_factor);
  VectorXd step = normal.ldlt().solve(right);
  std::vector<Index> held;
  for (Index round = 0; round < common_columns; ++round) {
    const auto before = held.size();
    for (Index i = 0; i < common_columns; ++i) {
      const double low = off(i) - 3 * sd(i), high = off(i) + 3 * sd(i);
      if (std::find(held.begin(), held.end(), i) != held.end() || (step(i) >= low && step(i) <= high)) continue;
      step(i) = std::clamp(step(i), low, high);
      held.push_back(i);
    }
    if (held.size() == before) break;
    MatrixXd rest = normal;
    VectorXd target = right;
    for (const Index i : held) {
      target -= normal.col(i) * step(i);
      rest.row(i).setZero(), rest.col(i).setZero();
      rest(i, i) = 1;
    }
    for (const Index i : held) target(i) = step(i);
    step = rest.ldlt().solve(target);
  }
  return step;
}

/// Prior of the common parameters as normal equations about the present values.
void add_prior(const ShootingPrior& prior, const ShootingFit& fit, MatrixXd& normal, VectorXd& right) {
  const Eigen::Vector3d sd(prior.trim_sd.x(), prior.trim_sd.y(), prior.drag_log_sd);
  const Eigen::Vector3d off(prior.trim.x() - fit.trim.x(), prior.trim.y() - fit.trim.y(), -fit.drag_log_factor);
  for (Index i = 0; i < common_columns; ++i) {
    const double weight = 1 / std::max(sd(i) * sd(i), 1e-12);
    normal(i, i) += weight;
    right(i) += weight * off(i);
  }
}

WindowParameters first_guess(const Telemetry& t, const ShootingWindow& window) {
  Vector2d mean = Vector2d::Zero();
  for (std::size_t i = window.first; i <= window.last; ++i) mean += t.v[i] / static_cast<double>(window.samples());
  return {t.v[window.first], mean};
}

}  // namespace

Shooting::Shooting(std::vector<ShootingWindow> windows, const ShootingPrior& prior, double turbulence_time)
    : windows_(std::move(windows)),
      prior_(prior),
      shapes_(std::max(0.01, prior.drag.linear + 3 * prior.drag.quadratic), turbulence_time) {}

std::optional<ShootingFit> Shooting::fit(const LogReading& reading, const NoiseLevels& noise, Solver solver,
                                         const std::vector<GainMap>& gains, const ShootingFit* start) {
  const Telemetry& t = *reading.telemetry;
  const auto count = windows_.size();
  const auto gain_columns = static_cast<Index>(gains.size());
  ShootingFit fit;
  fit.trim = prior_.trim;
  fit.residual.resize(count), fit.jacobian.resize(count), fit.window_ratio.resize(count);
  for (const auto& window : windows_) fit.windows.push_back(first_guess(t, window));
  if (start) fit.windows = start->windows, fit.trim = start->trim, fit.drag_log_factor = start->drag_log_factor;
  NoiseFactors factors(shapes_, noise, reading.velocity_scale, t.velocity_interval);
  std::vector<MotionCourse> courses;
  for (const auto& window : windows_) courses.push_back(course_of(t, window, reading.latency, prior_.gravity));
  const int rounds = start ? 2 : 4;
  for (int round = 0; round < rounds; ++round) {
    const Index m = common_columns + gain_columns;
    MatrixXd normal = MatrixXd::Zero(m, m);
    VectorXd right = VectorXd::Zero(m);
    std::vector<ReducedWindow> reduced;
    reduced.reserve(count);
    fit.log_det = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto times = times_of(t, windows_[i]);
      std::optional<WindowPrediction> predicted;
      if (solver == Solver::closed_form)
        predicted = closed_form(courses[i], times, fit.windows[i], prior_, fit.trim, fit.drag_log_factor,
                                reading.velocity_scale, gains);
      else
        predicted =
            by_cvodes(courses[i], times, fit.windows[i], prior_, fit.trim, fit.drag_log_factor, reading.velocity_scale);
      if (!predicted || !predicted->v.allFinite()) return std::nullopt;
      const auto& factor = factors.at(ticks_of(times, t.velocity_interval));
      fit.residual[i] = logged(t, windows_[i]) - predicted->v;
      fit.jacobian[i] = std::move(predicted->jacobian);
      fit.log_det += 2 * NoiseFactors::log_det(factor);
      reduced.emplace_back(factor, fit.residual[i], fit.jacobian[i]);
      normal += reduced.back().common.transpose() * reduced.back().common;
      right += reduced.back().common.transpose() * reduced.back().residual;
    }
    add_prior(prior_, fit, normal, right);
    const VectorXd step = bounded_step(normal, right, prior_, fit);
    fit.chi2 = fit.dof = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double chi2 = (reduced[i].residual - reduced[i].common * step).squaredNorm();
      const auto left = static_cast<double>(reduced[i].residual.size());
      fit.window_ratio[i] = chi2 / left;
      fit.chi2 += chi2, fit.dof += left;
      const Eigen::Vector4d own = reduced[i].own_step(step);
      fit.windows[i].v0 += own.head<2>();
      fit.windows[i].wind += own.tail<2>();
    }
    fit.dof -= common_columns + static_cast<double>(gain_columns);
    fit.trim += step.head<2>();
    fit.drag_log_factor += step(2);
    if (gain_columns > 0) {
      fit.gain = step.tail(gain_columns);
      fit.gain_covariance = normal.ldlt().solve(MatrixXd::Identity(m, m)).bottomRightCorner(gain_columns, gain_columns);
    }
  }
  return fit;
}

double Shooting::minus_two_log_likelihood(const LogReading& reading, const ShootingFit& fit, const NoiseLevels& noise) {
  const Telemetry& t = *reading.telemetry;
  NoiseFactors factors(shapes_, noise, reading.velocity_scale, t.velocity_interval);
  double sum = 0;
  // Three noise levels need no more than some windows, spread over the flight.
  constexpr std::size_t enough = 16;
  const std::size_t stride = (windows_.size() + enough - 1) / enough;
  for (std::size_t i = 0; i < windows_.size(); i += stride) {
    const auto& factor = factors.at(ticks_of(times_of(t, windows_[i]), t.velocity_interval));
    const ReducedWindow reduced(factor, fit.residual[i], fit.jacobian[i].leftCols(local_columns));
    // Restricted likelihood: the window's own parameters take part of the slow noise with them.
    const double own_det = 2 * reduced.own.matrixR().diagonal().array().abs().max(1e-12).log().sum();
    sum += 2 * NoiseFactors::log_det(factor) + own_det + reduced.residual.squaredNorm();
  }
  return sum;
}

NoiseLevels Shooting::likeliest_noise(const LogReading& reading, const ShootingFit& fit, NoiseLevels noise, bool all) {
  const std::vector<double NoiseLevels::*> levels =
      all ? std::vector<double NoiseLevels::*>{&NoiseLevels::turbulence_sd, &NoiseLevels::acceleration_psd,
                                               &NoiseLevels::velocity_sd}
          : std::vector<double NoiseLevels::*>{&NoiseLevels::turbulence_sd};
  // Turbulence below some centimetres per second is not worth telling; noise of zero is none.
  const auto bounded = [](double NoiseLevels::*level, double value) {
    if (level == &NoiseLevels::turbulence_sd) return std::clamp(value, 0.05, 20.0);
    if (level == &NoiseLevels::velocity_sd) return std::clamp(value, 0.01, 20.0);
    return std::clamp(value, 1e-6, 1e3);
  };
  double best = minus_two_log_likelihood(reading, fit, noise);
  double stride = 2;
  for (int round = 0; round < 24 && stride > 1.03; ++round) {
    bool moved = false;
    for (const auto level : levels)
      for (const double factor : {stride, 1 / stride}) {
        NoiseLevels trial = noise;
        trial.*level = bounded(level, noise.*level * factor);
        if (trial.*level == noise.*level) continue;
        const double value = minus_two_log_likelihood(reading, fit, trial);
        if (value >= best) continue;
        best = value, noise = trial, moved = true;
      }
    if (!moved) stride = std::sqrt(stride);
  }
  return noise;
}

}  // namespace quadsonde::ingest
