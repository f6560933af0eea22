// Drag learned in flight: from a square with its own yaw, and not from anything less.
#include <gtest/gtest.h>

#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::estimator {
namespace {

ingest::Scenario square(std::uint64_t seed, double latency = 0, bool along_track = false) {
  auto s = hover(300, 17);
  s.seed = seed;
  s.wind.toward = {-1.03, 2.82};
  s.start_height = 20;
  s.sensors.latency = latency;
  auto& leg = s.path.front();
  leg.kind = ingest::PathLeg::Kind::square;
  leg.speed = 3;
  if (along_track) leg.heading = {ingest::HeadingRule::Kind::along_track, 0, 0};
  return s;
}

/// The flight told with a drag that is wrong, and known to be.
WindSeries told_wrong(const ingest::Scenario& scenario, double wrong, Mode mode, bool latency_known = true,
                      bool online = true) {
  const auto flown = ingest::simulate(scenario);
  auto vehicle = flown->vehicle;
  vehicle.drag.linear *= wrong;
  vehicle.between_flights_rel_sd = 0.3;
  vehicle.latency_s = latency_known ? scenario.sensors.latency : 0.05;
  vehicle.covariance(ingest::p_latency, ingest::p_latency) = latency_known ? 0 : 0.08 * 0.08;
  EstimateSettings settings;
  settings.mode = mode;
  settings.online_drag = online;
  auto series = estimate_wind(flown->flight, vehicle, settings);
  if (!series) throw std::runtime_error(to_string(series.error()));
  return *series;
}

TEST(OnlineDrag, EndsWithinItsUncertaintyFromAStartThirtyPercentWrong) {
  for (const Mode mode : {Mode::smoothed, Mode::causal})
    for (const double wrong : {0.7, 1.3}) {
      const auto series = told_wrong(square(3), wrong, mode);
      const auto& drag = series.diagnostics.online_drag;
      ASSERT_TRUE(drag);
      EXPECT_NEAR(drag->factor * wrong, 1, 2.5 * drag->sd) << name(mode) << " " << wrong;
      EXPECT_LT(drag->sd, 0.05);
      EXPECT_GT(drag->seconds, 240);
      ASSERT_TRUE(series.points.back().drag);
      EXPECT_NEAR(series.points.back().drag->factor, drag->factor, 1e-5);
      EXPECT_TRUE(series.points.back().drag->updated);
      EXPECT_FALSE(series.points.front().drag->updated) << "half a minute of motion has to be seen first";
    }
}

TEST(OnlineDrag, MakesTheCausalWindRightThatAWrongDragSpoils) {
  const auto scenario = square(4);
  const auto truth = ingest::simulate(scenario)->truth;
  EXPECT_LT(rmse(told_wrong(scenario, 0.7, Mode::causal), truth, 120), 0.32);
  EXPECT_GT(rmse(told_wrong(scenario, 0.7, Mode::causal, true, false), truth, 120), 0.6);
}

TEST(OnlineDrag, FindsALatencyThatIsNotKnownBesideTheDrag) {
  for (const Mode mode : {Mode::smoothed, Mode::causal}) {
    const auto series = told_wrong(square(5, 0.2), 0.7, mode, false);
    const auto& drag = *series.diagnostics.online_drag;
    EXPECT_NEAR(drag.latency, 0.2, 0.012) << name(mode);
    EXPECT_NEAR(drag.factor * 0.7, 1, 2.5 * drag.sd) << name(mode);
  }
}

void expect_untouched(const ingest::Scenario& scenario, double wrong) {
  for (const Mode mode : {Mode::smoothed, Mode::causal}) {
    const auto with = told_wrong(scenario, wrong, mode), without = told_wrong(scenario, wrong, mode, true, false);
    const auto& drag = *with.diagnostics.online_drag;
    EXPECT_EQ(drag.factor, 1.0);
    EXPECT_NEAR(drag.sd, 0.3, 1e-12);
    EXPECT_EQ(drag.seconds, 0);
    EXPECT_FALSE(drag.first);
    ASSERT_EQ(with.points.size(), without.points.size());
    for (std::size_t k = 0; k < with.points.size(); ++k) {
      ASSERT_TRUE(with.points[k].drag && with.points[k].drag->factor == 1 && !with.points[k].drag->updated);
      const auto* a = std::get_if<WindEstimate>(&with.points[k].wind);
      const auto* b = std::get_if<WindEstimate>(&without.points[k].wind);
      ASSERT_EQ(a == nullptr, b == nullptr);
      if (!a) continue;
      ASSERT_EQ(a->v_NA_N, b->v_NA_N) << k;
      ASSERT_EQ(a->covariance, b->covariance) << k;
    }
  }
}

TEST(OnlineDrag, StaysAtItsPriorBitForBitInTenMinutesOfHover) { expect_untouched(hover(600), 1.2); }

TEST(OnlineDrag, StaysAtItsPriorInAHoverFlownOnWhatIsMeasured) {
  auto scenario = hover(600);
  scenario.sensors.controller_flies_on_measured = true;
  expect_untouched(scenario, 0.7);
}

TEST(OnlineDrag, StaysAtItsPriorWhileTheNoseGoesWithTheTrack) { expect_untouched(square(6, 0, true), 0.8); }

TEST(OnlineDrag, IsNothingThatAnyoneGetsUnasked) {
  const auto series = told_wrong(square(7), 1, Mode::smoothed, true, false);
  EXPECT_FALSE(series.diagnostics.online_drag);
  EXPECT_FALSE(series.points.back().drag);
}

}  // namespace
}  // namespace quadsonde::estimator
