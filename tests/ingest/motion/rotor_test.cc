#include "ingest/motion/rotor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace quadsonde::ingest {
namespace {

constexpr double rho = 1.19, omega = 1250;

Eigen::Vector3d flying(double ahead, double climb) { return {ahead, 0, -climb}; }

TEST(Rotor, HoverObeysMomentumTheory) {
  RotorModel rotor;
  rotor.induced_factor = 1;
  const auto load = rotor_load(rotor, omega, flying(0, 0), rho, 1);
  EXPECT_NEAR(load.induced, std::sqrt(load.thrust / (2 * rho * rotor.area())), 1e-9);
  EXPECT_EQ(load.force, Eigen::Vector3d(0, 0, -load.thrust)) << "no force in the plane of a rotor at rest in the air";
}

TEST(Rotor, InflowInForwardFlightIsGlauerts) {
  RotorModel rotor;
  for (const double ahead : {2.0, 8.0, 15.0})
    for (const double climb : {0.0, 3.0}) {
      const auto load = rotor_load(rotor, omega, flying(ahead, climb), rho, 1);
      const double through = std::hypot(ahead, climb + load.induced);
      EXPECT_NEAR(load.induced, rotor.induced_factor * load.thrust / (2 * rho * rotor.area() * through), 1e-9);
    }
}

TEST(Rotor, ThrustFallsWithTheClimbThroughTheAirAndRisesWithTheDescent) {
  const RotorModel rotor;
  double last = 1e9, through = 0;
  for (double climb = -3; climb <= 6; climb += 0.5) {
    const auto load = rotor_load(rotor, omega, flying(0, climb), rho, 1);
    EXPECT_LT(load.thrust, last) << climb;
    EXPECT_GT(climb + load.induced, through) << "more air goes through";
    last = load.thrust;
    through = climb + load.induced;
  }
}

TEST(Rotor, InPlaneForceIsProportionalToRotorSpeedAndToAirspeed) {
  const RotorModel rotor;
  const auto drag = [&](double speed, double ahead) {
    return -rotor_load(rotor, speed, flying(ahead, 0), rho, 1).force.x();
  };
  EXPECT_NEAR(drag(omega, 2) / drag(omega, 1), 2, 0.03);
  EXPECT_NEAR(drag(2 * omega, 1) / drag(omega, 1), 2, 0.03);
  EXPECT_NEAR(drag(2 * omega, 6) / drag(omega, 3), 4, 1e-9) << "at one advance ratio all goes with the square";
  EXPECT_GT(drag(omega, 1), 0) << "against the motion";
}

TEST(Rotor, FlappingTiltsTheThrustBackAndTowardsTheAdvancingBlade) {
  RotorModel stiff, soft;
  stiff.flapping_share = 0;
  soft.flapping_share = 1;
  const auto hard = rotor_load(stiff, omega, flying(4, 0), rho, 1),
             bent = rotor_load(soft, omega, flying(4, 0), rho, 1);
  EXPECT_LT(bent.force.x(), hard.force.x());
  EXPECT_EQ(hard.force.y(), 0);
  EXPECT_LT(bent.force.y(), 0) << "clockwise from above: the left blade advances";
  EXPECT_GT(rotor_load(soft, omega, flying(4, 0), rho, -1).force.y(), 0);
  EXPECT_NEAR(bent.force.y(), -rotor_load(soft, omega, flying(4, 0), rho, -1).force.y(), 1e-12);
}

TEST(Rotor, TurnsWithTheDirectionOfTheAir) {
  const RotorModel rotor;
  const auto ahead = rotor_load(rotor, omega, {5, 0, 1}, rho, 1).force;
  const auto aside = rotor_load(rotor, omega, {0, 5, 1}, rho, 1).force;
  EXPECT_NEAR(aside.y(), ahead.x(), 1e-12);
  EXPECT_NEAR(aside.x(), -ahead.y(), 1e-12);
}

TEST(Rotor, PowerIsAtLeastThatOfMomentumTheory) {
  const RotorModel rotor;
  const auto load = rotor_load(rotor, omega, flying(0, 0), rho, 1);
  const double ideal = load.thrust * std::sqrt(load.thrust / (2 * rho * rotor.area()));
  const double merit = ideal / (load.torque * omega);
  EXPECT_GT(merit, 0.5);
  EXPECT_LT(merit, 0.85) << "small propellers reach 0.6 to 0.7";
}

TEST(Rotor, DescentMeetsMomentumTheoryWhereThatHolds) {
  EXPECT_EQ(descent_factor(0), 1);
  EXPECT_EQ(descent_factor(3), 1);
  // At twice the hover velocity the windmill state has v_i = v_h exactly; the fit gives it within 3 %.
  EXPECT_NEAR(descent_factor(-2) * (1 + std::sqrt(2)), 1, 0.03);
  EXPECT_GT(descent_factor(-1), 1.05) << "the vortex ring draws more than momentum theory says";
}

}  // namespace
}  // namespace quadsonde::ingest
