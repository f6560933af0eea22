#include "ingest/motion/wind_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/ingest/motion/made_scenarios.h"

namespace quadsonde::ingest {
namespace {

TEST(WindField, HasTheModelsOfTheManual) {
  WindField jet;
  jet.model = WindField::Model::jet;
  const double speed = 2 + 5 * (1 - std::exp(-1.5)) + 2.5;  // at 180 m
  const double angle = 70 + 40 * (1 - std::exp(-0.6));
  EXPECT_LT((jet.mean(180, 0) - toward(speed, angle)).norm(), 1e-12);
  WindField power;
  power.model = WindField::Model::power_law;
  power.toward = {5, 0};
  EXPECT_NEAR(power.mean(100, 0).x(), 5 * std::pow(10, 0.143), 1e-12);
  EXPECT_NEAR(power.mean(10, 0).x(), 5, 1e-12);
  WindField law;
  law.model = WindField::Model::log_law;
  law.toward = {5, 0};
  EXPECT_NEAR(law.mean(10, 0).x(), 5, 1e-12);
  EXPECT_NEAR(law.mean(100, 0).x(), 5 * std::log(100 / 0.03) / std::log(10 / 0.03), 1e-12);
  EXPECT_NEAR(law.mean(0, 0).x(), 0, 0.01) << "no wind at the ground, and no minus infinity";
  WindField table;
  table.model = WindField::Model::table;
  table.levels = {{10, {1, 0}}, {20, {3, 2}}};
  EXPECT_EQ(table.mean(5, 0), Eigen::Vector2d(1, 0));
  EXPECT_EQ(table.mean(15, 0), Eigen::Vector2d(2, 1));
  EXPECT_EQ(table.mean(25, 0), Eigen::Vector2d(3, 2));
}

TEST(WindField, StepsAtItsTimesAndVeersClockwise) {
  WindField w;
  w.toward = {4, 0};
  w.steps = {{10, {0, 3}}, {20, {-2, 0}}};
  EXPECT_EQ(w.mean(50, 9.99), Eigen::Vector2d(4, 0));
  EXPECT_EQ(w.mean(50, 10), Eigen::Vector2d(0, 3));
  EXPECT_EQ(w.mean(50, 25), Eigen::Vector2d(-2, 0));
  WindField veering;
  veering.toward = {4, 0};
  veering.veer_deg_per_m = 1;
  EXPECT_LT((veering.mean(100, 0) - toward(4, 90)).norm(), 1e-12) << "north to east";
}

TEST(WindField, PutsTheJetWhereItIsTold) {
  WindField w;
  w.model = WindField::Model::jet;
  w.jet = {1, 3, 100, 6, 90, 20, 200, 0, 300};
  double highest = 0, at = 0;
  for (double z = 0; z <= 300; z += 1)
    if (const double speed = w.mean(z, 0).norm(); speed > highest) highest = speed, at = z;
  EXPECT_NEAR(at, 90, 1);
  EXPECT_NEAR(highest, 1 + 3 * (1 - std::exp(-0.9)) + 6, 0.01);
  EXPECT_LT((w.mean(0, 0) - toward(1 + 6 * std::exp(-20.25), 200)).norm(), 1e-12);
}

TEST(WindField, ATableOfProfilesIsLinearInTimeToo) {
  WindField w;
  w.model = WindField::Model::table;
  w.levels = {{10, {1, 0}, 0}, {20, {3, 0}, 0}, {10, {1, 4}, 100}, {30, {5, 4}, 100}, {0, {9, 9}, 200}};
  EXPECT_EQ(w.mean(15, 0), Eigen::Vector2d(2, 0));
  EXPECT_EQ(w.mean(15, 50), Eigen::Vector2d(2, 2)) << "half way between (2, 0) and (2, 4)";
  EXPECT_EQ(w.mean(20, 100), Eigen::Vector2d(3, 4));
  EXPECT_EQ(w.mean(20, 150), Eigen::Vector2d(6, 6.5));
  EXPECT_EQ(w.mean(20, 500), Eigen::Vector2d(9, 9)) << "the last profile stays";
}

}  // namespace
}  // namespace quadsonde::ingest
