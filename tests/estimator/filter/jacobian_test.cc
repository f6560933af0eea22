// No Jacobian is believed: analytic against central differences, at an attitude aligned with no axis.
#include <gtest/gtest.h>

#include "tests/estimator/filter/model_at.h"

namespace quadsonde::estimator {
namespace {

StateMatrix<double> numerical_Phi(const WindModel<double>& m, const State<double>& x, const StepInput<double>& in) {
  StateMatrix<double> J;
  constexpr double h = 1e-4;
  for (int i = 0; i < 8; ++i) {
    State<double> low = x, high = x;
    low(i) -= h, high(i) += h;
    J.col(i) = (propagate(m, high, in).x - propagate(m, low, in).x) / (2 * h);
  }
  return J;
}

/// Where the step begins after one unit more of a parameter, through the model itself.
State<double> moved(WindModel<double> m, State<double> x, StepInput<double> in, int parameter, double by) {
  switch (parameter) {
    case c_linear:
      m.drag.linear += by;
      break;
    case c_quadratic:
      m.drag.quadratic += by;
      break;
    case c_climb_linear:
      m.drag.climb_linear += by;
      break;
    case c_climb_quadratic:
      m.drag.climb_quadratic += by;
      break;
    case c_latency:
      in.slope -= by * in.slope_rate;
      break;  // the attitude is read earlier
    case c_heading:
      in.slope = turn(by) * in.slope, in.heading += by;
      break;
    case c_trim_x:
      x(i_b) += by;
      break;
    case c_trim_y:
      x(i_b + 1) += by;
      break;
  }
  return propagate(m, x, in).x;
}

Sensitivity<double> numerical_F(const WindModel<double>& m, const State<double>& x, const StepInput<double>& in) {
  Sensitivity<double> F;
  constexpr double h = 1e-5;
  for (int p = 0; p < consider_count; ++p) F.col(p) = (moved(m, x, in, p, h) - moved(m, x, in, p, -h)) / (2 * h);
  if (m.trim_is_state) F.rightCols<2>().setZero();
  F.bottomRows<2>().setZero();  // a frozen trim's own change is not a change of what is estimated
  return F;
}

TEST(Jacobian, OfTheLinearLawIsExactOnAndOffBalance) {
  for (const double v_down : {0.0, -3.0, 2.0})
    for (const double step : {0.1, 1.0}) {
      const auto m = linear_model();
      const auto in = oblique_input(v_down, step);
      const auto t = propagate(m, oblique_state(), in);
      EXPECT_LT((t.Phi - numerical_Phi(m, oblique_state(), in)).cwiseAbs().maxCoeff(), 1e-10);
    }
}

TEST(Jacobian, OfTheQuadraticLawIsExactInBalanceInLevelFlight) {
  const auto m = quadratic_model();
  const auto in = oblique_input(0);
  const auto x = in_balance(m, oblique_state(), in);
  EXPECT_LT((propagate(m, x, in).Phi - numerical_Phi(m, x, in)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Jacobian, OfTheQuadraticLawDropsOnlyWhatModelMdNames) {
  const auto m = quadratic_model();
  // Off balance: h^2/2 |dA/da| |vdot|, with kappa .02, vdot 1.7 m/s2 and h .1 about 3e-4.
  const auto in = oblique_input(0);
  EXPECT_LT((propagate(m, oblique_state(), in).Phi - numerical_Phi(m, oblique_state(), in)).cwiseAbs().maxCoeff(),
            5e-4);
  // Climbing: h kappa |s| |v_d| = .1 .02 .153 3 = 9e-4, beside E's own 1 - E of 3e-2.
  const auto climbing = oblique_input(-3);
  const auto x = in_balance(m, oblique_state(), climbing);
  EXPECT_LT((propagate(m, x, climbing).Phi - numerical_Phi(m, x, climbing)).cwiseAbs().maxCoeff(), 1e-3);
}

void expect_sensitivities(const WindModel<double>& m, const State<double>& x, const StepInput<double>& in,
                          double relative) {
  const auto F = propagate(m, x, in).F;
  const auto expected = numerical_F(m, x, in);
  for (int p = 0; p < consider_count; ++p)
    EXPECT_LT((F.col(p) - expected.col(p)).norm(), relative * expected.col(p).norm() + 1e-9) << "parameter " << p;
}

TEST(ConsiderSensitivities, AreExactInBalance) {
  for (const double v_down : {0.0, -3.0, 1.5})
    for (auto m : {linear_model(), quadratic_model()})
      for (const bool trim_is_state : {true, false}) {
        m.trim_is_state = trim_is_state;
        const auto in = oblique_input(v_down);
        const auto x = in_balance(m, oblique_state(), in);
        // The differences' own error, 1e-5 squared times the third derivative, is what the tolerance holds.
        expect_sensitivities(m, x, in, 1e-6);
      }
}

TEST(ConsiderSensitivities, AreCarriedOverTheStepAsAConstantOffBalance) {
  auto m = linear_model();
  m.trim_is_state = false;
  // The parameter's pull fades over the step with the airspeed's own change: half of c h, and u's decay.
  expect_sensitivities(m, oblique_state(), oblique_input(-2), 0.03);
  expect_sensitivities(quadratic_model(), oblique_state(), oblique_input(-2), 0.03);
}

TEST(ConsiderSensitivities, OfTheClimbLawVanishWhereItIsClipped) {
  auto m = linear_model();
  m.drag.climb_linear = 0.2;
  const auto in = oblique_input(-3);
  const auto t = propagate(m, oblique_state(), in);
  EXPECT_EQ(t.F.col(c_climb_linear).norm(), 0);
  EXPECT_EQ(t.F.col(c_climb_quadratic).norm(), 0);
  EXPECT_GT(t.F.col(c_linear).norm(), 0);
}

}  // namespace
}  // namespace quadsonde::estimator
