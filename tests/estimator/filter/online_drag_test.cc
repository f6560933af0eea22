#include "estimator/filter/online_drag.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace quadsonde::estimator {
namespace {

TEST(RecentExcitation, IsThatOfThePastMinuteOnly) {
  RecentExcitation recent;
  double t = 0;
  for (; t < 100; t += 0.1) {
    const double course = std::floor(t / 10) * 1.5707963;
    recent.add(t, 3 * std::cos(course), 3 * std::sin(course), 0.3 * t, 0.1);
  }
  // A minute is one and a half rounds, so a part of the square is its mean.
  EXPECT_NEAR(recent.index(), 2.9, 0.1) << "a square of 3 m/s with a yaw of its own";
  for (; t < 200; t += 0.1) recent.add(t, 0, 0, 0.3 * t, 0.1);
  EXPECT_LT(recent.index(), 1e-6);
}

TEST(RecentExcitation, SaysNothingBeforeHalfAMinute) {
  RecentExcitation recent;
  for (int k = 0; k < 290; ++k) recent.add(0.1 * k, k % 100 < 50 ? 3 : -3, 0, 0.03 * k, 0.1);
  EXPECT_EQ(recent.index(), 0);
  for (int k = 290; k < 320; ++k) recent.add(0.1 * k, k % 100 < 50 ? 3 : -3, 0, 0.03 * k, 0.1);
  EXPECT_GT(recent.index(), 2);
}

TEST(RecentExcitation, CountsNothingTwiceAcrossAGap) {
  RecentExcitation recent;
  for (int k = 0; k < 600; ++k) recent.add(0.1 * k, k % 100 < 50 ? 3 : -3, 0, 0.03 * k, 0.1);
  EXPECT_GT(recent.index(), 2);
  for (int k = 0; k < 350; ++k) recent.add(200 + 0.1 * k, 0, 0, 0.03 * k, 0.1);
  EXPECT_LT(recent.index(), 1e-6) << "what lies before the gap is older than a minute";
}

WindModel<double> model(double drag) {
  WindModel<double> m;
  m.drag = {drag, 0.01, 0, 0};
  return m;
}

StepInput<double> input(int k) {
  StepInput<double> in;
  in.slope = {0.1 * std::sin(0.05 * k) - 0.05, 0.08 * std::cos(0.03 * k)};
  in.slope_rate = {0.05 * std::cos(0.05 * k), -0.024 * std::sin(0.03 * k)};
  in.heading = 0.03 * k;
  return in;
}

Vector2<double> velocity(int k) { return {2 * std::sin(0.05 * k), 2 * std::cos(0.04 * k)}; }

WindFilter<double> flown(double drag, double kappa_factor, int steps) {
  auto m = model(drag);
  m.drag.quadratic *= kappa_factor;
  FilterLimits<double> limits;
  limits.gate_nis = 1e9;
  WindFilter<double> filter(m, limits);
  filter.start(velocity(0), {0, 0}, 0.2 * Eigen::Matrix2d::Identity());
  for (int k = 1; k < steps; ++k) filter.step(input(k), velocity(k), 0.01);
  return filter;
}

/// The state that the same gains leave where the drag is another: only means follow the parameters.
State<double> with_gains_of(WindFilter<double> standing, const WindModel<double>& other, int steps) {
  State<double> x = standing.state();
  for (int k = 1; k < steps; ++k) {
    standing.predict(input(k));
    const Eigen::Matrix<double, 8, 2> PH = standing.covariance().leftCols<2>();
    const Eigen::Matrix2d spread = PH.topRows<2>() + 0.01 * Eigen::Matrix2d::Identity();
    const Eigen::Matrix<double, 8, 2> gain = PH * spread.inverse();
    standing.update(velocity(k), 0.01);
    x = propagate(other, x, input(k)).x;
    x += gain * (velocity(k) - x.segment<2>(i_v)).eval();
  }
  return x;
}

// The sensitivities of a step are right to half of c h, 1.3 %, away from balance.
TEST(WindFilter, AdoptsAnotherDragAsIfItsMeansHadFlownWithItAllAlong) {
  constexpr double ln_factor = 0.01;
  auto filter = flown(0.25, 1, 300);
  const auto before = filter.state();
  filter.adopt(ln_factor, 0);
  auto other = model(0.25 * std::exp(ln_factor));
  other.drag.quadratic *= std::exp(ln_factor);
  const State<double> moved = filter.state() - before;
  const State<double> meant = with_gains_of(flown(0.25, 1, 1), other, 300) - before;
  EXPECT_GT(meant.norm(), 0.003);
  EXPECT_LT((moved - meant).norm(), 0.1 * meant.norm()) << moved.transpose() << " against " << meant.transpose();
  EXPECT_NEAR(filter.model().drag.linear, other.drag.linear, 1e-12);
  EXPECT_NEAR(filter.model().drag.quadratic, other.drag.quadratic, 1e-12);
}

ParameterMatrix<double> prior() {
  ParameterMatrix<double> C = ParameterMatrix<double>::Zero();
  C(c_linear, c_linear) = 0.005;
  C(c_quadratic, c_quadratic) = 1.6e-5;
  C(c_linear, c_quadratic) = C(c_quadratic, c_linear) = -1e-4;
  C(c_latency, c_latency) = 0.0064;
  C(c_heading, c_heading) = 0.0012;
  return C;
}

TEST(DragKnowledge, IsThePriorBitForBitWhileNothingIsLearned) {
  DragKnowledge<double> known({0.25, 0.01, 0, 0}, prior(), 0.025);
  const auto filter = flown(0.25, 1, 50);
  EXPECT_FALSE(known.learn(filter, velocity(50), 0.01, 18.4, 0.1, false));
  EXPECT_EQ(known.covariance({0.25, 0.01, 0, 0}), prior());
  EXPECT_EQ(known.mean(), ParameterVector<double>::Zero());
}

TEST(DragKnowledge, StatesTheSameCovarianceInBothCoordinates) {
  DragKnowledge<double> known({0.25, 0.01, 0, 0}, prior(), 0);
  auto filter = flown(0.25, 1, 50);
  filter.predict(input(50));
  // A velocity so uncertain that it teaches nothing: the way there and back is all that is left.
  EXPECT_TRUE(known.learn(filter, velocity(50), 1e12, 18.4, 0.1, true));
  EXPECT_LT((known.covariance({0.25, 0.01, 0, 0}) - prior()).norm(), 1e-9);
}

TEST(DragKnowledge, MovesOnlyDragAndLatencyAndNeverGrows) {
  DragKnowledge<double> known({0.25, 0.01, 0, 0}, prior(), 0);
  auto filter = flown(0.25, 1, 50);
  double variance = known.ln_factor_variance();
  for (int k = 50; k < 400; ++k) {
    filter.predict(input(k));
    known.learn(filter, velocity(k), 0.01, 1e9, 0.1, true);
    EXPECT_LT(known.ln_factor_variance(), 1.021 * variance) << k;
    variance = known.ln_factor_variance();
    filter.update(velocity(k), 0.01);
  }
  for (const int i : {c_quadratic, c_climb_linear, c_climb_quadratic, c_heading, c_trim_x, c_trim_y})
    EXPECT_EQ(known.mean()(i), 0);
  EXPECT_NE(known.mean()(c_linear), 0);
  EXPECT_LT(variance, 0.08);
  EXPECT_NEAR(known.covariance({0.25, 0.01, 0, 0})(c_heading, c_heading), 0.0012, 1e-12) << "kept, not learned";
}

}  // namespace
}  // namespace quadsonde::estimator
