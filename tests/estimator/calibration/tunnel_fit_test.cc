#include "estimator/calibration/tunnel_fit.h"

#include <gtest/gtest.h>

#include <random>

#include "estimator/calibration/tunnel_problem.h"
#include "estimator/calibration/tunnel_samples.h"

namespace quadsonde::estimator {
namespace {

std::vector<TunnelSample> turn(double A, double chi, double theta0, double phi0, double noise, double degrees = 360) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 1);
  std::vector<TunnelSample> samples;
  for (int i = 0; i < 600; ++i) {
    const double psi = 0.3 + degrees * 3.14159265358979 / 180 * i / 600;
    samples.push_back({0.1 * i, psi, -A * std::cos(chi - psi) + theta0 + noise * normal(random),
                       A * std::sin(chi - psi) + phi0 + noise * normal(random)});
  }
  return samples;
}

TEST(SinusoidFit, SeparatesWindAndTrimOverAFullTurn) {
  const auto fit = fit_sinusoids(turn(0.12, 2.2, 0.01, -0.02, 0), false, std::nullopt);
  EXPECT_NEAR(fit.amplitude(), 0.12, 1e-10);
  EXPECT_NEAR(std::atan2(fit.parameters(1), fit.parameters(0)), 2.2, 1e-10);
  EXPECT_NEAR(fit.parameters(2), 0.01, 1e-10);
  EXPECT_NEAR(fit.parameters(3), -0.02, 1e-10);
}

TEST(SinusoidFit, StatesTheErrorThatItsNoiseMakes) {
  const auto fit = fit_sinusoids(turn(0.12, 2.2, 0.01, -0.02, 0.0087), false, std::nullopt);
  // 1200 readings of half weight each for A: sd = noise sqrt(2 / 1200).
  EXPECT_NEAR(fit.along_sd(2.2), 0.0087 * std::sqrt(2.0 / 1200), 0.3 * 0.00036);
  EXPECT_LT(fit.inflation, 1.7);
  EXPECT_NEAR(fit.amplitude(), 0.12, 4 * fit.along_sd(2.2));
  EXPECT_NEAR(fit.rms, 0.0087, 0.0008);
}

TEST(SinusoidFit, IsNotMovedByAnOutlierInTwenty) {
  auto samples = turn(0.12, 2.2, 0.01, -0.02, 0.0087);
  for (std::size_t i = 0; i < samples.size(); i += 20) samples[i].pitch += 0.5;
  EXPECT_NEAR(fit_sinusoids(samples, false, std::nullopt).parameters(2), 0.01, 0.002);
}

TEST(SinusoidFit, FindsThatSamplesRepeatEachOther) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1);
  auto samples = turn(0.1, 1, 0, 0, 0);
  double a = 0, b = 0;
  const double keep = std::exp(-0.1 / 1.0);  // correlation time 1 s: 2 tau / dt = 20
  for (auto& s : samples) {
    a = keep * a + std::sqrt(1 - keep * keep) * normal(random);
    b = keep * b + std::sqrt(1 - keep * keep) * normal(random);
    s.pitch += 0.01 * a, s.roll += 0.01 * b;
  }
  const double inflation = fit_sinusoids(samples, false, std::nullopt).inflation;
  EXPECT_GT(inflation, 8);
  EXPECT_LT(inflation, 40);
}

TEST(TunnelSamples, ReadTheSignsOfALeaningVehicle) {
  // Wind from the north-west while the nose points north-west: pitched down, not rolled. R = Rz(psi) Ry(theta).
  TunnelRun run;
  const double psi = -0.785398, theta = -0.1;
  for (int i = 0; i < 100; ++i) {
    const ingest::LogTime t{i * 100'000'000LL};
    run.flight.attitude.push(t, Eigen::Quaterniond(Eigen::AngleAxisd(psi, Eigen::Vector3d::UnitZ()) *
                                                   Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitY()) *
                                                   Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX())));
    run.flight.velocity.push(t, Eigen::Vector3d::Zero());
  }
  const auto found = steady_samples(run, {});
  ASSERT_EQ(found.samples.size(), 100u);
  EXPECT_NEAR(found.samples[50].pitch, std::tan(theta), 1e-12);
  EXPECT_NEAR(found.samples[50].roll, std::tan(0.05) / std::cos(theta), 1e-12);
  EXPECT_NEAR(found.samples[50].heading, psi, 1e-12);
  EXPECT_EQ(turn_covered_deg(found.samples), 10);
}

TEST(TunnelSamples, AverageAFastAttitudeAndLeaveOutWhatMoves) {
  TunnelRun run;
  for (int i = 0; i < 4000; ++i) {
    const ingest::LogTime t{i * 5'000'000LL};  // 200 Hz; a vibration at half of it
    run.flight.attitude.push(t, Eigen::Quaterniond(Eigen::AngleAxisd(0.1 + (i % 2 ? 0.02 : -0.02), Eigen::Vector3d::UnitY())));
    if (i % 20 == 0) run.flight.velocity.push(t, Eigen::Vector3d(i < 2000 ? 0.0 : 1.0, 0, 0));
  }
  const auto found = steady_samples(run, {});
  EXPECT_NEAR(static_cast<double>(found.seen), 200, 2);
  EXPECT_NEAR(static_cast<double>(found.samples.size()), 90, 12);
  EXPECT_NEAR(found.samples[20].pitch, std::tan(0.1), 2e-4);
  EXPECT_LT(found.samples.back().seconds, 10);
}

TEST(TunnelProblem, DerivativesMeetNumericalOnesAtAnglesAlignedWithNoAxis) {
  ProblemRun run;
  run.chi = 2.345;
  run.noise = 0.0091;
  run.linear_scale = 0.93, run.quadratic_scale = 0.87;
  const TunnelSample sample{0, -1.234, 0.0456, -0.0789};
  for (const double wind : {5.7, -0.3}) {
    Eigen::Matrix<double, 6, 1> p;
    p << 0.257, 0.0123, 0.011, -0.023, 0.21, wind;
    Eigen::Matrix<double, 2, 6> jacobian;
    tilt_residual(run, sample, p, &jacobian);
    for (int i = 0; i < 6; ++i) {
      Eigen::Matrix<double, 6, 1> up = p, down = p;
      const double h = 1e-6;
      up(i) += h, down(i) -= h;
      const Eigen::Vector2d numeric = (tilt_residual(run, sample, up, nullptr) - tilt_residual(run, sample, down, nullptr)) / (2 * h);
      EXPECT_LT((numeric - jacobian.col(i)).norm(), 1e-7 * (1 + numeric.norm())) << "parameter " << i << ", wind " << wind;
    }
  }
}

TEST(TunnelProblem, TheResidualIsZeroOnTheSinusoidsOfTheEquationsOfMotion) {
  // Equation (1) at rest: s g - c a_h + R b = 0, with a_h = -w, turned into heading axes.
  const double chi = 2.2, psi = 0.7, U = 5, linear = 0.257, quadratic = 0.01, theta0 = 0.011, phi0 = -0.02;
  const double c = linear + quadratic * U, g = ingest::standard_gravity;
  const Eigen::Vector2d a_N = U * Eigen::Vector2d(std::cos(chi), std::sin(chi));
  const Eigen::Vector2d a_heading(std::cos(psi) * a_N.x() + std::sin(psi) * a_N.y(), -std::sin(psi) * a_N.x() + std::cos(psi) * a_N.y());
  const Eigen::Vector2d b(g * theta0, -g * phi0);
  const Eigen::Vector2d s = (c * a_heading - b) / g;
  ProblemRun run;
  run.chi = chi;
  Eigen::Matrix<double, 6, 1> p;
  p << linear, quadratic, theta0, phi0, 0, U;
  EXPECT_LT(tilt_residual(run, {0, psi, -s.x(), s.y()}, p, nullptr).norm(), 1e-12);
}

}  // namespace
}  // namespace quadsonde::estimator
