#include "estimator/calibration/tunnel.h"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>

#include "tests/estimator/calibration/made_runs.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using estimator::calibrate_tunnel;
using estimator::drag_at;
using estimator::DragTerms;
using ingest::Kind;
using support::fly;
using support::fly_each;
using support::MadeRun;
using support::published_settings;
using ::testing::HasSubstr;

const std::vector<double> five_speeds{0, 2, 4, 6, 8};

/// The good case, flown and calibrated once.
const ingest::Result<estimator::TunnelCalibration>& five_runs() {
  static const auto found = calibrate_tunnel(fly_each(five_speeds), published_settings());
  return found;
}

TEST(TunnelCalibration, FindsTheDragTheTrimsAndTheDirectionOfTheFlow) {
  // Winds exactly as stated: what is left is .5 deg of tilt noise over 600 samples, .35 % of the amplitude at 5 m/s.
  const auto& found = five_runs();
  ASSERT_TRUE(found) << to_string(found.error());
  for (const double speed : {2.0, 5.0, 8.0})
    EXPECT_NEAR(drag_at(found->vehicle, speed).value, 0.257 + 0.004 * speed, 0.01 * 0.28) << speed;
  EXPECT_NEAR(found->vehicle.trim_roll_deg, 0.5, 0.03);
  EXPECT_NEAR(found->vehicle.trim_pitch_deg, -0.3, 0.03);
  EXPECT_NEAR(found->flow_offset_deg, 0, 0.5);
  for (const auto& run : found->runs) EXPECT_EQ(run.turn_deg, 360);
  EXPECT_NEAR(found->runs[4].fitted_from_deg, 200, 0.5);
  EXPECT_EQ(found->vehicle.method, "tunnel");
  EXPECT_TRUE(found->notes.empty()) << to_string(found->notes.front());
}

TEST(TunnelCalibration, TellsHowFarItMayErrFromWhatTheStatedWindsAreGoodFor) {
  // Four speeds at 3 %: c at the middle is their mean, 1.5 %; delta alone is far less certain.
  const auto found = calibrate_tunnel(fly_each({2, 4, 6, 8}), published_settings());
  ASSERT_TRUE(found);
  const auto middle = drag_at(found->vehicle, 5);
  EXPECT_NEAR(middle.sd / middle.value, 0.015, 0.004);
  EXPECT_GT(drag_at(found->vehicle, 0).sd / middle.value, 0.03);
}

TEST(TunnelCalibration, WritesAVehicleThatReadsBackWithItsWholeCovariance) {
  const auto& found = five_runs();
  ASSERT_TRUE(found);
  const auto& v = found->vehicle;
  const auto back = ingest::parse_vehicle(to_toml(v), "vehicle.toml");
  ASSERT_TRUE(back) << to_string(back.error());
  EXPECT_EQ(back->drag.linear, v.drag.linear);
  EXPECT_EQ(back->covariance, v.covariance);
  const Eigen::SelfAdjointEigenSolver<ingest::DragCovariance> eigen(v.covariance);
  EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-12);
  const auto prior = ingest::class_prior();
  EXPECT_EQ(v.latency_s, prior.latency_s);
  EXPECT_EQ(v.drag.climb_linear, prior.drag.climb_linear);
  for (const auto p : {ingest::p_latency, ingest::p_climb_linear, ingest::p_climb_quadratic})
    EXPECT_EQ(v.parameter_sd(p), prior.parameter_sd(p));
  EXPECT_EQ(v.between_flights_rel_sd, 0.06);
  EXPECT_EQ(v.mass_kg, 0.896);
  EXPECT_NEAR(v.air_density_kg_m3, 1.19, 1e-12);
  EXPECT_NEAR(v.airspeed_range_m_s.y(), 8, 0.5);
  EXPECT_NEAR(*v.residual_rms_m_s2, 0.5 * 3.14159265 / 180 * 9.80665, 0.01);
}

TEST(TunnelCalibration, ListsWhereEveryStartEnded) {
  const auto& found = five_runs();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->ends.size(), 8u);
  EXPECT_LT(found->ends.front().start_linear, 0.07);
  EXPECT_GT(found->ends.back().start_linear, 1.5);
  EXPECT_EQ(found->ends_at_best, 8);
  for (const auto& end : found->ends) EXPECT_TRUE(end.converged);
  EXPECT_EQ(found->rank, 10);
  EXPECT_EQ(found->parameters, 10);
  EXPECT_THAT(found->weakest, HasSubstr("quadratic drag"));
}

TEST(TunnelCalibration, TakesTheQuadraticTermWhereALeftOutSpeedIsPredictedBetterWithIt) {
  MadeRun strong;
  strong.drag = {0.20, 0.02, 0, 0};
  const auto both = calibrate_tunnel(fly_each({2, 4, 6, 8, 10}, strong), published_settings());
  ASSERT_TRUE(both);
  EXPECT_TRUE(both->quadratic);
  EXPECT_LT(*both->quadratic_left_out_rms, 0.5 * *both->linear_left_out_rms);
  EXPECT_NEAR(drag_at(both->vehicle, 10).value, 0.40, 0.01);
}

TEST(TunnelCalibration, KeepsTheQuadraticTermOpenWhereItDoesNotTakeIt) {
  MadeRun linear;
  linear.drag = {0.257, 0, 0, 0};
  auto settings = published_settings();
  settings.terms = DragTerms::linear;
  const auto found = calibrate_tunnel(fly_each({0, 2, 4}, linear), settings);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->vehicle.drag.quadratic, 0);
  // Two speeds say little of the curvature: the class does. Beyond the speeds flown the drag is less certain.
  EXPECT_NEAR(found->vehicle.parameter_sd(ingest::p_quadratic), 0.004, 1e-6);
  EXPECT_GT(drag_at(found->vehicle, 10).sd, 1.5 * drag_at(found->vehicle, 3).sd);
}

TEST(TunnelCalibration, OneWindBesideACalmRunGivesALinearDragAndSaysWhatIsUnchecked) {
  const auto found = calibrate_tunnel(fly_each({0, 5}), published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_FALSE(found->quadratic);
  EXPECT_EQ(found->rank, found->parameters - 1);
  EXPECT_NEAR(drag_at(found->vehicle, 5).value, 0.277, 0.006);
  EXPECT_NEAR(drag_at(found->vehicle, 5).sd / 0.277, 0.03, 0.004);
  EXPECT_FALSE(found->vehicle.leave_one_out_m_s);
  ASSERT_FALSE(found->notes.empty());
  EXPECT_THAT(found->notes.front().what, HasSubstr("only one run has wind"));
}

TEST(TunnelCalibration, RefersRunsInThinnerAirToOneDensity) {
  const double thin = 1.19 * 0.7;
  std::vector<estimator::TunnelRun> runs;
  for (const double speed : {2.0, 4.0, 6.0, 8.0})
    for (const double density : {1.19, thin}) {
      MadeRun made;
      made.stated = speed;
      made.seed = static_cast<std::uint64_t>(speed * 100 * density);
      made.density = density;
      made.drag = ingest::scaled(ingest::DragLaw<double>{0.257, 0.004, 0, 0}, density / 1.19, 1.0, 0.5);
      runs.push_back(fly(made));
    }
  const auto found = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_NEAR(found->vehicle.air_density_kg_m3, 0.85 * 1.19, 1e-9);
  EXPECT_EQ(found->spread, 1) << "a sixth less drag in thin air is no scatter";
  const auto there = ingest::flown_at(found->vehicle, std::nullopt, 1.19);
  ASSERT_TRUE(there);
  EXPECT_NEAR(drag_at(*there, 5).value, 0.277, 0.004);
}

TEST(TunnelCalibration, StandsAFewWildAttitudesAndWidensForGusts) {
  auto runs = fly_each(five_speeds);
  for (auto& run : runs)
    for (std::size_t i = 0; i < run.flight.attitude.size(); i += 25)
      run.flight.attitude.value[i] = run.flight.attitude.value[i] * Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
  const auto wild = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(wild) << to_string(wild.error());
  EXPECT_NEAR(drag_at(wild->vehicle, 5).value, 0.277, 0.006);
  EXPECT_NEAR(wild->vehicle.trim_roll_deg, 0.5, 0.1);

  MadeRun gusty;
  gusty.gusts = 0.15;
  const auto& calm = five_runs();
  const auto gusts = calibrate_tunnel(fly_each(five_speeds, gusty), published_settings());
  ASSERT_TRUE(gusts) << to_string(gusts.error());
  EXPECT_GT(gusts->runs[2].inflation, 2 * calm->runs[2].inflation);
  EXPECT_GT(gusts->runs[2].amplitude_sd, 1.5 * calm->runs[2].amplitude_sd);
}

TEST(TunnelCalibration, GivesTheSameDigitsTwice) {
  const auto runs = fly_each({0, 3, 6});
  const auto a = calibrate_tunnel(runs, published_settings()), b = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(a && b);
  EXPECT_EQ(to_toml(a->vehicle), to_toml(b->vehicle));
}

TEST(TunnelCalibration, UsesOnlyTheStatedPartOfALog) {
  // A log with a flight away in its second half.
  MadeRun away;
  away.stated = 4;
  away.speed = 3;
  auto runs = fly_each({0, 4, 8});
  const auto later = fly(away);
  auto& run = runs[1];
  const auto shift = ingest::seconds(60.1);
  for (std::size_t i = 0; i < later.flight.velocity.size(); ++i)
    run.flight.velocity.push(later.flight.velocity.time[i] + shift, later.flight.velocity.value[i]);
  for (std::size_t i = 0; i < later.flight.attitude.size(); ++i)
    run.flight.attitude.push(later.flight.attitude.time[i] + shift, later.flight.attitude.value[i]);
  run.end = ingest::LogTime{60'000'000'000};
  const auto found = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_NEAR(*found->runs[1].drag, 0.273, 0.006);
  EXPECT_LE(found->runs[1].seen, 601u);
}

}  // namespace
}  // namespace quadsonde
