#include <gtest/gtest.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "tests/estimator/filter/model_at.h"

namespace quadsonde::estimator {
namespace {

using Augmented = Eigen::Matrix<double, 9, 9>;

/// d/dt [x; 1] of the linear law.
Augmented rate(const WindModel<double>& m, const StepInput<double>& in) {
  const double c = m.drag.linear * ingest::climb_factor(m.drag, -in.v_down).value;
  const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
  Augmented A = Augmented::Zero();
  A.block<2, 2>(i_v, i_v) = -c * I;
  A.block<2, 2>(i_v, i_W) = A.block<2, 2>(i_v, i_u) = c * I;
  A.block<2, 2>(i_v, i_b) = turn(in.heading);
  A.block<2, 1>(i_v, 8) = in.slope * (in.lift - c * in.v_down);
  A.block<2, 2>(i_u, i_u) = -I / m.turbulence_time;
  return A;
}

void expect_matrix_exponential(const WindModel<double>& m, const StepInput<double>& in) {
  const Augmented T = (rate(m, in) * in.step).exp();
  const State<double> x = oblique_state();
  const auto t = propagate(m, x, in);
  EXPECT_LT((t.Phi - T.topLeftCorner<8, 8>()).cwiseAbs().maxCoeff(), 1e-12);
  const State<double> expected = T.topLeftCorner<8, 8>() * x + T.topRightCorner<8, 1>();
  EXPECT_LT((t.x - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Transition, IsTheMatrixExponentialOfTheLinearLaw) {
  for (const double step : {0.005, 0.1, 0.25, 2.0})
    for (const double v_down : {0.0, -3.0, 2.0}) expect_matrix_exponential(linear_model(), oblique_input(v_down, step));
}

TEST(Transition, IsTheMatrixExponentialWhereDragAndTurbulenceDecayAlike) {
  // delta = 1/T_L: the quotient (e - E)/(delta - 1/T_L) becomes 0/0, and near it loses its digits if formed naively.
  for (const double off : {0.0, 1e-15, 1e-12, -1e-10, 1e-8, -1e-6, 1e-4}) {
    auto m = linear_model();
    m.drag = {0.25, 0, 0, 0};
    m.turbulence_time = 4 * (1 + off);
    expect_matrix_exponential(m, oblique_input(0));
    expect_matrix_exponential(m, oblique_input(0, 2));
  }
}

TEST(Transition, WithAFrozenTrimStillPushesByItButDoesNotSpreadIt) {
  auto m = linear_model();
  const auto with = propagate(m, oblique_state(), oblique_input(-1));
  m.trim_is_state = false;
  const auto without = propagate(m, oblique_state(), oblique_input(-1));
  EXPECT_EQ(with.x, without.x);
  EXPECT_EQ((without.Phi.block<2, 2>(i_v, i_b).norm()), 0);
  EXPECT_EQ((without.F.block<2, 2>(i_v, c_trim_x)), (with.Phi.block<2, 2>(i_v, i_b)));
}

/// Classic Runge and Kutta in 200 sub-steps.
State<double> integrated(const WindModel<double>& m, State<double> x, const StepInput<double>& in) {
  const auto rates = [&](const State<double>& y) {
    State<double> d = State<double>::Zero();
    d.segment<2>(i_v) = acceleration(m, y, in);
    d.segment<2>(i_u) = -y.segment<2>(i_u) / m.turbulence_time;
    return d;
  };
  constexpr int parts = 200;
  const double h = in.step / parts;
  for (int i = 0; i < parts; ++i) {
    const State<double> k1 = rates(x), k2 = rates(x + h / 2 * k1), k3 = rates(x + h / 2 * k2), k4 = rates(x + h * k3);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return x;
}

double error_of(const WindModel<double>& m, const State<double>& x, const StepInput<double>& in) {
  return (propagate(m, x, in).x - integrated(m, x, in)).norm();
}

TEST(Transition, OfTheQuadraticLawMeetsFineRungeKuttaSteps) {
  const auto m = quadratic_model();
  // Off balance by about 1.7 m/s2, 10 Hz: the curvature of the drag over one step; measured 5e-6 m/s.
  EXPECT_LT(error_of(m, oblique_state(), oblique_input(0)), 2e-5);
  // In balance only rounding and the sub-steps are left.
  const auto still = in_balance(m, oblique_state(), oblique_input(0));
  EXPECT_LT(error_of(m, still, oblique_input(0)), 1e-12);
  // Climbing, the change of c in s c v_d over the step is frozen: h^2/2 kappa s v_d vdot.
  EXPECT_LT(error_of(m, oblique_state(), oblique_input(-3)), 1e-4);
}

TEST(Transition, OfTheQuadraticLawIsOfSecondOrder) {
  // Local error of third order: half the step, an eighth of the error.
  const auto m = quadratic_model();
  const double whole = error_of(m, oblique_state(), oblique_input(0, 0.4));
  const double half = error_of(m, oblique_state(), oblique_input(0, 0.2));
  EXPECT_GT(whole / half, 6);
  EXPECT_LT(whole / half, 10);
}

TEST(Transition, OfTheQuadraticLawIsFiniteInStillAir) {
  auto m = quadratic_model();
  StepInput<double> in;
  const auto t = propagate(m, State<double>(State<double>::Zero()), in);
  EXPECT_TRUE(t.Phi.allFinite() && t.Q.allFinite() && t.F.allFinite());
  EXPECT_EQ(t.x, State<double>::Zero());
}

TEST(Transition, IsTheSameInFloatWithinItsDigits) {
  const auto in = oblique_input(-2);
  StepInput<float> f;
  f.slope = in.slope.cast<float>();
  f.slope_rate = in.slope_rate.cast<float>();
  f.lift = static_cast<float>(in.lift);
  f.v_down = static_cast<float>(in.v_down);
  f.heading = static_cast<float>(in.heading);
  f.step = static_cast<float>(in.step);
  const auto d = propagate(linear_model(), oblique_state(), in);
  const auto s = propagate(linear_model<float>(), State<float>(oblique_state().cast<float>()), f);
  EXPECT_LT((s.x.cast<double>() - d.x).norm(), 2e-6);
  EXPECT_LT((s.Phi.cast<double>() - d.Phi).norm(), 2e-6);
  EXPECT_LT((s.Q.cast<double>() - d.Q).norm() / d.Q.norm(), 2e-6);
}

}  // namespace
}  // namespace quadsonde::estimator
