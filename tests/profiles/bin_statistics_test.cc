#include "profiles/bin_statistics.h"

#include <gtest/gtest.h>

#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::profiles {
namespace {

using estimator::i_b;
using estimator::i_u;
using estimator::i_W;

struct Made {
  std::vector<estimator::Step> steps;
  estimator::PassSettings settings;
  estimator::WindSeries series;
};

Made smoothed_course(int count, bool trim_is_state) {
  Made made{estimator::course(count, 31), estimator::open_settings(), {}};
  made.settings.model.trim_is_state = trim_is_state;
  auto trace = std::make_shared<estimator::SmootherTrace>(run_forward(made.steps, made.settings).trace);
  smooth(*trace);
  trace->consider.diagonal().setConstant(1e-4);
  for (const auto& s : trace->steps) {
    estimator::WindPoint p;
    p.time = estimator::at(0.1 * static_cast<double>(made.series.points.size()));
    p.wind = estimator::WindEstimate{s.x.segment<2>(i_W) + s.x.segment<2>(i_u), Eigen::Matrix2d::Identity(), true};
    made.series.points.push_back(p);
  }
  made.series.trace = trace;
  return made;
}

/// Mean of W + u over the members and its covariance, from the joint Gaussian of the whole flight.
std::pair<Eigen::Vector2d, Eigen::Matrix2d> dense_mean(const Made& made, const std::vector<std::size_t>& members) {
  const estimator::DensePosterior dense(made.steps, made.settings);
  Eigen::Matrix<double, 2, 8> H = Eigen::Matrix<double, 2, 8>::Zero();
  H.middleCols<2>(i_W).setIdentity();
  H.middleCols<2>(i_u).setIdentity();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d C = Eigen::Matrix2d::Zero();
  for (const auto k : members) {
    mean += H * dense.x(k);
    for (const auto j : members) C += H * dense.P(k, j) * H.transpose();
  }
  const double n = static_cast<double>(members.size());
  return {mean / n, C / (n * n)};
}

void expect_dense(bool trim_is_state, const std::vector<std::size_t>& members) {
  const auto made = smoothed_course(60, trim_is_state);
  const auto bin = bin_mean(made.series, members);
  const auto [mean, C] = dense_mean(made, members);
  EXPECT_LT((bin.wind - mean).norm(), 1e-8);
  const Eigen::Matrix2d total = trim_is_state ? Eigen::Matrix2d(bin.noise + bin.trim_part()) : bin.noise;
  EXPECT_LT((total - C).norm(), 1e-8 * std::max(1.0, C.norm()));
}

TEST(BinMean, HasTheCovarianceOfTheDenseJointGaussian) {
  std::vector<std::size_t> run;
  for (std::size_t k = 20; k < 50; ++k) run.push_back(k);
  expect_dense(true, run);
  expect_dense(false, run);
}

TEST(BinMean, HasItForSamplesScatteredOverTheFlightToo) {
  // Up, down and pauses of one height: members far apart.
  expect_dense(true, {5, 6, 7, 20, 21, 40, 58, 59});
  expect_dense(false, {3, 4, 33, 59});
  expect_dense(true, {17});
}

TEST(BinMean, IsNeitherAsSureAsIndependentSamplesNorAsUnsureAsOne) {
  const auto made = smoothed_course(60, false);
  std::vector<std::size_t> members;
  for (std::size_t k = 10; k < 60; ++k) members.push_back(k);
  const auto bin = bin_mean(made.series, members);
  EXPECT_EQ(bin.samples, 50u);
  EXPECT_GT(bin.effective_samples, 1 - 1e-9);
  EXPECT_LT(bin.effective_samples, 25);
}

TEST(BinMean, SplitsTheTrimsShareFromTheNoise) {
  const auto made = smoothed_course(60, true);
  const auto bin = bin_mean(made.series, {30, 31, 32, 33});
  EXPECT_GT(bin.trim_part().trace(), 0);
  EXPECT_GT(bin.noise.determinant(), 0) << "what is left is a covariance";
  const auto frozen = bin_mean(smoothed_course(60, false).series, {30, 31, 32, 33});
  EXPECT_EQ(frozen.per_parameter.middleCols<2>(estimator::c_trim_x).norm(), 0) << "counted as trim, not twice";
  EXPECT_GT(frozen.trim_part().trace(), 0);
}

TEST(BinMean, WithoutATraceTakesItsSamplesErrorsAsOne) {
  auto made = smoothed_course(20, true);
  made.series.trace.reset();
  const auto bin = bin_mean(made.series, {3, 4, 5});
  EXPECT_EQ(bin.noise, Eigen::Matrix2d::Identity());
  EXPECT_EQ(bin.effective_samples, 1);
}

TEST(BinMean, OfNothingIsEmpty) {
  const auto bin = bin_mean(smoothed_course(20, true).series, {});
  EXPECT_EQ(bin.samples, 0u);
  EXPECT_EQ(bin.seconds, 0);
}

TEST(SamplingVariance, IsThatOfAnOrnsteinUhlenbeckMean) {
  EXPECT_NEAR(std::sqrt(sampling_variance(0.5, 10, 10)), 0.43, 0.005) << "design section 7: 10 s at .5 is .43 m/s";
  EXPECT_DOUBLE_EQ(sampling_variance(0.5, 10, 0), 0.25);
  EXPECT_NEAR(sampling_variance(0.5, 10, 1e-3), 0.25, 1e-4);
  EXPECT_NEAR(sampling_variance(0.5, 10, 1e5), 0.25 * 2 * 10 / 1e5, 1e-6);
}

}  // namespace
}  // namespace quadsonde::profiles
