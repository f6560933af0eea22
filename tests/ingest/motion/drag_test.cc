#include "ingest/motion/drag.h"

#include <gtest/gtest.h>

#include <cmath>

namespace quadsonde::ingest {
namespace {

constexpr DragLaw<double> law{0.25, 0.02, 0.03, 0.001};

TEST(DragLaw, IsLinearPlusQuadraticTimesTheClimbFactor) {
  EXPECT_DOUBLE_EQ(drag_coefficient<double>({0.25, 0, 0, 0}, 7, 3), 0.25);
  EXPECT_DOUBLE_EQ(drag_coefficient<double>({0.25, 0.02, 0, 0}, 5, 0), 0.35);
  EXPECT_DOUBLE_EQ(drag_coefficient(law, 5.0, 2.0), 0.35 * std::exp(0.064));
  EXPECT_DOUBLE_EQ(drag_coefficient(law, 5.0, -2.0), 0.35 * std::exp(-0.056)) << "descending lowers it";
}

TEST(DragLaw, ClimbFactorIsKeptBetweenPointThreeAndOnePointThree) {
  const DragLaw<double> steep{0.25, 0, 0.2, 0};
  EXPECT_FALSE(climb_factor(steep, 1.3).clipped);
  EXPECT_DOUBLE_EQ(climb_factor(steep, 1.3).value, std::exp(0.26));
  EXPECT_TRUE(climb_factor(steep, 1.32).clipped);
  EXPECT_DOUBLE_EQ(climb_factor(steep, 50.0).value, 1.3);
  EXPECT_FALSE(climb_factor(steep, -6.0).clipped);
  EXPECT_TRUE(climb_factor(steep, -6.1).clipped);
  EXPECT_DOUBLE_EQ(climb_factor(steep, -50.0).value, 0.3);
  EXPECT_NEAR(climb_factor(steep, 1.3118).value, 1.3, 1e-4) << "no step where the clip begins";
}

TEST(EquationOne, EqualsAComputationByHand) {
  // |a| = sqrt 29, c = (.25 + .02 sqrt 29) exp(.064) = 0.3813448...; N: .1 (9.3 + 2 c) - 3 c + .02,
  // E: -.05 (9.3 + 2 c) + 4 c - .01.
  const Eigen::Vector2d vdot = horizontal_acceleration<double>(law, {0.1, -0.05}, 9.3, {3, -4, -2}, {0.02, -0.01});
  const double c = (0.25 + 0.02 * 5.385164807134504) * 1.0660923987615052;
  EXPECT_NEAR(vdot.x(), 0.95 - 2.8 * c, 1e-14);
  EXPECT_NEAR(vdot.y(), -0.475 + 3.9 * c, 1e-14);
  EXPECT_NEAR(vdot.x(), -0.117765, 1e-6);
  EXPECT_NEAR(vdot.y(), 1.012244, 1e-6);
}

TEST(EquationOne, IsTheVectorEquationWithTheThrustEliminated) {
  // vdot = g e3 - tau n - c a + trim: pick any thrust and attitude, form vdot, and equation (1) must give its
  // horizontal part without knowing the thrust.
  const Eigen::Vector3d n = Eigen::Vector3d(-0.21, 0.13, 0.9).normalized(), a_N(2.5, 1.5, -3.5);
  const double c = drag_coefficient(law, a_N.norm(), 3.5);
  for (const double tau : {3.0, 9.8, 15.0}) {
    const Eigen::Vector3d vdot = standard_gravity * Eigen::Vector3d::UnitZ() - tau * n - c * a_N;
    const Eigen::Vector2d told =
        horizontal_acceleration<double>(law, thrust_slope<double>(n), standard_gravity - vdot.z(), a_N, {0, 0});
    EXPECT_LT((told - vdot.head<2>()).norm(), 1e-13) << tau;
  }
}

TEST(EquationOne, LeaningNorthPullsNorth) {
  const Eigen::Vector3d n_nose_down_heading_north(-std::sin(0.1), 0, std::cos(0.1));
  EXPECT_NEAR(thrust_slope<double>(n_nose_down_heading_north).x(), std::tan(0.1), 1e-15);
}

TEST(DragLaw, ScalesWithAirDensityAndMass) {
  const auto high = scaled<double>(law, 0.81, 1, 0.5);
  EXPECT_DOUBLE_EQ(high.linear, 0.25 * 0.9) << "rotor drag: the root of the density";
  EXPECT_DOUBLE_EQ(high.quadratic, 0.02 * 0.81) << "body drag: the density";
  const auto heavy = scaled<double>(law, 1, 4, 0.5);
  EXPECT_DOUBLE_EQ(heavy.linear, 0.125);
  EXPECT_DOUBLE_EQ(heavy.quadratic, 0.005);
  EXPECT_DOUBLE_EQ(scaled<double>(law, 0.81, 1, 1).linear, 0.25 * 0.81) << "exponent 1: all of it with the density";
  EXPECT_EQ(high.climb_linear, law.climb_linear);
  EXPECT_EQ(high.climb_quadratic, law.climb_quadratic);
}

}  // namespace
}  // namespace quadsonde::ingest
