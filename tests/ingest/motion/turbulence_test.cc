#include "ingest/motion/turbulence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace quadsonde::ingest {
namespace {

constexpr double foot = 0.3048;

TEST(Dryden, ScalesAreThoseOfTheSpecification) {
  // At 1000 ft the low-altitude form meets isotropy: 0.177 + 0.823 = 1, L = 1000 ft, one sigma.
  const auto high = dryden_scales(1000 * foot, 10);
  EXPECT_NEAR(high.length_u, 304.8, 1e-9);
  EXPECT_NEAR(high.length_w, 304.8, 1e-9);
  EXPECT_NEAR(high.sigma_u, 1, 1e-12);
  EXPECT_NEAR(high.sigma_w, 1, 1e-12);
  // At 100 ft: 0.177 + 0.0823 = 0.2593; 100 / 0.2593^1.2 = 505.2 ft; 1 / 0.2593^0.4 = 1.716.
  const auto low = dryden_scales(100 * foot, 10);
  EXPECT_NEAR(low.length_w, 30.48, 1e-9);
  EXPECT_NEAR(low.length_u / foot, 505.2, 0.1);
  EXPECT_NEAR(low.sigma_u, 1.716, 0.001);
  EXPECT_EQ(dryden_scales(0, 10).length_w, 10 * foot) << "held below 10 ft";
}

/// Mean of x(t) x(t + lag) over many steps.
template <class Filter>
double correlation(Filter filter, double step_over_T, int lag, int count) {
  std::vector<double> x;
  for (int i = 0; i < count + lag; ++i) x.push_back(filter.next(step_over_T));
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += x[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(i + lag)];
  return sum / count;
}

TEST(Dryden, AutocorrelationIsThatOfItsSpectrumAtAnyStep) {
  // 4e5 steps of T/10 are some 2e4 independent values: sd of a correlation about 1 %; 4 sd.
  for (const double a : {0.1, 0.5, 2.0}) {
    for (const int lag : {0, 1, 5, 15}) {
      Gaussian noise(17);
      const double t = a * lag, tolerance = 0.04;
      EXPECT_NEAR(correlation(DrydenLongitudinal(noise), a, lag, 400000), std::exp(-t), tolerance) << a << " " << lag;
      EXPECT_NEAR(correlation(DrydenTransversal(noise), a, lag, 400000), std::exp(-t) * (1 - t / 2), tolerance)
          << a << " " << lag;
    }
  }
}

/// One-sided spectral density over angular frequency times T of a unit process, from windows of a power of e-folds.
template <class Filter>
double density(Filter filter, double a, int window, int bin, int windows) {
  double sum = 0;
  for (int k = 0; k < windows; ++k) {
    std::complex<double> f = 0;
    double weight = 0;
    for (int i = 0; i < window; ++i) {
      const double phase = 2 * std::numbers::pi * i / window, hann = 0.5 - 0.5 * std::cos(phase);
      f += hann * filter.next(a) * std::polar(1.0, -phase * bin);
      weight += hann * hann;
    }
    sum += std::norm(f) * a / (std::numbers::pi * weight);
  }
  return sum / windows;
}

TEST(Dryden, SpectraAreThoseOfTheSpecification) {
  // Phi_u = sigma^2 (2 T / pi) / (1 + (T w)^2), Phi_v = sigma^2 (T / pi) (1 + 3 (T w)^2) / (1 + (T w)^2)^2.
  // 400 windows: a periodogram's mean has sd 5 %; 3 sd and the window's leakage.
  constexpr double a = 0.05;
  constexpr int window = 2048;
  for (const int bin : {8, 16, 40, 100}) {
    const double w = 2 * std::numbers::pi * bin / (window * a), w2 = w * w;
    Gaussian noise(5);
    const double u = 2 / std::numbers::pi / (1 + w2);
    const double v = 1 / std::numbers::pi * (1 + 3 * w2) / std::pow(1 + w2, 2);
    EXPECT_NEAR(density(DrydenLongitudinal(noise), a, window, bin, 400) / u, 1, 0.2) << w;
    EXPECT_NEAR(density(DrydenTransversal(noise), a, window, bin, 400) / v, 1, 0.2) << w;
  }
}

TEST(Dryden, GustsHaveTheIntensitiesOfTheirHeightAlongAndAcrossTheWind) {
  WindField field;
  field.turbulence = WindField::Turbulence::dryden;
  field.wind_at_6m = 8;
  field.toward = {0, 8};  // toward the east: its longitudinal axis
  Gaussian noise(3);
  const auto gusts = make_gusts(field, 1, noise);
  const auto scales = dryden_scales(20, 8);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double slow_n = 0, slow_e = 0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d g = gusts->next(20, field.toward, 8);
    sum += g.cwiseAbs2();
    slow_n += g.x() * last.x(), slow_e += g.y() * last.y();
    last = g;
  }
  // Some 1e4 independent values per axis: 1 % per sd, 3 sd.
  EXPECT_NEAR(std::sqrt(sum.x() / n), scales.sigma_u, 0.03 * scales.sigma_u);
  EXPECT_NEAR(std::sqrt(sum.y() / n), scales.sigma_u, 0.03 * scales.sigma_u);
  EXPECT_NEAR(std::sqrt(sum.z() / n), scales.sigma_w, 0.03 * scales.sigma_w);
  EXPECT_GT(slow_e, slow_n) << "the gust along the wind keeps longer: exp(-t) against exp(-t) (1 - t/2)";
}

TEST(Gusts, GrowWithHeightAsTold) {
  WindField field;
  field.sigma_exponent = 0.5;
  field.time_u = field.time_w = 0.1;
  for (const double height : {10.0, 40.0, 160.0}) {
    Gaussian noise(9);
    const auto gusts = make_gusts(field, 1, noise);
    double sum = 0;
    for (int i = 0; i < 20000; ++i) sum += gusts->next(height, {3, 0}, 3).head<2>().squaredNorm() / 2;
    const double told = 0.5 * std::sqrt(height / 10);
    EXPECT_NEAR(std::sqrt(sum / 20000), told, 0.02 * told) << height;
  }
}

}  // namespace
}  // namespace quadsonde::ingest
