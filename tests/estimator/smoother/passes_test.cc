#include "estimator/smoother/passes.h"

#include <gtest/gtest.h>

#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::estimator {
namespace {

SmootherTrace smoothed(const std::vector<Step>& steps, const PassSettings& p) {
  auto trace = run_forward(steps, p).trace;
  smooth(trace);
  return trace;
}

void expect_dense(const std::vector<Step>& steps, const PassSettings& p) {
  const auto trace = smoothed(steps, p);
  const DensePosterior dense(steps, p);
  ASSERT_EQ(trace.steps.size(), steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k) {
    EXPECT_LT((trace.steps[k].x - dense.x(k)).norm(), 1e-8) << k;
    // The start's 400 (m/s)^2 sets the rounding of the dense solution.
    EXPECT_LT((trace.steps[k].P - dense.P(k, k)).norm(), 1e-8 * std::max(1.0, dense.P(k, k).norm())) << k;
  }
}

TEST(Smoother, EqualsTheDenseGaussianSolution) {
  expect_dense(course(30, 1), open_settings());
  expect_dense(course(60, 2), open_settings());
}

TEST(Smoother, EqualsTheDenseSolutionWithAFrozenTrim) {
  auto p = open_settings();
  p.model.trim_is_state = false;
  expect_dense(course(30, 3), p);
}

TEST(Smoother, EqualsTheDenseSolutionAcrossAGapThatOnlyTheTrimCrosses) {
  auto steps = course(40, 4);
  steps[20].gap_before = true;
  steps[20].sound = false;
  for (std::size_t k = 20; k < 40; ++k) steps[k].seconds += 30, steps[k].time = steps[k].time + ingest::seconds(30);
  expect_dense(steps, open_settings());
}

TEST(Smoother, DoesNotSmoothTheWindAcrossDataThatIsNotThere) {
  auto p = open_settings();
  p.model.trim_is_state = false;  // so nothing at all is shared by the two sides
  auto steps = course(60, 5);
  steps[30].gap_before = true;
  steps[30].sound = false;
  auto changed = steps;
  for (std::size_t k = 30; k < 60; ++k) changed[k].v += Eigen::Vector2d(3, -2);
  const auto a = smoothed(steps, p), b = smoothed(changed, p);
  ASSERT_EQ(a.breaks, (std::vector<std::size_t>{30}));
  for (std::size_t k = 0; k < 30; ++k) EXPECT_LT((a.steps[k].x - b.steps[k].x).norm(), 1e-12) << k;
  EXPECT_GT((a.steps[45].x - b.steps[45].x).norm(), 0.1) << "behind the gap it does matter";
}

TEST(Smoother, SensitivitiesToAFrozenTrimAreItsExactDerivatives) {
  auto p = open_settings();
  p.model.trim_is_state = false;
  const auto steps = course(50, 6);
  const auto here = smoothed(steps, p);
  auto moved = p;
  moved.trim += Eigen::Vector2d(0.01, 0);
  const auto there = smoothed(steps, moved);
  for (std::size_t k = 0; k < 50; ++k) {
    const Eigen::Vector4d by_trim = (there.steps[k].x - here.steps[k].x).segment<4>(i_W) / 0.01;
    EXPECT_LT((by_trim - here.steps[k].S.col(c_trim_x).segment<4>(i_W)).norm(), 1e-7 * (1 + by_trim.norm())) << k;
  }
}

TEST(Forward, CausalWindEqualsTheSmoothersForwardPass) {
  // One class, two callers: an independent loop over the filter, the causal pass, and the smoother's last step.
  const auto steps = course(200, 7);
  auto p = open_settings();
  p.causal = true;
  const auto pass = run_forward(steps, p);
  WindFilter<double> filter(p.model, p.limits);
  filter.start(steps[0].v, p.trim, p.trim_covariance);
  for (std::size_t k = 1; k < steps.size(); ++k) {
    filter.step(steps[k].input, steps[k].v, steps[k].variance);
    ASSERT_LT((pass.causal[k].wind.wind - filter.wind()).norm(), 1e-9) << k;
  }
  auto trace = pass.trace;
  smooth(trace);
  EXPECT_EQ(trace.steps.back().x, filter.state());
  EXPECT_EQ(trace.steps.back().P, filter.covariance());
}

TEST(Forward, RestartsAfterAGapAndAfterStepsThatAreNotSound) {
  auto steps = course(100, 8);
  steps[40].gap_before = true;
  steps[40].sound = false;
  for (std::size_t k = 70; k < 75; ++k) steps[k].sound = false;
  const auto pass = run_forward(steps, open_settings());
  EXPECT_EQ(pass.restarts, 2);
  EXPECT_TRUE(pass.active[40]);
  for (std::size_t k = 70; k < 75; ++k) EXPECT_FALSE(pass.active[k]) << k;
  EXPECT_EQ(pass.trace.of_point[72], -1);
  EXPECT_EQ(pass.trace.breaks, (std::vector<std::size_t>{40, 70})) << "indices of active steps";
}

TEST(Forward, RestartsAfterTwoSecondsOfRejectedSamples) {
  auto steps = make_steps(ingest::simulate(hover(20))->flight, {}).steps;
  for (std::size_t k = 100; k < 200; ++k) steps[k].v += Eigen::Vector2d(20, 0);
  auto p = open_settings();
  p.limits.gate_nis = 18.4;
  const auto pass = run_forward(steps, p);
  EXPECT_EQ(pass.restarts, 1);
  EXPECT_GE(pass.rejected, 19);
  EXPECT_LE(pass.rejected, 22);
  EXPECT_EQ(pass.outcome[199], Outcome::updated);
}

TEST(Forward, ThawsTheTrimOnlyOnceTheHeadingHasTurned) {
  auto steps = course(300, 10);
  for (std::size_t k = 0; k < 300; ++k)
    steps[k].heading = steps[k].input.heading = k < 150 ? 0.3 : 0.3 + 0.02 * (static_cast<double>(k) - 150);
  auto p = open_settings();
  p.causal = true;
  p.model.trim_is_state = false;
  const auto pass = run_forward(steps, p);
  EXPECT_FALSE(pass.causal[149].trim_is_state);
  EXPECT_TRUE(pass.causal[299].trim_is_state);
}

TEST(HeadingIndex, IsZeroForAFixedNoseAndOneForAWholeTurn) {
  auto steps = course(360, 11);
  for (std::size_t k = 0; k < 360; ++k) steps[k].heading = 1.1;
  EXPECT_NEAR(heading_index(steps, 360), 0, 1e-6);
  for (std::size_t k = 0; k < 360; ++k) steps[k].heading = static_cast<double>(k) * std::numbers::pi / 180;
  EXPECT_NEAR(heading_index(steps, 360), 1, 1e-6);
  // Half a turn: |mean exp(i psi)| = 2/pi.
  EXPECT_NEAR(heading_index(steps, 179), std::sqrt(1 - 4 / (std::numbers::pi * std::numbers::pi)), 1e-4);
  for (std::size_t k = 180; k < 360; ++k) steps[k].sound = false;
  EXPECT_NEAR(heading_index(steps, 360), heading_index(steps, 179), 1e-12) << "steps that are not sound do not count";
  EXPECT_EQ(heading_index({}, 0), 0);
}

TEST(WindPosterior, LeavesTheTrimsShareOutAsIfItWereKnown) {
  const auto steps = course(80, 12);
  const auto with = run_forward(steps, open_settings());
  const auto known = [&] {
    auto p = open_settings();
    p.trim_covariance = 1e-14 * Eigen::Matrix2d::Identity();
    p.model.trim_psd = 0;
    return run_forward(steps, p);
  }();
  const auto a = wind_posterior(with.x, with.P, Sensitivity<double>::Zero(), true);
  const auto b = wind_posterior(known.x, known.P, Sensitivity<double>::Zero(), true);
  EXPECT_LT((a.without_trim - b.covariance).norm(), 1e-4 * b.covariance.norm());
  EXPECT_GT(a.covariance.trace(), 1.1 * a.without_trim.trace());
}

}  // namespace
}  // namespace quadsonde::estimator
