// What an estimate says against itself, without any truth.
#include "estimator/smoother/self_checks.h"

#include <gtest/gtest.h>

#include "estimator/smoother/chi_square.h"
#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::estimator {
namespace {

ingest::Scenario square(double duration) {
  auto s = hover(duration, 17);
  s.path[0].kind = ingest::PathLeg::Kind::square;
  s.path[0].speed = 3;
  return s;
}

const SelfCheck& named(const WindSeries& series, const std::string& name) {
  for (const auto& check : series.diagnostics.self_checks)
    if (check.name == name) return check;
  throw std::runtime_error("no check " + name);
}

bool has_reason(const WindSeries& series, Reason reason) {
  return std::any_of(series.points.begin(), series.points.end(), [&](const auto& p) { return p.reasons.has(reason); });
}

TEST(ChiSquareTail, AgreesWithPublishedQuantiles) {
  // Abramowitz and Stegun, table 26.8: chi-square quantiles of p .05 and .001.
  constexpr double within = 0.003;  // Wilson and Hilferty at 4 degrees and more
  EXPECT_NEAR(chi_square_tail(5.991, 2), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_tail(9.488, 4), 0.05, within);
  EXPECT_NEAR(chi_square_tail(18.307, 10), 0.05, within);
  EXPECT_NEAR(chi_square_tail(29.588, 10), 0.001, 2e-4);
  EXPECT_EQ(chi_square_tail(5, 0), 1);
}

TEST(SelfChecks, PassOnAFlightThatIsAsTheModelSays) {
  auto scenario = square(300);
  int failures = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    scenario.seed = seed;
    const auto series = estimated(*ingest::simulate(scenario));
    for (const auto& check : series.diagnostics.self_checks) failures += check.judged && !check.passed;
    EXPECT_TRUE(named(series, "velocity_crosstalk").judged);
    EXPECT_TRUE(named(series, "heading_crosstalk_m_s").judged);
    EXPECT_TRUE(named(series, "hold_out_chi2_per_dof").judged);
  }
  EXPECT_LE(failures, 1);  // five judged checks of 1 in 1000 to 1 in 300, six flights
}

TEST(SelfChecks, SeeADragThatIsNotTheVehicles) {
  // Design notes, section 9: +.159 for delta x 1.2, sd .025.
  const auto flown = *ingest::simulate(square(300));
  auto vehicle = flown.vehicle;
  vehicle.drag.linear *= 1.3;
  const auto series = *estimate_wind(flown.flight, vehicle);
  const auto& check = named(series, "velocity_crosstalk");
  EXPECT_GT(check.value, 0.1);
  EXPECT_FALSE(check.passed) << check.sentence;
  EXPECT_TRUE(has_reason(series, Reason::crosstalk_velocity));
  for (const auto& point : series.points) EXPECT_NE(point.quality, Quality::good);
}

TEST(SelfChecks, SeeAWindThatTurnsWithTheNose) {
  auto series = estimated(*ingest::simulate(hover(180)));
  const auto steps = series.trace->input;
  EXPECT_TRUE(heading_crosstalk(series, steps, 0.5, 10).passed);
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (auto* wind = std::get_if<WindEstimate>(&series.points[k].wind))
      wind->v_NA_N += 0.6 * Eigen::Vector2d(std::cos(steps[k].heading), std::sin(steps[k].heading));
  const auto seen = heading_crosstalk(series, steps, 0.5, 10);
  EXPECT_NEAR(seen.value, 0.6, 0.15);
  EXPECT_FALSE(seen.passed) << seen.sentence;
}

TEST(SelfChecks, DoNotJudgeWhatAClimbCannotShow) {
  auto scenario = hover(10);
  scenario.path[0].kind = ingest::PathLeg::Kind::climb;
  scenario.path[0].to_height = 200;
  scenario.path[0].speed = 1;
  const auto series = estimated(*ingest::simulate(scenario));
  EXPECT_FALSE(named(series, "velocity_crosstalk").judged);
  EXPECT_FALSE(named(series, "split_halves_m_s").judged);
}

TEST(HoldOut, FailsWhereTheMotionIsNotAsForetold) {
  const auto flown = *ingest::simulate(square(400));
  const auto series = estimated(flown);
  auto steps = series.trace->input;
  EXPECT_TRUE(hold_out(steps, series.trace->settings, series.trace->consider).passed);
  // Velocities twice as large as the tilt makes them: what is kept back cannot be foretold.
  for (auto& step : steps) step.v *= 2;
  const auto check = hold_out(steps, series.trace->settings, series.trace->consider);
  EXPECT_FALSE(check.passed) << check.sentence;
}

TEST(Reasons, DecideTheQualityInOnePlace) {
  Reasons reasons;
  EXPECT_EQ(reasons.at_best(), Quality::good);
  reasons.add(Reason::uncalibrated);
  EXPECT_EQ(reasons.at_best(), Quality::good);
  reasons.add(Reason::fast_descent);
  EXPECT_EQ(reasons.at_best(), Quality::doubtful);
  reasons.add(Reason::inconsistent_telemetry);
  EXPECT_EQ(reasons.at_best(), Quality::bad);
}

}  // namespace
}  // namespace quadsonde::estimator
