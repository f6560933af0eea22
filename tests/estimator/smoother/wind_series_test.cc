#include "estimator/smoother/wind_series.h"

#include <gtest/gtest.h>

#include <set>

namespace quadsonde::estimator {
namespace {

WindEstimate wind(double n, double e, double sd = 0.1) { return {{n, e}, sd * sd * Eigen::Matrix2d::Identity(), true}; }

TEST(WindReport, SaysWhereTheWindComesFromClockwiseFromNorth) {
  EXPECT_DOUBLE_EQ(*to_report(wind(0, -5)).from_deg, 90) << "blowing toward the west, it comes from the east";
  EXPECT_DOUBLE_EQ(*to_report(wind(5, 0)).from_deg, 180);
  EXPECT_DOUBLE_EQ(*to_report(wind(0, 5)).from_deg, 270);
  EXPECT_DOUBLE_EQ(to_report(wind(3, 4)).speed_m_s, 5);
}

TEST(WindReport, NorthIs360AndNever0) {
  for (const double east : {0.0, -0.0, 1e-300, 1e-17, -1e-17}) {
    const auto report = to_report(wind(-5, east));
    ASSERT_TRUE(report.from_deg);
    EXPECT_GT(*report.from_deg, 0);
    EXPECT_LE(*report.from_deg, 360);
  }
  EXPECT_DOUBLE_EQ(*to_report(wind(-5, 0)).from_deg, 360);
}

TEST(WindReport, HasNoDirectionBelowTwiceItsUncertainty) {
  EXPECT_FALSE(to_report(wind(0.19, 0)).from_deg);
  EXPECT_TRUE(to_report(wind(0.21, 0)).from_deg);
  EXPECT_FALSE(to_report(wind(0, 0, 0)).from_deg) << "calm comes from nowhere";
  EXPECT_NEAR(to_report(wind(0.19, 0)).speed_m_s, 0.19, 1e-15);
  EXPECT_FALSE(direction_sd_deg(wind(0.19, 0)));
}

TEST(WindReport, OfTheClassicFilterHasNoDirectionBelowHalfAMetrePerSecond) {
  WindEstimate classic{{0.49, 0}, Eigen::Matrix2d::Zero(), false};
  EXPECT_FALSE(to_report(classic).from_deg);
  classic.v_NA_N.x() = 0.51;
  EXPECT_TRUE(to_report(classic).from_deg);
  EXPECT_FALSE(direction_sd_deg(classic)) << "it reports no uncertainty";
}

TEST(WindReport, SplitsTheCovarianceAlongAndAcrossTheVector) {
  WindEstimate w{{0, 4}, Eigen::Matrix2d{{0.04, 0}, {0, 0.25}}, true};
  EXPECT_DOUBLE_EQ(speed_sd(w), 0.5);
  EXPECT_NEAR(*direction_sd_deg(w), 0.2 / 4 * 57.29577951308232, 1e-12);
  w.v_NA_N = {0.1, 0};
  EXPECT_DOUBLE_EQ(speed_sd(w), 0.5) << "in calm the widest axis";
}

TEST(Reasons, HaveEachAWordAndASentenceOfTheirOwn) {
  std::set<std::string_view> names, sentences;
  Reasons all;
  for (int i = 0; i < static_cast<int>(Reason::count); ++i) {
    const auto reason = static_cast<Reason>(i);
    names.insert(name(reason));
    sentences.insert(sentence(reason));
    EXPECT_FALSE(all.has(reason));
    all.add(reason);
    EXPECT_TRUE(all.has(reason));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(Reason::count));
  EXPECT_EQ(sentences.size(), static_cast<std::size_t>(Reason::count));
  EXPECT_EQ(all.list().size(), static_cast<std::size_t>(Reason::count));
  EXPECT_EQ(name(Reason::trim_unobserved), "trim_unobserved");
}

}  // namespace
}  // namespace quadsonde::estimator
