#include "ingest/motion/rigid_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace quadsonde::ingest {
namespace {

constexpr double rho = 1.19;

RigidState tumbling() {
  RigidState s;
  s.v = {3, -1, 0.5};
  s.q_NB = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized();
  s.omega_B = {2, -3, 1.5};
  return s;
}

TEST(RigidBody, FallsFreelyWhereThereIsNoAir) {
  const RigidVehicle vehicle;
  RigidState s = tumbling();
  const Eigen::Vector3d L = s.q_NB * vehicle.inertia.cwiseProduct(s.omega_B);
  const double energy = s.omega_B.dot(vehicle.inertia.cwiseProduct(s.omega_B));
  for (int i = 0; i < 500; ++i) advance(vehicle, s, PerRotor::Zero(), Eigen::Vector3d::Zero(), 0, 0.002);
  EXPECT_LT((s.v - Eigen::Vector3d(3, -1, 0.5 + standard_gravity)).norm(), 1e-11);
  EXPECT_LT((s.p - Eigen::Vector3d(3, -1, 0.5 + standard_gravity / 2)).norm(), 1e-11);
  EXPECT_LT((s.q_NB * vehicle.inertia.cwiseProduct(s.omega_B) - L).norm() / L.norm(), 1e-9) << "angular momentum";
  EXPECT_NEAR(s.omega_B.dot(vehicle.inertia.cwiseProduct(s.omega_B)) / energy, 1, 1e-9) << "energy of rotation";
}

TEST(RigidBody, TheStepIsShortEnough) {
  const RigidVehicle vehicle;
  const auto hover = trim(vehicle, Eigen::Vector3d::Zero(), 0, rho);
  ASSERT_TRUE(hover);
  RigidState coarse = hover->state;
  coarse.v = {2, 1, -1};
  coarse.omega_B = {1, -1, 0.5};
  RigidState fine = coarse;
  PerRotor command = hover->state.speed;
  command(0) *= 1.1;
  for (int i = 0; i < 100; ++i) advance(vehicle, coarse, command, {1, -2, 0.3}, rho, 0.002);
  for (int i = 0; i < 400; ++i) advance(vehicle, fine, command, {1, -2, 0.3}, rho, 0.0005);
  EXPECT_LT((coarse.p - fine.p).norm(), 1e-8);
  EXPECT_LT((coarse.v - fine.v).norm(), 1e-7);
  EXPECT_LT(coarse.q_NB.angularDistance(fine.q_NB), 1e-7);
}

TEST(RigidBody, InHoverThrustCarriesTheWeightAndTheWash) {
  RigidVehicle vehicle;
  const double weight = vehicle.mass * standard_gravity;
  const auto hover = trim(vehicle, Eigen::Vector3d::Zero(), 1, rho);
  ASSERT_TRUE(hover);
  EXPECT_NEAR(-hover->loads.force_B.z(), weight, 1e-9 * weight);
  EXPECT_LT((hover->state.q_NB * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-9) << "level";
  const double wash = 4 * 0.5 * rho * vehicle.wash_area * hover->loads.induced * hover->loads.induced;
  EXPECT_NEAR(hover->loads.thrust, weight + wash, 1e-9 * weight);
  vehicle.wash_area = 0;
  EXPECT_NEAR(trim(vehicle, Eigen::Vector3d::Zero(), 1, rho)->loads.thrust, weight, 1e-9 * weight);
}

TEST(RigidBody, TrimIsSteadyFlight) {
  const RigidVehicle vehicle;
  const Eigen::Vector3d through_air(4, -3, -2);
  const auto steady = trim(vehicle, through_air, 0.7, rho);
  ASSERT_TRUE(steady);
  RigidState s = steady->state;
  for (int i = 0; i < 50; ++i) advance(vehicle, s, steady->state.speed, Eigen::Vector3d::Zero(), rho, 0.002);
  EXPECT_LT((s.v - through_air).norm(), 1e-8);
  EXPECT_LT(s.omega_B.norm(), 1e-7);
}

TEST(RigidBody, ClimbingRaisesInflowAndRotorSpeed) {
  const RigidVehicle vehicle;
  double inflow = 0, speed = 0;
  for (const double climb : {-2.0, 0.0, 2.0, 5.0}) {
    const auto steady = trim(vehicle, {3, 0, -climb}, 0, rho);
    ASSERT_TRUE(steady);
    EXPECT_GT(steady->loads.inflow, inflow) << climb;
    EXPECT_GT(steady->state.speed(0), speed) << climb;
    inflow = steady->loads.inflow;
    speed = steady->state.speed(0);
  }
}

TEST(RigidBody, CannotFlyWhatItsRotorsCannotLift) {
  RigidVehicle heavy;
  heavy.mass = 6;
  EXPECT_FALSE(trim(heavy, Eigen::Vector3d::Zero(), 0, rho));
  EXPECT_FALSE(effective_drag(heavy, 3, 0, rho));
  EXPECT_FALSE(equivalent_drag(heavy, rho));
  EXPECT_FALSE(equivalent_vehicle(heavy, rho));
}

TEST(EffectiveDrag, IsNearThePublishedOneAtItsWinds) {
  // D 0.2303 N s/m over 0.896 kg, found in front of a generator of up to 3.8 m/s.
  for (const double airspeed : {3.0, 3.8})
    EXPECT_NEAR(*effective_drag(RigidVehicle{}, airspeed, 0, rho), 0.2570, 0.05 * 0.2570) << airspeed;
}

TEST(EffectiveDrag, GrowsWithAirspeedAndWithTheRotorsInflow) {
  const RigidVehicle vehicle;
  double last = 0;
  for (const double airspeed : {0.5, 2.0, 4.0, 6.0, 8.0, 10.0}) {
    const double c = *effective_drag(vehicle, airspeed, 0, rho);
    EXPECT_GT(c, last);
    last = c;
  }
  EXPECT_GT(*effective_drag(vehicle, 4, 3, rho), *effective_drag(vehicle, 4, 0, rho)) << "climbing";
  EXPECT_LT(*effective_drag(vehicle, 4, -2, rho), *effective_drag(vehicle, 4, 0, rho)) << "descending";
}

TEST(EffectiveDrag, OfARotorAloneIsThatOfItsForces) {
  // A level rotor's in-plane force over mass and airspeed; the tilt in trim is small at 0.5 m/s.
  RigidVehicle vehicle;
  vehicle.wash_area = 0;
  vehicle.body_area.setZero();
  const auto steady = trim(vehicle, {0.5, 0, 0}, 0, rho);
  double drag = 0;
  for (int i = 0; i < 4; ++i)
    drag -= rotor_load(vehicle.rotor, steady->state.speed(i), {0.5, 0, 0}, rho, RigidVehicle::spin(i)).force.x();
  EXPECT_NEAR(*effective_drag(vehicle, 0.5, 0, rho), drag / (vehicle.mass * 0.5), 0.01 * drag);
}

TEST(EffectiveDrag, IsMetByTheEquivalentLaw) {
  const RigidVehicle vehicle;
  const auto law = equivalent_drag(vehicle, rho);
  ASSERT_TRUE(law);
  for (const double airspeed : {0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0})
    for (const double from_deg : {0.0, 45.0, 90.0}) {
      const double c = *effective_drag(vehicle, airspeed, 0, rho, from_deg * std::numbers::pi / 180);
      EXPECT_NEAR(drag_coefficient(*law, airspeed, 0.0) / c, 1, 0.05) << airspeed << " m/s from " << from_deg;
    }
  for (const double climb : {-2.0, 1.0, 3.0, 5.0}) {
    const double c = *effective_drag(vehicle, 4, climb, rho);
    EXPECT_NEAR(drag_coefficient(*law, std::hypot(4, climb), climb) / c, 1, 0.04) << climb;
  }
}

TEST(EffectiveDrag, RotorDragGoesWithTheRootOfDensity) {
  // The design notes' law for another height: H-force at given thrust is proportional to sqrt(rho).
  RigidVehicle vehicle;
  vehicle.wash_area = 0;
  vehicle.body_area.setZero();
  const double high = *effective_drag(vehicle, 1, 0, 0.9), low = *effective_drag(vehicle, 1, 0, 1.2);
  EXPECT_NEAR(high / low, std::sqrt(0.75), 0.01);
}

TEST(RigidBody, HasSixOrEightRotorsToo) {
  for (const int rotors : {6, 8}) {
    RigidVehicle vehicle;
    vehicle.rotors = rotors;
    vehicle.mass = 0.224 * rotors;
    const auto hover = trim(vehicle, Eigen::Vector3d::Zero(), 0, rho);
    ASSERT_TRUE(hover) << rotors;
    EXPECT_EQ((hover->state.speed.array() > 0).count(), rotors);
    EXPECT_TRUE(effective_drag(vehicle, 5, 1, rho));
  }
}

}  // namespace
}  // namespace quadsonde::ingest
