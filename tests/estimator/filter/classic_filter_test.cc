#include "estimator/filter/classic_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ingest/motion/random.h"

namespace quadsonde::estimator {
namespace {

/// The published filter as written: design notes, section 3, in matrices.
struct Reference {
  Eigen::Matrix2d A, Q, P = Eigen::Matrix2d::Identity();
  Eigen::Vector2d B, x = Eigen::Vector2d::Zero();
  Eigen::RowVector2d C{1, 1};
  double m, R = 0.5;
  Reference(double mass, double D, bool exact) : m(mass) {
    const double dt = 0.1, delta = D / m;
    A << (exact ? std::exp(-delta * dt) : 1 - D * dt / m), 0, 0, 1;
    B << (exact ? (1 - std::exp(-delta * dt)) / D : dt / m), 0;
    Q << 0.05, 0, 0, 0.001;
  }
  void step(double n_i, double n_d, double v_i) {
    const double T = m * 9.80665 / std::max(n_d, 0.5), U = -T * n_i;
    x = A * x + B * U;
    P = A * P * A.transpose() + Q;
    const Eigen::Vector2d K = P * C.transpose() / (C * P * C.transpose() + R);
    x += K * (v_i - C * x);
    P -= K * C * P;
  }
};

void expect_reference(bool exact) {
  ClassicConstants constants;
  constants.exact = exact;
  ClassicFilter filter(constants);
  Reference north(constants.mass, constants.drag, exact), east = north;
  ingest::Gaussian noise(21);
  for (int k = 0; k < 3000; ++k) {
    // Now and then far over 60 degrees, where the thrust is held.
    const double lean = k % 100 == 0 ? 1.3 : 0.1 * std::sin(0.01 * k);
    const Eigen::Vector3d n =
        Eigen::Vector3d(lean + 0.01 * noise(), -0.06 + 0.01 * noise(), k % 100 == 0 ? 0.3 : 1).normalized();
    const Eigen::Vector2d v(std::sin(0.02 * k) + 0.1 * noise(), 0.1 * noise());
    filter.step(n, v);
    north.step(n.x(), n.z(), v.x());
    east.step(n.y(), n.z(), v.y());
    ASSERT_NEAR(filter.airspeed().x(), north.x(0), 1e-12) << k;
    ASSERT_NEAR(filter.wind().x(), north.x(1), 1e-12) << k;
    ASSERT_NEAR(filter.airspeed().y(), east.x(0), 1e-12) << k;
    ASSERT_NEAR(filter.wind().y(), east.x(1), 1e-12) << k;
  }
}

TEST(ClassicFilter, EqualsThePublicationAtEveryStep) { expect_reference(false); }
TEST(ClassicFilter, ExactVariantEqualsItsReferenceAtEveryStep) { expect_reference(true); }

TEST(ClassicFilter, SettlesOnASteadyWindSlowly) {
  // Why it is a fixture and not the default: 6 m/s steady, no noise, and 60 s later it is still settling.
  ClassicFilter filter{ClassicConstants{}};
  const double slope = 0.2303 / 0.896 * 6 / ingest::standard_gravity;
  const Eigen::Vector3d n(slope, 0, 1);  // leaning south, into a wind toward north; thrust of m g / n_d
  double at_20 = 0;
  for (int k = 0; k < 3000; ++k) {
    filter.step(n, {0, 0});
    if (k == 200) at_20 = filter.wind().x();
  }
  EXPECT_LT(at_20, 0.9 * 6);
  EXPECT_NEAR(filter.wind().x(), 6, 0.05);
}

}  // namespace
}  // namespace quadsonde::estimator
