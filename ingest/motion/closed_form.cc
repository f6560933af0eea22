// The transition over each step of the course in closed form (design notes, section 4), and the same by CVODES.
#include <algorithm>
#include <cmath>

#include "ingest/motion/shooting.h"
#include "ingest/motion/shooting_prediction.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Matrix2d turn(double heading) {
  Matrix2d r;
  r << std::cos(heading), -std::sin(heading), std::sin(heading), std::cos(heading);
  return r;
}

/// One step of length h: x' = e x + inputs, where an input runs linearly from u0 to u1.
struct StepWeights {
  double e, first, second;
  StepWeights(double c, double h) : e(std::exp(-c * h)) {
    const double z = c * h;
    const double whole = z > 1e-4 ? -std::expm1(-z) / c : h * (1 - z / 2 + z * z / 6);
    second = z > 1e-4 ? (h - whole) / z : h * (0.5 - z / 6 + z * z / 24);
    first = whole - second;
  }
  template <class V>
  V input(const V& u0, const V& u1) const {
    return first * u0 + second * u1;
  }
};

/// Velocity and its derivatives as columns.
class ClosedForm {
 public:
  ClosedForm(const MotionCourse& course, const WindowParameters& start, const DragLaw<double>& law,
             const Vector2d& trim, double scale, const std::vector<GainMap>& gains)
      : course_(course),
        start_(start),
        law_(law),
        trim_(trim),
        k_(scale),
        gains_(gains),
        v_(start.v0),
        gain_(2, static_cast<Eigen::Index>(gains.size())) {
    gain_.setZero();
  }

  void step(std::size_t i) {
    const MotionNode &a = course_[i], &b = course_[i + 1];
    const double h = b.time - a.time;
    if (h <= 0) return;
    const Vector2d air = (v_ - start_.wind) / k_;
    const double c = drag_coefficient(law_, std::hypot(air.x(), air.y(), a.v_down / k_), -a.v_down / k_);
    const StepWeights w(c, h);
    const Vector2d pull_a = pull(a, c), pull_b = pull(b, c);
    const Matrix2d turn_a = k_ * turn(a.heading), turn_b = k_ * turn(b.heading);
    const Vector2d v =
        w.e * v_ + (1 - w.e) * start_.wind + w.input<Vector2d>(pull_a + turn_a * trim_, pull_b + turn_b * trim_);
    drag_ = w.e * drag_ + w.input<Vector2d>(drag_rate(a, c, v_), drag_rate(b, c, v));
    trim_columns_ = w.e * trim_columns_ + w.input<Matrix2d>(turn_a, turn_b);
    for (std::size_t g = 0; g < gains_.size(); ++g) {
      const auto column = static_cast<Eigen::Index>(g);
      gain_.col(column) =
          w.e * gain_.col(column) + w.input<Vector2d>(mapped(gains_[g], a, pull_a), mapped(gains_[g], b, pull_b));
    }
    start_share_ *= w.e;
    v_ = v;
  }
  void write(Eigen::Index row, Eigen::Index n, WindowPrediction& out) const {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Eigen::Index r = row + axis * n;
      out.v(r) = v_(axis);
      out.jacobian(r, axis) = start_share_;
      out.jacobian(r, 2 + axis) = 1 - start_share_;
      out.jacobian.block<1, 2>(r, 4) = trim_columns_.row(axis);
      out.jacobian(r, 6) = drag_(axis);
      if (gain_.cols() > 0) out.jacobian.row(r).tail(gain_.cols()) = gain_.row(axis);
    }
  }

 private:
  /// k s (g - vdot_d - c v_d), in logged units.
  Vector2d pull(const MotionNode& node, double c) const {
    const double lift = standard_lift(node);
    return k_ * node.slope * (lift - c * node.v_down / k_);
  }
  double standard_lift(const MotionNode& node) const { return true_lift(node.lift, k_); }
  Vector2d drag_rate(const MotionNode& node, double c, const Vector2d& v) const {
    return -c * (v - start_.wind + node.slope * node.v_down);
  }
  static Vector2d mapped(const GainMap& gain, const MotionNode& node, const Vector2d& pull) {
    if (!gain.heading_axes) return gain.map * pull;
    const Matrix2d r = turn(node.heading);
    return r * (gain.map * (r.transpose() * pull));
  }

  const MotionCourse& course_;
  const WindowParameters& start_;
  DragLaw<double> law_;
  Vector2d trim_;
  double k_;
  const std::vector<GainMap>& gains_;
  Vector2d v_, drag_ = Vector2d::Zero();
  double start_share_ = 1;
  Matrix2d trim_columns_ = Matrix2d::Zero();
  Eigen::MatrixXd gain_;
};

}  // namespace

double true_lift(double logged_lift, double scale) {
  return standard_gravity - (standard_gravity - logged_lift) / scale;
}

DragLaw<double> times_factor(DragLaw<double> law, double log_factor) {
  law.linear *= std::exp(log_factor);
  law.quadratic *= std::exp(log_factor);
  return law;
}

WindowPrediction closed_form(const MotionCourse& course, const std::vector<double>& times,
                             const WindowParameters& start, const ShootingPrior& prior, const Vector2d& trim,
                             double drag_log_factor, double velocity_scale, const std::vector<GainMap>& gains) {
  const auto n = static_cast<Eigen::Index>(times.size());
  WindowPrediction out{Eigen::VectorXd(2 * n),
                       Eigen::MatrixXd::Zero(2 * n, 7 + static_cast<Eigen::Index>(gains.size()))};
  ClosedForm state(course, start, times_factor(prior.drag, drag_log_factor), trim, velocity_scale, gains);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < course.size(); ++i) {
    while (row < n && times[static_cast<std::size_t>(row)] <= course[i].time + 1e-6) state.write(row++, n, out);
    if (i + 1 < course.size()) state.step(i);
  }
  while (row < n) state.write(row++, n, out);
  return out;
}

std::optional<WindowPrediction> by_cvodes(MotionCourse course, const std::vector<double>& times,
                                          const WindowParameters& start, const ShootingPrior& prior,
                                          const Vector2d& trim, double drag_log_factor, double k) {
  for (auto& node : course) {
    node.lift = true_lift(node.lift, k);
    node.v_down /= k;
  }
  MotionParameters p;
  p.wind = start.wind / k;
  p.drag = times_factor(prior.drag, drag_log_factor);
  p.trim = trim;
  std::vector<double> within = times;
  for (auto& t : within) t = std::clamp(t, course.front().time, course.back().time);
  const auto states = integrate(course, start.v0 / k, Vector2d::Zero(), p, within);
  if (!states) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(times.size());
  WindowPrediction out{Eigen::VectorXd(2 * n), Eigen::MatrixXd::Zero(2 * n, 7)};
  for (Eigen::Index row = 0; row < n; ++row) {
    const auto& state = (*states)[static_cast<std::size_t>(row)];
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Eigen::Index r = row + axis * n;
      const auto s = state.sensitivity.row(axis);
      out.v(r) = k * state.v(axis);
      out.jacobian.block<1, 4>(r, 0) = s.segment<4>(m_v0_n);
      out.jacobian.block<1, 2>(r, 4) = k * s.segment<2>(m_trim_x);
      out.jacobian(r, 6) = k * (p.drag.linear * s(m_linear) + p.drag.quadratic * s(m_quadratic));
    }
  }
  return out;
}

}  // namespace quadsonde::ingest
