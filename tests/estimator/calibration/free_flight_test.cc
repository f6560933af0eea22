#include "estimator/calibration/free_flight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/calibration/excitation.h"
#include "ingest/motion/simulator.h"

namespace quadsonde::estimator {
namespace {

using ingest::HeadingRule;
using ingest::PathLeg;

ingest::Simulation fly(PathLeg::Kind kind, HeadingRule heading, double duration, std::uint64_t seed = 1) {
  ingest::Scenario s;
  s.vehicle = ingest::published_vehicle();
  s.wind.toward = {-1.0, 2.8};
  s.start_height = 20;
  s.seed = seed;
  PathLeg leg;
  leg.kind = kind;
  leg.speed = kind == PathLeg::Kind::hover ? 0 : 3;
  leg.duration = duration;
  leg.heading = heading;
  s.path = {leg};
  return *ingest::simulate(s);
}
constexpr HeadingRule own_yaw{HeadingRule::Kind::turning, 0, 17};
constexpr HeadingRule nose_ahead{HeadingRule::Kind::along_track, 0, 0};

FreeFlightCalibration calibrate(const std::vector<ingest::Simulation>& flown,
                                const ingest::Vehicle& prior = ingest::class_prior()) {
  std::vector<FreeFlight> flights;
  for (const auto& one : flown) flights.push_back({"flight", one.flight, 1.19});
  FreeFlightSettings settings;
  settings.prior = prior;
  settings.advise = false;
  auto found = calibrate_free_flight(flights, settings);
  EXPECT_TRUE(found);
  return *found;
}

TEST(FreeFlight, ASquareWithOwnYawTellsDragLatencyAndTrim) {
  const auto flown = fly(PathLeg::Kind::square, own_yaw, 200);
  const auto found = calibrate({flown});
  ASSERT_FALSE(found.refused) << *found.refused;
  const double truth = flown.vehicle.drag.linear;
  EXPECT_NEAR(found.vehicle.drag.linear, truth, 0.09 * truth);
  EXPECT_LT(std::abs(std::log(found.vehicle.drag.linear / truth)), 2.5 * found.seen->rel_sd);
  // The simulator's tilt acts for the 10 ms that end where it is logged, and its corners are cut by 10 Hz: -9 ms.
  EXPECT_NEAR(found.vehicle.latency_s, -0.009, 0.02);
  EXPECT_NEAR(found.vehicle.trim_roll_deg, 0.5, 0.25);
  EXPECT_NEAR(found.vehicle.trim_pitch_deg, -0.3, 0.25);
  EXPECT_EQ(found.vehicle.method, "free-flight");
  EXPECT_GE(found.vehicle.between_flights_rel_sd, 0.06);
}

TEST(FreeFlight, TheDragDoesNotHangOnTheNoiseAssumed) {
  const auto found = calibrate({fly(PathLeg::Kind::square, own_yaw, 200)});
  ASSERT_EQ(found.assumed.size(), 4u);
  for (const auto& a : found.assumed) {
    EXPECT_TRUE(a.converged) << a.noise.words();
    // With the spread of the innovations following the drag too, "2 deg over 1 s" would stand 8 % above "white".
    EXPECT_NEAR(std::log(a.drag / found.assumed[0].drag), 0, 0.03) << a.noise.words();
  }
}

TEST(FreeFlight, GustsThatTheControllerLeansAgainstDoNotRaiseTheDrag) {
  // A tilt set against gusts goes with the residuals; taken for own motion it raised the drag by 10 % at this
  // turbulence.
  double sum = 0;
  constexpr int flights = 4;
  for (std::uint64_t seed = 1; seed <= flights; ++seed) {
    ingest::Scenario s;
    s.vehicle = ingest::published_vehicle();
    s.wind.toward = {-1.0, 2.8};
    s.wind.sigma_u = 1;
    s.start_height = 20;
    s.seed = seed;
    PathLeg leg;
    leg.kind = PathLeg::Kind::square;
    leg.speed = 3, leg.duration = 600, leg.heading = own_yaw;
    s.path = {leg};
    const auto flown = ingest::simulate(s);
    ASSERT_TRUE(flown);
    SlowMotion motion(flown->flight, {});
    FitSettings settings;
    settings.prior << std::log(0.2), 0, 0, 0, 0;
    settings.prior_information.diagonal() << 1, 1e5, 10, 0.1, 0.1;
    const auto fit = fit_free_flights({{&motion, 1, true}}, settings, settings.prior);
    EXPECT_TRUE(fit.converged);
    sum += fit.at(f_drag) - std::log(s.vehicle.drag.linear);
  }
  // Single flights scatter by 2 to 3 %.
  EXPECT_NEAR(sum / flights, 0, 0.04);
}

TEST(FreeFlight, RefusesAHoverAndLeavesThePriorExactly) {
  const auto found = calibrate({fly(PathLeg::Kind::hover, own_yaw, 200)});
  ASSERT_TRUE(found.refused);
  EXPECT_FALSE(found.seen);
  EXPECT_EQ(found.vehicle.drag.linear, ingest::class_prior().drag.linear);
  EXPECT_EQ(found.vehicle.covariance, ingest::class_prior().covariance);
  ASSERT_FALSE(found.identifiability.advice.empty());
  EXPECT_EQ(found.identifiability.advice[0].manoeuvre, Manoeuvre::square_turning);
}

TEST(FreeFlight, RefusesACircleWithTheNoseAlongTheTrack) {
  EXPECT_TRUE(calibrate({fly(PathLeg::Kind::circle, nose_ahead, 200)}).refused);
}

TEST(FreeFlight, RefusesTwoMinutesStraightAhead) {
  EXPECT_TRUE(calibrate({fly(PathLeg::Kind::line, {HeadingRule::Kind::fixed, 0, 0}, 120)}).refused);
}

TEST(FreeFlight, AHoverBesideASquareIsLeftOutAndSaid) {
  const auto found = calibrate({fly(PathLeg::Kind::square, own_yaw, 150), fly(PathLeg::Kind::hover, own_yaw, 100, 2)});
  ASSERT_FALSE(found.refused) << *found.refused;
  EXPECT_TRUE(found.runs[0].used);
  EXPECT_FALSE(found.runs[1].used);
  EXPECT_FALSE(found.runs[1].why_not.empty());
}

TEST(FreeFlight, AnExistingVehicleMovesByWhatTheNewFlightIsWorth) {
  auto before = ingest::class_prior();
  before.method = "tunnel";
  before.drag.linear = 0.20;
  before.covariance(ingest::p_linear, ingest::p_linear) = std::pow(0.01, 2);
  const auto found = calibrate({fly(PathLeg::Kind::square, own_yaw, 200)}, before);
  ASSERT_FALSE(found.refused) << *found.refused;
  ASSERT_FALSE(found.moves.empty());
  EXPECT_GT(found.vehicle.drag.linear, 0.205);
  EXPECT_LT(found.vehicle.drag.linear, 0.257);
}

TEST(Excitation, IsTheMotionThatNeitherWindNorTrimCouldCause) {
  std::vector<Step> steps(200);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].sound = true;
    steps[i].heading = 0.1 * static_cast<double>(i);
    // A constant and a part that turns with the nose.
    steps[i].v = Eigen::Vector2d(2, -1) + 3 * Eigen::Vector2d(std::cos(steps[i].heading), std::sin(steps[i].heading));
  }
  EXPECT_NEAR(excitation_index(steps), 0, 1e-6) << "a root of what rounding leaves of 10 m2/s2";
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].v.x() += i % 40 < 20 ? 4 : -4;
  EXPECT_NEAR(excitation_index(steps), 4, 0.3);
}

}  // namespace
}  // namespace quadsonde::estimator
