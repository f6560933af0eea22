#include <gtest/gtest.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "tests/estimator/filter/model_at.h"

namespace quadsonde::estimator {
namespace {

using Long = long double;
using Matrix8 = Eigen::Matrix<Long, 8, 8>;
using Matrix16 = Eigen::Matrix<Long, 16, 16>;

/// Van Loan (1978): exp([-A Qc; 0 A'] h) = [. Phi^-1 Q; 0 Phi'], in long double so that the reference is the better
/// one.
Matrix8 van_loan(const Matrix8& A, const Matrix8& Qc, Long h) {
  Matrix16 M = Matrix16::Zero();
  M.topLeftCorner<8, 8>() = -A * h;
  M.topRightCorner<8, 8>() = Qc * h;
  M.bottomRightCorner<8, 8>() = A.transpose() * h;
  const Matrix16 T = M.exp();
  return T.bottomRightCorner<8, 8>().transpose() * T.topRightCorner<8, 8>();
}

/// The continuous model, written down a second time from MODEL.md section 3.
Matrix8 reference_noise(const WindModel<double>& m, const State<double>& x, const StepInput<double>& in) {
  const Eigen::Vector2d a_h = x.segment<2>(i_v) - x.segment<2>(i_W) - x.segment<2>(i_u);
  const double airspeed = std::hypot(a_h.norm(), in.v_down), v_c = -in.v_down;
  const auto climb = ingest::climb_factor(m.drag, v_c);
  const double c = (m.drag.linear + m.drag.quadratic * airspeed) * climb.value;
  const Eigen::Matrix2d D = c * Eigen::Matrix2d::Identity() +
                            m.drag.quadratic * climb.value / std::max(airspeed, 0.1) * a_h * a_h.transpose();
  Matrix8 A = Matrix8::Zero(), Qc = Matrix8::Zero();
  A.block<2, 2>(i_v, i_v) = -D.cast<Long>();
  A.block<2, 2>(i_v, i_W) = A.block<2, 2>(i_v, i_u) = D.cast<Long>();
  A.block<2, 2>(i_v, i_b) = turn(in.heading).cast<Long>();
  A.block<2, 2>(i_u, i_u) = -Eigen::Matrix2d::Identity().cast<Long>() / m.turbulence_time;
  const double bend = climb.clipped ? 0 : m.drag.climb_linear + 2 * m.drag.climb_quadratic * v_c;
  const double lever = (c - in.lift * bend) * m.vertical_sd;
  const double q[] = {m.tilt_psd + 2 * lever * lever * in.slope.squaredNorm() * m.vertical_time,
                      m.wind_time_psd + m.wind_height_psd * std::abs(in.v_down),
                      2 * m.turbulence_sd * m.turbulence_sd / m.turbulence_time, m.trim_is_state ? m.trim_psd : 0};
  for (int i = 0; i < 8; ++i) Qc(i, i) = q[i / 2];
  return van_loan(A, Qc, in.step);
}

/// Largest difference, each entry against the two variances it stands between.
double relative_error(const StateMatrix<double>& Q, const Matrix8& expected) {
  double worst = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      const double scale = static_cast<double>(std::sqrt(expected(i, i) * expected(j, j)));
      const double error = std::abs(static_cast<double>(Q(i, j) - expected(i, j)));
      worst = std::max(worst, scale > 0 ? error / scale : error);
    }
  return worst;
}

TEST(ProcessNoise, EqualsVanLoanForTheLinearLaw) {
  for (const double step : {0.01, 0.1, 0.5, 1.0, 2.0})
    for (const double v_down : {0.0, -3.0, 3.0}) {
      const auto in = oblique_input(v_down, step);
      const auto t = propagate(linear_model(), oblique_state(), in);
      // Four Gauss points leave 3e-8 at 2 s, the longest step that the filter makes without a restart.
      EXPECT_LT(relative_error(t.Q, reference_noise(linear_model(), oblique_state(), in)), step > 1 ? 4e-8 : 1e-9)
          << "step " << step << " v_down " << v_down;
    }
}

TEST(ProcessNoise, EqualsVanLoanForTheQuadraticLawLinearisedAcrossNoAxis) {
  for (const double step : {0.1, 0.5}) {
    const auto in = oblique_input(-2, step);
    const auto t = propagate(quadratic_model(), oblique_state(), in);
    EXPECT_LT(relative_error(t.Q, reference_noise(quadratic_model(), oblique_state(), in)), 1e-9) << step;
  }
}

TEST(ProcessNoise, OfAFrozenTrimIsNone) {
  auto m = linear_model();
  m.trim_is_state = false;
  const auto in = oblique_input(-1);
  const auto t = propagate(m, oblique_state(), in);
  EXPECT_EQ(t.Q.bottomRows<2>().norm(), 0);
  EXPECT_LT(relative_error(t.Q, reference_noise(m, oblique_state(), in)), 1e-9);
}

TEST(ProcessNoise, FollowsTheClimbLawOnlyWhereItIsNotClipped) {
  auto m = linear_model();
  m.drag.climb_linear = 0.2;
  const auto in = oblique_input(-3);  // exponent .6 + .018, clipped at ln 1.3
  ASSERT_TRUE(ingest::climb_factor(m.drag, 3.0).clipped);
  const auto t = propagate(m, oblique_state(), in);
  EXPECT_LT(relative_error(t.Q, reference_noise(m, oblique_state(), in)), 1e-9);
}

TEST(ProcessNoise, IsSymmetricAndPositive) {
  const auto t = propagate(quadratic_model(), oblique_state(), oblique_input(-2));
  EXPECT_LT((t.Q - t.Q.transpose()).norm(), 1e-18);
  EXPECT_GT(t.Q.llt().matrixL().determinant(), 0);
  EXPECT_EQ(t.Q.llt().info(), Eigen::Success);
}

}  // namespace
}  // namespace quadsonde::estimator
