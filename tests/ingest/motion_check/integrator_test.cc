#include "ingest/motion/integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "ingest/motion/shooting.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Vector2d;

constexpr double oracle = 1e-7;  // relative; the integrator's own tolerance is 1e-8 per step

MotionCourse level(double duration) {
  MotionCourse course(2);
  course[1].time = duration;
  return course;
}

MotionState last(const MotionCourse& course, const MotionParameters& p, double t,
                 const Vector2d& v0 = Vector2d::Zero()) {
  const auto states = integrate(course, v0, Vector2d::Zero(), p, {t});
  EXPECT_TRUE(states) << (states ? "" : to_string(states.error()));
  return states ? states->back() : MotionState{};
}

TEST(MotionIntegrator, DriftsWithTheWindAsTheExponentialSays) {
  MotionParameters p;
  p.wind = {3.8, -1.2};
  p.drag.linear = 0.257;
  const auto course = level(30);
  for (const double t : {0.5, 4.0, 20.0}) {
    const auto state = last(course, p, t);
    const double e = std::exp(-0.257 * t);
    EXPECT_NEAR(state.v.x(), 3.8 * (1 - e), 3.8 * oracle);
    EXPECT_NEAR(state.v.y(), -1.2 * (1 - e), 1.2 * oracle);
    EXPECT_NEAR(state.sensitivity(0, m_linear), 3.8 * t * e, 3.8 * t * oracle);
    EXPECT_NEAR(state.sensitivity(0, m_wind_n), 1 - e, oracle);
    EXPECT_NEAR(state.sensitivity(0, m_v0_n), e, oracle);
    EXPECT_NEAR(state.p.x(), 3.8 * (t - (1 - e) / 0.257), 3.8 * t * oracle);
  }
}

TEST(MotionIntegrator, AnswersAConstantTiltAsTheClosedFormSays) {
  auto course = level(20);
  for (auto& node : course) node.slope = {0.05, -0.02};
  MotionParameters p;
  p.drag.linear = 0.2;
  const auto state = last(course, p, 10);
  const double reach = (1 - std::exp(-0.2 * 10)) / 0.2 * standard_gravity;
  EXPECT_NEAR(state.v.x(), 0.05 * reach, 0.05 * reach * oracle);
  EXPECT_NEAR(state.v.y(), -0.02 * reach, 0.02 * reach * oracle);
}

TEST(MotionIntegrator, SlowsInTheAirByTheQuadraticLaw) {
  MotionParameters p;
  p.drag.quadratic = 0.03;
  for (const double t : {1.0, 7.5}) {
    const auto state = last(level(8), p, t, {-9, 0});
    EXPECT_NEAR(state.v.x(), -9 / (1 + 0.03 * 9 * t), 9 * oracle);
    const double a0 = 9, expected = a0 * a0 * t / std::pow(1 + 0.03 * a0 * t, 2);
    EXPECT_NEAR(state.sensitivity(0, m_quadratic), expected, expected * 10 * oracle);
  }
}

/// A course aligned with no axis: turning, climbing, leaning, with a jump in the middle.
MotionCourse busy() {
  MotionCourse course;
  for (int i = 0; i <= 60; ++i) {
    MotionNode node;
    node.time = 0.1 * i;
    node.slope = {0.1 * std::sin(1.3 * node.time) + 0.05, 0.07 * std::cos(0.9 * node.time)};
    node.heading = 0.4 + 0.3 * node.time;
    node.lift = standard_gravity + 0.3 * std::sin(node.time);
    node.v_down = -1.5 + 0.3 * std::cos(node.time);
    course.push_back(node);
    if (i != 30) continue;
    node.slope += Vector2d(-0.15, 0.1);
    course.push_back(node);
  }
  return course;
}

MotionParameters busy_parameters() {
  MotionParameters p;
  p.wind = {2.1, -3.3};
  p.drag = {0.2, 0.02, 0.03, -0.01};
  p.trim = {0.2, -0.15};
  return p;
}

TEST(MotionIntegrator, GivesSensitivitiesThatDifferencesConfirm) {
  const auto course = busy();
  const auto p = busy_parameters();
  const Vector2d v0(1.2, -0.7);
  const double t = 5.55, h = 1e-4;
  const auto base = last(course, p, t, v0);
  const auto difference = [&](const std::function<void(MotionParameters&, Vector2d&, double)>& move) {
    MotionParameters p1 = p, p2 = p;
    Vector2d a = v0, b = v0;
    move(p1, a, h), move(p2, b, -h);
    const auto up = last(course, p1, t, a), down = last(course, p2, t, b);
    Eigen::Vector4d d;
    d << (up.v - down.v) / (2 * h), (up.p - down.p) / (2 * h);
    return d;
  };
  const auto expect = [&](MotionColumn column, const Eigen::Vector4d& d) {
    EXPECT_LT((base.sensitivity.col(column) - d).norm(), 2e-4 * (1 + d.norm())) << column << "\n" << d;
  };
  expect(m_v0_n, difference([](auto&, Vector2d& v, double s) { v.x() += s; }));
  expect(m_v0_e, difference([](auto&, Vector2d& v, double s) { v.y() += s; }));
  expect(m_wind_n, difference([](auto& q, Vector2d&, double s) { q.wind.x() += s; }));
  expect(m_wind_e, difference([](auto& q, Vector2d&, double s) { q.wind.y() += s; }));
  expect(m_trim_x, difference([](auto& q, Vector2d&, double s) { q.trim.x() += s; }));
  expect(m_trim_y, difference([](auto& q, Vector2d&, double s) { q.trim.y() += s; }));
  expect(m_linear, difference([](auto& q, Vector2d&, double s) { q.drag.linear += s; }));
  expect(m_quadratic, difference([](auto& q, Vector2d&, double s) { q.drag.quadratic += s; }));
}

TEST(MotionIntegrator, KnowsWhatALatencyDoes) {
  // Without a jump: the attitude moves against the vertical motion by the latency.
  MotionCourse early, late;
  const auto node_at = [](double t, double shift) {
    MotionNode node;
    node.time = t;
    node.slope = {0.1 * (t - shift) * 0.2, 0.05 - 0.02 * (t - shift)};
    node.heading = 0.3 * (t - shift);
    return node;
  };
  const double h = 1e-3;
  for (const double t : {0.0, 2.0, 4.0}) early.push_back(node_at(t, -h)), late.push_back(node_at(t, h));
  MotionCourse middle;
  for (const double t : {0.0, 2.0, 4.0}) middle.push_back(node_at(t, 0));
  const auto p = busy_parameters();
  const auto base = last(middle, p, 3.7);
  const Vector2d d = (last(late, p, 3.7).v - last(early, p, 3.7).v) / (2 * h);
  EXPECT_LT((base.sensitivity.col(m_latency).head<2>() - d).norm(), 1e-4 * d.norm());
}

TEST(MotionIntegrator, AgreesWithTheClosedFormOfTheLinearLaw) {
  auto course = busy();
  ShootingPrior prior;
  prior.drag.linear = 0.25;
  MotionParameters p = busy_parameters();
  p.drag = prior.drag;
  std::vector<double> times;
  for (int i = 0; i <= 50; ++i) times.push_back(0.1 * i + 0.0);
  const auto states = integrate(course, {1, 2}, Vector2d::Zero(), p, times);
  ASSERT_TRUE(states);
  const auto closed = closed_form(course, times, {{1, 2}, p.wind}, prior, p.trim, 0, 1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    // The closed form takes the products slope x lift and heading x trim as linear within a step of 0.1 s.
    EXPECT_NEAR((*states)[i].v.x(), closed.v(static_cast<Eigen::Index>(i)), 2e-4);
    EXPECT_NEAR((*states)[i].v.y(), closed.v(static_cast<Eigen::Index>(i + times.size())), 2e-4);
    EXPECT_NEAR((*states)[i].sensitivity(0, m_linear) * 0.25, closed.jacobian(static_cast<Eigen::Index>(i), 6), 1e-3);
  }
}

TEST(MotionIntegrator, RefusesACourseThatDoesNotAscend) {
  auto course = level(10);
  std::swap(course[0], course[1]);
  EXPECT_FALSE(integrate(course, Vector2d::Zero(), Vector2d::Zero(), {}, {1.0}));
  EXPECT_FALSE(integrate(level(10), Vector2d::Zero(), Vector2d::Zero(), {}, {11.0}));
  EXPECT_FALSE(integrate({}, Vector2d::Zero(), Vector2d::Zero(), {}, {}));
}

TEST(MotionIntegrator, SaysSoWhenTheMotionIsNotFinite) {
  auto course = level(10);
  course[1].slope.x() = std::nan("");
  const auto states = integrate(course, Vector2d::Zero(), Vector2d::Zero(), {}, {5.0});
  EXPECT_FALSE(states);
}

}  // namespace
}  // namespace quadsonde::ingest
