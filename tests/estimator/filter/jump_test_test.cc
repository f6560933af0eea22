#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "estimator/filter/wind_filter.h"
#include "ingest/motion/random.h"

namespace quadsonde::estimator {
namespace {

int alarms(double threshold, int samples, std::uint64_t seed) {
  ingest::Gaussian noise(seed);
  JumpTest<double> test(threshold);
  int found = 0;
  for (int k = 0; k < samples; ++k) {
    const double n = noise(), e = noise();
    found += test.add({n, e}, 0.1 * k);
  }
  return found;
}

TEST(JumpTest, AlarmsOnWhiteNoiseNoOftenerThanChiSquareAllows) {
  // J is chi-square(2): P(J > 25) = exp(-12.5) = 3.7e-6 at each of 2 000 000 samples (56 h at 10 Hz), 7.5 expected if
  // they were independent; neighbours share four samples of five, so clusters count once: fewer. 99.9 % bound 17.
  EXPECT_LE(alarms(25, 2'000'000, 5), 17);
  // At 12: exp(-6) = 2.5e-3 a sample. Clusters and the refractory time take most of it; never none.
  const int many = alarms(12, 200'000, 6);
  EXPECT_GT(many, 100);
  EXPECT_LT(many, 496 + 3 * 22);
}

TEST(JumpTest, FindsAStepWithinFiveSamples) {
  for (const auto& direction : {Eigen::Vector2d(3, 0), Eigen::Vector2d(-2.2, 2.2)}) {
    JumpTest<double> test(25);
    for (int k = 0; k < 20; ++k) ASSERT_FALSE(test.add({0.3, -0.2}, 0.1 * k));
    int needed = 0;
    for (int k = 20; k < 30 && !needed; ++k)
      if (test.add(direction, 0.1 * k)) needed = k - 19;
    EXPECT_GE(needed, 3);
    EXPECT_LE(needed, 5);
  }
}

TEST(JumpTest, IsNotFiredByOneWildSample) {
  JumpTest<double> test(25);
  for (int k = 0; k < 40; ++k)
    EXPECT_FALSE(test.add(k == 20 ? Eigen::Vector2d(4.29, 0) : Eigen::Vector2d(0, 0), 0.1 * k));
}

TEST(JumpTest, RestsForTwoSecondsAfterAnAlarm) {
  JumpTest<double> test(25);
  std::vector<double> at;
  for (int k = 0; k < 60; ++k)
    if (test.add({4, 0}, 0.1 * k)) at.push_back(0.1 * k);
  ASSERT_GE(at.size(), 2u);
  EXPECT_NEAR(at[0], 0.4, 1e-9) << "five samples are needed";
  EXPECT_NEAR(at[1] - at[0], 2, 0.11);
}

TEST(JumpTest, ForgetsWhatItSawWhenCleared) {
  JumpTest<double> test(25);
  for (int k = 0; k < 4; ++k) test.add({4, 0}, 0.1 * k);
  test.clear();
  EXPECT_FALSE(test.add({4, 0}, 0.5));
}

}  // namespace
}  // namespace quadsonde::estimator
