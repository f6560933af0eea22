#include "estimator/filter/wind_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "ingest/motion/random.h"
#include "tests/estimator/filter/model_at.h"

namespace quadsonde::estimator {
namespace {

using ingest::Gaussian;

/// A course of inputs in which everything changes: slope, heading, climb.
template <class S>
StepInput<S> busy_input(int k, Gaussian& noise) {
  StepInput<S> in;
  in.slope = {S(0.1 * std::sin(0.013 * k) + 0.01 * noise()), S(0.08 * std::cos(0.017 * k) + 0.01 * noise())};
  in.slope_rate = {S(0.1 * noise()), S(0.1 * noise())};
  in.lift = S(9.8 + 0.2 * noise());
  in.v_down = S(2 * std::sin(0.002 * k));
  in.heading = S(0.035 * k);
  in.step = S(0.1);
  return in;
}

template <class S>
WindFilter<S> started(const WindModel<S>& model) {
  WindFilter<S> filter(model, FilterLimits<S>{});
  filter.start({S(0.3), S(-0.2)}, {S(0.05), S(0.02)}, S(0.1) * Matrix2<S>::Identity());
  return filter;
}

template <class S>
void expect_sound_covariance_over_many_steps() {
  Gaussian noise(3);
  auto filter = started(linear_model<S>());
  int updated = 0;
  for (int k = 0; k < 100'000; ++k) {
    const Vector2<S> v = filter.state().template segment<2>(i_v) + Vector2<S>(S(0.1 * noise()), S(0.1 * noise()));
    updated += filter.step(busy_input<S>(k, noise), v, S(0.01)) == Outcome::updated;
    const auto& P = filter.covariance();
    // Exact after an update; a rejected sample leaves the prediction's rounding.
    ASSERT_LE((P - P.transpose()).norm(), 4 * std::numeric_limits<S>::epsilon() * P.norm()) << "step " << k;
    ASSERT_GT(P.diagonal().minCoeff(), 0) << "step " << k;
    if (k % 500 != 0) continue;
    const Eigen::Matrix<double, 8, 8> Pd = P.template cast<double>();
    const Eigen::Matrix<double, 8, 1> scale = Pd.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix<double, 8, 8> correlation = scale.asDiagonal() * Pd * scale.asDiagonal();
    ASSERT_GT(Eigen::SelfAdjointEigenSolver<StateMatrix<double>>(correlation).eigenvalues().minCoeff(), 0)
        << "step " << k;
    ASSERT_TRUE(filter.state().allFinite() && filter.sensitivity().allFinite()) << "step " << k;
  }
  EXPECT_GT(updated, 99'000);
}

TEST(WindFilter, KeepsItsCovarianceSymmetricAndPositiveInDouble) { expect_sound_covariance_over_many_steps<double>(); }
TEST(WindFilter, KeepsItsCovarianceSymmetricAndPositiveInFloat) { expect_sound_covariance_over_many_steps<float>(); }

TEST(WindFilter, InFloatFollowsTheOneInDouble) {
  Gaussian a(4), b(4), v_noise(5);
  auto d = started(linear_model<double>());
  auto f = started(linear_model<float>());
  double worst = 0;
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Vector2d v(0.3 * std::sin(0.01 * k) + 0.1 * v_noise(), 0.1 * v_noise());
    d.step(busy_input<double>(k, a), v, 0.01);
    f.step(busy_input<float>(k, b), v.cast<float>(), 0.01f);
    if (k > 100) worst = std::max(worst, (d.wind() - f.wind().cast<double>()).norm());
  }
  EXPECT_LT(worst, 5e-3) << "far below the 0.1 m/s that a wind is known to";
}

/// Textbook update with the whole H, written down a second time.
struct PlainFilter {
  State<double> x;
  StateMatrix<double> P;
  void predict(const Transition<double>& t) {
    x = t.x;
    P = (t.Phi * P * t.Phi.transpose() + t.Q).eval();
  }
  void update(const Eigen::Vector2d& v, double variance) {
    Eigen::Matrix<double, 2, 8> H = Eigen::Matrix<double, 2, 8>::Zero();
    H.leftCols<2>().setIdentity();
    const Eigen::Matrix2d S = H * P * H.transpose() + variance * Eigen::Matrix2d::Identity();
    correct(P * H.transpose() * S.inverse(), v, variance);
  }
  void correct(const Eigen::Matrix<double, 8, 2>& K, const Eigen::Vector2d& v, double variance) {
    x += K * (v - x.head<2>());
    StateMatrix<double> M = StateMatrix<double>::Identity();
    M.leftCols<2>() -= K;
    P = (M * P * M.transpose() + variance * K * K.transpose()).eval();
  }
};

TEST(WindFilter, IsTheTextbookKalmanFilter) {
  Gaussian noise(7), v_noise(8);
  const auto model = linear_model();
  auto filter = started(model);
  PlainFilter plain{filter.state(), filter.covariance()};
  for (int k = 0; k < 500; ++k) {
    const auto in = busy_input<double>(k, noise);
    plain.predict(propagate(model, plain.x, in));
    const Eigen::Vector2d v = plain.x.head<2>() + 0.1 * Eigen::Vector2d(v_noise(), v_noise());
    ASSERT_EQ(filter.step(in, v, 0.01), Outcome::updated);
    plain.update(v, 0.01);
    ASSERT_LT((filter.state() - plain.x).norm(), 1e-9) << k;
    ASSERT_LT((filter.covariance() - plain.P).norm(), 1e-9 * plain.P.norm()) << k;
  }
}

TEST(WindFilter, ThatThawsItsTrimEqualsOneThatCarriedItAsSchmidtState) {
  Gaussian noise(9), v_noise(10);
  auto frozen = linear_model(), carried = linear_model();
  frozen.trim_is_state = false;
  frozen.trim_psd = carried.trim_psd = 0;
  const Eigen::Matrix2d prior{{0.2, 0.05}, {0.05, 0.1}};
  WindFilter<double> filter(frozen, {});
  filter.start({0.3, -0.2}, {0.05, 0.02}, prior);
  PlainFilter schmidt{filter.state(), filter.covariance()};
  schmidt.P.bottomRightCorner<2, 2>() = prior;
  const auto step = [&](int k, bool freeze) {
    const auto in = busy_input<double>(k, noise);
    schmidt.predict(propagate(carried, schmidt.x, in));
    const Eigen::Vector2d v = schmidt.x.head<2>() + 0.1 * Eigen::Vector2d(v_noise(), v_noise());
    filter.predict(in);
    // Schmidt's gain is formed with the trim's share in S; the consider form forms it without. They are the same
    // filter only where the gain is; so the frozen gain is taken from the consider filter's own covariance.
    if (freeze) {
      const StateMatrix<double> P_own = filter.covariance();
      const Eigen::Matrix2d S = P_own.topLeftCorner<2, 2>() + 0.01 * Eigen::Matrix2d::Identity();
      schmidt.correct(P_own.leftCols<2>() * S.inverse(), v, 0.01);
    } else {
      schmidt.update(v, 0.01);
    }
    ASSERT_EQ(filter.update(v, 0.01), Outcome::updated) << k;
  };
  for (int k = 0; k < 300; ++k) step(k, true);
  EXPECT_EQ((filter.covariance().bottomRows<2>().norm()), 0) << "frozen: no covariance of its own";
  EXPECT_LT((filter.state() - schmidt.x).norm(), 1e-9);
  filter.thaw_trim();
  EXPECT_LT((filter.covariance() - schmidt.P).norm(), 1e-9 * schmidt.P.norm()) << "all cross-covariances are there";
  EXPECT_EQ((filter.sensitivity().rightCols<2>().norm()), 0) << "what is a state is no longer considered";
  for (int k = 300; k < 900; ++k) step(k, false);
  EXPECT_LT((filter.state() - schmidt.x).norm(), 1e-8);
  EXPECT_LT((filter.covariance() - schmidt.P).norm(), 1e-8 * schmidt.P.norm());
  EXPECT_LT(filter.covariance()(i_b, i_b), 0.5 * prior(0, 0)) << "and from then on it is estimated";
}

TEST(WindFilter, SensitivitiesAreTheDerivativesOfItsAnswers) {
  // The whole filter run twice with a parameter moved; gates open so that the same samples count.
  const auto run = [](double linear, double trim_x) {
    Gaussian noise(11), v_noise(12);
    auto m = linear_model();
    m.drag = {linear, 0, 0.03, 0.002};
    m.trim_is_state = false;
    FilterLimits<double> limits;
    limits.gate_nis = 1e9;
    WindFilter<double> filter(m, limits);
    filter.start({0, 0}, {trim_x, 0}, Eigen::Matrix2d::Identity());
    for (int k = 0; k < 600; ++k) filter.step(busy_input<double>(k, noise), {0.2 * v_noise(), 0.2 * v_noise()}, 0.01);
    return filter;
  };
  const auto here = run(0.257, 0);
  // The gain's own change with delta is no part of a consider sensitivity: 5 % of it here.
  const Eigen::Vector2d by_linear = (run(0.2571, 0).wind() - run(0.2569, 0).wind()) / 2e-4;
  const Eigen::Vector2d told =
      here.sensitivity().col(c_linear).segment<2>(i_W) + here.sensitivity().col(c_linear).segment<2>(i_u);
  EXPECT_LT((by_linear - told).norm(), 0.15 * told.norm());
  const Eigen::Vector2d by_trim = (run(0.257, 0.01).wind() - run(0.257, -0.01).wind()) / 0.02;
  const Eigen::Vector2d trim =
      here.sensitivity().col(c_trim_x).segment<2>(i_W) + here.sensitivity().col(c_trim_x).segment<2>(i_u);
  EXPECT_LT((by_trim - trim).norm(), 1e-6 * trim.norm()) << "the trim changes no gain";
}

TEST(WindFilter, RejectsAWildSampleAndANumberThatIsNoneWithoutATrace) {
  Gaussian noise(13);
  auto filter = started(linear_model());
  for (int k = 0; k < 50; ++k) filter.step(busy_input<double>(k, noise), filter.state().head<2>(), 0.01);
  filter.predict(oblique_input(0));
  const auto x = filter.state();
  const auto P = filter.covariance();
  EXPECT_EQ(filter.update(x.head<2>() + Eigen::Vector2d(30, 0), 0.01), Outcome::rejected);
  EXPECT_EQ(filter.update({std::numeric_limits<double>::quiet_NaN(), 0}, 0.01), Outcome::rejected);
  EXPECT_EQ(filter.state(), x);
  EXPECT_EQ(filter.covariance(), P);
  EXPECT_EQ(filter.update(x.head<2>(), 0.01), Outcome::updated);
}

TEST(WindFilter, GateIsThatOfItsSettings) {
  auto filter = started(linear_model());
  filter.predict(oblique_input(0));
  const double sd = std::sqrt(filter.covariance()(0, 0) + 0.01);
  const Eigen::Vector2d v = filter.state().head<2>();
  auto below = filter, above = filter;
  EXPECT_EQ(below.update(v + Eigen::Vector2d(std::sqrt(18.39) * sd, 0), 0.01), Outcome::updated);
  EXPECT_EQ(above.update(v + Eigen::Vector2d(std::sqrt(18.41) * sd, 0), 0.01), Outcome::rejected);
}

TEST(WindFilter, RestartKeepsTheTrimAndForgetsTheRest) {
  Gaussian noise(14), v_noise(15);
  auto filter = started(linear_model());
  for (int k = 0; k < 600; ++k)
    filter.step(busy_input<double>(k, noise), 0.1 * Eigen::Vector2d(v_noise(), v_noise()), 0.01);
  const auto x = filter.state();
  const auto P = filter.covariance();
  filter.restart({4, -3});
  EXPECT_EQ((filter.state().segment<2>(i_v)), Eigen::Vector2d(4, -3));
  EXPECT_EQ((filter.state().segment<2>(i_b)), (x.segment<2>(i_b)));
  EXPECT_LT((filter.covariance().block<2, 2>(i_b, i_b) - P.block<2, 2>(i_b, i_b)).norm(), 1e-15);
  EXPECT_EQ(filter.covariance()(i_W, i_W), 400);
  EXPECT_EQ((filter.covariance().block<6, 2>(0, i_b).norm()), 0);
}

TEST(WindFilter, OpensWindAndVelocityTogetherForAJumpOfTheRecentPast) {
  auto filter = started(linear_model());
  filter.predict(oblique_input(0));
  auto opened = started(linear_model());
  opened.predict(oblique_input(0), {9, 0.5});
  const StateMatrix<double> added = opened.covariance() - filter.covariance();
  const double share = 1 - std::exp(-0.257 * 0.5);
  EXPECT_NEAR(added(i_W, i_W), 9, 1e-9);
  EXPECT_NEAR(added(i_v, i_v), 9 * share * share, 1e-9);
  EXPECT_NEAR(added(i_v, i_W), 9 * share, 1e-9);
  EXPECT_NEAR(added(i_v, i_W + 1), 0, 1e-12);
}

TEST(WindFilter, FindsTheWindOfASteadyHoverWhileTheNoseTurns) {
  // Noise-free: 5 m/s toward the east, trim 2 degrees, drag known. g s = -c w, and the log shows s less the trim.
  const auto m = linear_model();
  const Eigen::Vector2d wind(0, 5), trim(0.3, -0.1);
  auto filter = started(m);
  for (int k = 0; k < 1800; ++k) {
    StepInput<double> in;
    in.heading = 0.035 * k;
    in.lift = ingest::standard_gravity;
    in.slope = (-m.drag.linear * wind - turn(in.heading) * trim) / in.lift;
    filter.step(in, {0, 0}, 0.01);
  }
  EXPECT_LT((filter.wind() - wind).norm(), 0.02);
  EXPECT_LT((filter.state().segment<2>(i_b) - trim).norm(), 0.01);
}

}  // namespace
}  // namespace quadsonde::estimator
