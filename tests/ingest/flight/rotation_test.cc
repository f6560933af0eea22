#include "ingest/flight/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace quadsonde::ingest {
namespace {

constexpr double degree = std::numbers::pi / 180;

TEST(Rotation, RoundTripsAtAttitudesAlignedWithNoAxis) {
  for (const double roll : {-170.0, -31.0, 7.0, 88.0})
    for (const double pitch : {-85.0, -13.0, 21.0, 64.0})
      for (const double yaw : {-179.0, -77.0, 33.0, 154.0}) {
        const EulerAngles angles{roll * degree, pitch * degree, yaw * degree};
        const auto back = euler_from_q_NB(q_NB_from_euler(angles));
        EXPECT_NEAR(back.roll, angles.roll, 1e-13);
        EXPECT_NEAR(back.pitch, angles.pitch, 1e-13);
        EXPECT_NEAR(back.yaw, angles.yaw, 1e-13);
        EXPECT_NEAR(heading(q_NB_from_euler(angles)), angles.yaw, 1e-13);
      }
}

TEST(Rotation, TurnsBodyAxesIntoNorthEastDown) {
  // Nose east, nose up 30 degrees: the nose points east and up.
  const auto q_NB = q_NB_from_euler({0, 30 * degree, 90 * degree});
  const Eigen::Vector3d nose = q_NB * Eigen::Vector3d::UnitX();
  EXPECT_NEAR((nose - Eigen::Vector3d(0, std::cos(30 * degree), -0.5)).norm(), 0, 1e-15);
  // Right wing down: the right wing points down.
  const Eigen::Vector3d right = q_NB_from_euler({20 * degree, 0, 0}) * Eigen::Vector3d::UnitY();
  EXPECT_GT(right.z(), 0);
}

TEST(Rotation, GivesTheBodyDownAxisOfTheDerivation) {
  // In heading axes n = (sin theta cos phi, -sin phi, cos theta cos phi): design notes, section 5.
  const double phi = 11 * degree, theta = -17 * degree, psi = 128 * degree;
  const Eigen::Vector3d n = q_NB_from_euler({phi, theta, psi}) * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d in_heading = Eigen::AngleAxisd(-psi, Eigen::Vector3d::UnitZ()) * n;
  const Eigen::Vector3d expected(std::sin(theta) * std::cos(phi), -std::sin(phi), std::cos(theta) * std::cos(phi));
  EXPECT_NEAR((in_heading - expected).norm(), 0, 1e-15);
}

TEST(Rotation, StaysFiniteWhereYawAndRollAreOne) {
  const auto straight_up = euler_from_q_NB(q_NB_from_euler({0.3, 90 * degree, 0.4}));
  EXPECT_NEAR(straight_up.pitch, 90 * degree, 1e-7);
  EXPECT_TRUE(std::isfinite(straight_up.roll) && std::isfinite(straight_up.yaw));
}

TEST(WrapAngle, StaysAboveMinusPiAndReachesPi) {
  EXPECT_DOUBLE_EQ(wrap_angle(-std::numbers::pi), std::numbers::pi);
  EXPECT_DOUBLE_EQ(wrap_angle(std::numbers::pi), std::numbers::pi);
  EXPECT_NEAR(wrap_angle(7 * std::numbers::pi + 0.25), -std::numbers::pi + 0.25, 1e-14);
  EXPECT_DOUBLE_EQ(wrap_angle(-0.5), -0.5);
}

}  // namespace
}  // namespace quadsonde::ingest
