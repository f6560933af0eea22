#include "profiles/optimal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace quadsonde::profiles {
namespace {

using estimator::i_b;
using estimator::i_u;
using estimator::i_v;
using estimator::i_W;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix62 = Eigen::Matrix<double, 6, 2>;

/// Places of v, u and b among the eight states, and here.
constexpr int from8[] = {i_v, i_u, i_b};

/// Two nodes and their weights for one height.
struct Between {
  Eigen::Index low = 0, high = 0;
  double w_low = 1, w_high = 0;
};

Eigen::MatrixXd prior_of_one_component(const NodeSettings& s) {
  const auto n = static_cast<Eigen::Index>(s.count);
  Eigen::MatrixXd C(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      C(i, j) = s.level_sd * s.level_sd + s.height_psd * s.spacing * static_cast<double>(std::min(i, j));
  return C;
}

/// The filter of the design notes with the slow wind replaced by nodes. Moving states s = [v, u, b]; nodes n.
class NodeFilter {
 public:
  NodeFilter(const estimator::SmootherTrace& trace, const NodeSettings& settings)
      : settings_(settings), pass_(trace.settings), model_(trace.settings.model) {
    // A node's wind neither wanders in time nor along the way: height alone moves it.
    model_.wind_time_psd = 0;
    model_.wind_height_psd = 0;
    const auto n = static_cast<Eigen::Index>(2 * settings.count);
    nodes_ = Eigen::VectorXd::Zero(n);
    P_nn_ = Eigen::MatrixXd::Zero(n, n);
    P_sn_ = Eigen::MatrixXd::Zero(6, n);
    const Eigen::MatrixXd prior = prior_of_one_component(settings);
    for (Eigen::Index i = 0; i < prior.rows(); ++i)
      for (Eigen::Index j = 0; j < prior.cols(); ++j) P_nn_(2 * i, 2 * j) = P_nn_(2 * i + 1, 2 * j + 1) = prior(i, j);
    x_.setZero();
    x_.tail<2>() = pass_.trim;
    P_ss_.setZero();
    if (model_.trim_is_state) P_ss_.bottomRightCorner<2, 2>() = pass_.trim_covariance;
  }

  void run(const std::vector<estimator::Step>& steps, const std::vector<std::optional<double>>& heights) {
    bool running = false;
    double last = 0;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const auto& step = steps[k];
      if (!step.sound && !step.gap_before) continue;
      if (!running || step.gap_before || step.seconds - last > pass_.restart_after) {
        restart(step.v);
        running = true;
        last = step.seconds;
        continue;
      }
      predict(step, at(heights[k]));
      if (heights[k] && update(step)) last = step.seconds;
    }
  }

  NodeEstimate result() const {
    const auto n = static_cast<Eigen::Index>(settings_.count);
    NodeEstimate out;
    out.wind = Eigen::Map<const Eigen::Matrix2Xd>(nodes_.data(), 2, n);
    out.covariance = P_nn_;
    const Eigen::LLT<Eigen::MatrixXd> prior(prior_of_one_component(settings_));
    out.kernel = Eigen::MatrixXd::Zero(n, n);
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::MatrixXd C(n, n);
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) C(i, j) = P_nn_(2 * i + axis, 2 * j + axis);
      out.kernel += 0.5 * (Eigen::MatrixXd::Identity(n, n) - prior.solve(C).transpose());
    }
    return out;
  }

 private:
  Between at(const std::optional<double>& height) const {
    const double place = height ? (*height - settings_.lowest) / settings_.spacing : place_;
    place_ = std::clamp(place, 0.0, static_cast<double>(settings_.count - 1));
    Between b;
    b.low = static_cast<Eigen::Index>(place_);
    b.high = std::min<Eigen::Index>(b.low + 1, static_cast<Eigen::Index>(settings_.count) - 1);
    b.w_high = place_ - static_cast<double>(b.low);
    b.w_low = 1 - b.w_high;
    return b;
  }

  /// v and u from diffuse; trim and nodes keep what they know.
  void restart(const Eigen::Vector2d& v) {
    x_.head<4>().setZero();
    x_.head<2>() = v;
    P_ss_.topRows<4>().setZero();
    P_ss_.leftCols<4>().setZero();
    P_ss_.diagonal().head<2>().setConstant(pass_.limits.start_velocity_sd * pass_.limits.start_velocity_sd);
    P_ss_.diagonal().segment<2>(2).setConstant(model_.turbulence_sd * model_.turbulence_sd);
    P_sn_.topRows<4>().setZero();
  }

  void predict(const estimator::Step& step, const Between& b) {
    estimator::State<double> x8;
    x8 << x_.head<2>(), b.w_low * nodes_.segment<2>(2 * b.low) + b.w_high * nodes_.segment<2>(2 * b.high),
        x_.segment<2>(2), x_.tail<2>();
    const auto t = estimator::propagate(model_, x8, step.input);
    Matrix6 F, Q;
    for (int i = 0; i < 3; ++i) {
      x_.segment<2>(2 * i) = t.x.segment<2>(from8[i]);
      for (int j = 0; j < 3; ++j) {
        F.block<2, 2>(2 * i, 2 * j) = t.Phi.block<2, 2>(from8[i], from8[j]);
        Q.block<2, 2>(2 * i, 2 * j) = t.Q.block<2, 2>(from8[i], from8[j]);
      }
    }
    Matrix62 G = Matrix62::Zero();
    G.topRows<2>() = t.Phi.block<2, 2>(i_v, i_W);
    const Matrix62 P_sw = b.w_low * P_sn_.middleCols<2>(2 * b.low) + b.w_high * P_sn_.middleCols<2>(2 * b.high);
    const Eigen::Matrix2Xd P_wn = b.w_low * P_nn_.middleRows<2>(2 * b.low) + b.w_high * P_nn_.middleRows<2>(2 * b.high);
    const Eigen::Matrix2d P_ww = b.w_low * P_wn.middleCols<2>(2 * b.low) + b.w_high * P_wn.middleCols<2>(2 * b.high);
    const Matrix6 cross = F * P_sw * G.transpose();
    P_ss_ = (F * P_ss_ * F.transpose() + cross + cross.transpose() + G * P_ww * G.transpose() + Q).eval();
    P_sn_ = (F * P_sn_ + G * P_wn).eval();
  }

  bool update(const estimator::Step& step) {
    const Eigen::Vector2d error = step.v - x_.head<2>();
    const Eigen::Matrix2d S =
        P_ss_.topLeftCorner<2, 2>() + pass_.velocity_scale * step.variance * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d S_inverse = S.inverse();
    if (error.dot(S_inverse * error) > pass_.limits.gate_nis) return false;
    const Matrix62 K_s = P_ss_.leftCols<2>() * S_inverse;
    const Eigen::MatrixX2d K_n = P_sn_.topRows<2>().transpose() * S_inverse;
    x_ += K_s * error;
    nodes_ += K_n * error;
    const Eigen::Matrix2Xd P_vn = P_sn_.topRows<2>();
    const Eigen::Matrix<double, 2, 6> P_vs = P_ss_.topRows<2>();
    P_nn_.noalias() -= K_n * P_vn;
    P_sn_.noalias() -= K_s * P_vn;
    P_ss_ -= K_s * P_vs;
    P_ss_ = (0.5 * (P_ss_ + P_ss_.transpose())).eval();
    return true;
  }

  const NodeSettings& settings_;
  const estimator::PassSettings& pass_;
  estimator::WindModel<double> model_;
  Eigen::Matrix<double, 6, 1> x_;
  Eigen::VectorXd nodes_;
  Matrix6 P_ss_;
  Eigen::MatrixXd P_sn_, P_nn_;
  mutable double place_ = 0;  // of the last known height
};

}  // namespace

double NodeEstimate::resolution(std::size_t node, double spacing) const {
  const auto row = kernel.row(static_cast<Eigen::Index>(node));
  const double squares = row.squaredNorm();
  return squares > 0 ? row.sum() * row.sum() / squares * spacing : 0;
}

NodeEstimate estimate_nodes(const estimator::SmootherTrace& trace, const std::vector<std::optional<double>>& heights,
                            const NodeSettings& settings) {
  NodeFilter filter(trace, settings);
  filter.run(trace.input, heights);
  auto out = filter.result();
  return out;
}

}  // namespace quadsonde::profiles
