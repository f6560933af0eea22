#include <gtest/gtest.h>

#include <algorithm>

#include "ingest/motion/shooting.h"
#include "tests/ingest/motion_check/flights.h"

namespace quadsonde::ingest {
namespace {

constexpr double duration = 160;  // [s]: eight windows, so that tests stay short

ConsistencySettings quick() {
  ConsistencySettings settings;
  settings.confirmed_windows = 2;
  return settings;
}

ConsistencyReport checked(const Flight& flight, const DragArguments& drag = {}) {
  const auto report = check_consistency(flight, drag, quick());
  EXPECT_TRUE(report) << (report ? "" : to_string(report.error()));
  return report ? *report : ConsistencyReport{};
}

/// The vehicle as it was simulated.
DragArguments known_drag() {
  DragArguments drag;
  drag.drag = published_vehicle().drag;
  drag.drag_log_sd = 0.001;
  drag.turbulence_sd = 0.5;
  return drag;
}

class NamedFault : public testing::TestWithParam<const char*> {};

TEST_P(NamedFault, IsNamedOnASquareWithItsOwnYaw) {
  const auto all = spoilt_flights(duration);
  const auto fault = std::find_if(all.begin(), all.end(), [](const auto& f) { return f.name == GetParam(); });
  ASSERT_NE(fault, all.end());
  const auto report = checked(fault->fly(3));
  EXPECT_EQ(report.verdict, Verdict::inconsistent) << described(report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.front().fault, fault->fault) << described(report);
  EXPECT_FALSE(report.findings.front().causes.empty());
}

INSTANTIATE_TEST_SUITE_P(Check, NamedFault,
                         testing::Values("TiltSignReversed", "RollAndPitchExchanged", "NorthAndEastExchanged",
                                         "KnotsReadAsMetresPerSecond", "RadiansReadAsDegrees", "DegreesReadAsRadians",
                                         "LatencyIgnored", "YawMissing", "VelocityInHeadingAxes"),
                         [](const auto& test) { return std::string(test.param); });

TEST(ConsistencyCheck, FindsACleanSquareConsistentAndTheIntegratorAgrees) {
  const auto report = checked(flown(telling_square(300, 7)), known_drag());
  EXPECT_EQ(report.verdict, Verdict::consistent) << described(report);
  EXPECT_TRUE(report.noise_is_known);
  // One flight of 15 windows scatters by .03; the mean over 30 flights is a gate.
  EXPECT_NEAR(report.chi2_per_dof, 1.0, 0.1);
  EXPECT_TRUE(report.findings.empty()) << described(report);
  ASSERT_TRUE(report.chi2_integrated);
  EXPECT_NEAR(*report.chi2_integrated, 1.0, 0.3);  // two windows only
}

TEST(ConsistencyCheck, SeesAReversedTiltTwentyTimesOverTheNoiseWhenTheDragIsKnown) {
  const auto flight = with_angles(flown(telling_square(300, 7)), [](auto& e) { e.roll = -e.roll, e.pitch = -e.pitch; });
  const auto report = checked(flight, known_drag());
  EXPECT_GT(report.chi2_per_dof, 20) << described(report);
  EXPECT_NEAR(report.chi2_restored, 1.0, 0.1);
}

TEST(ConsistencyCheck, MeasuresTheLatencyThatWasIgnored) {
  const auto report = checked(flown(telling_square(300, 7, 0.2)), known_drag());
  EXPECT_GT(report.chi2_per_dof, 2);
  const auto* latency = blamed(report, FaultClass::latency);
  ASSERT_NE(latency, nullptr) << described(report);
  EXPECT_NEAR(latency->size, 0.2, 0.02);
}

TEST(ConsistencyCheck, FindsNoFaultWithALatencyThatIsKnown) {
  auto drag = known_drag();
  drag.latency_s = 0.2;
  const auto report = checked(flown(telling_square(duration, 7, 0.2)), drag);
  EXPECT_EQ(report.verdict, Verdict::consistent) << described(report);
}

TEST(ConsistencyCheck, TakesAHoverForNoEvidence) {
  const auto hover = flown(scenario_of(Manoeuvre::hover, {HeadingRule::Kind::turning, 0, 20}, duration, 4));
  const auto report = checked(hover);
  EXPECT_EQ(report.verdict, Verdict::cannot_be_shown) << described(report);
  const auto listed = [&](const char* text) {
    return std::any_of(report.cannot_show.begin(), report.cannot_show.end(),
                       [&](const auto& s) { return s.find(text) != s.npos; });
  };
  EXPECT_TRUE(listed("wrong sign"));
  EXPECT_TRUE(listed("0.20 s"));
}

TEST(ConsistencyCheck, SaysWhatEvenASquareCannotShow) {
  const auto report = checked(flown(telling_square(duration, 5)));
  const auto& all = report.cannot_show;
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const auto& s) { return s.find("mass") != s.npos; }));
  EXPECT_FALSE(std::any_of(all.begin(), all.end(), [](const auto& s) { return s.find("exchanged") != s.npos; }));
}

TEST(ConsistencyCheck, FindsTheMountingAngleOfATiltedAutopilotButDoesNotCondemnIt) {
  auto scenario = telling_square(duration, 6);
  scenario.sensors.trim_pitch_deg = -7;
  const auto report = checked(flown(scenario));
  const auto* offset = blamed(report, FaultClass::tilt_offset);
  ASSERT_NE(offset, nullptr) << described(report);
  EXPECT_FALSE(offset->decides);
  EXPECT_NEAR(report.trim_pitch_deg, -7, 0.7);
}

TEST(ConsistencyCheck, ComesToTheSameAnswerEachTime) {
  const auto flight = flown(telling_square(60, 2));
  EXPECT_EQ(to_text(checked(flight)), to_text(checked(flight)));
}

TEST(ConsistencyCheck, RefusesFlightsWithoutWhatItNeeds) {
  auto flight = flown(telling_square(60, 2));
  auto no_attitude = flight;
  no_attitude.attitude = {};
  EXPECT_EQ(check_consistency(no_attitude).error().kind, Kind::missing);
  auto no_velocity = flight;
  no_velocity.velocity = {};
  EXPECT_EQ(check_consistency(no_velocity).error().kind, Kind::missing);
  EXPECT_EQ(check_consistency(cut(flight, LogTime{0}, LogTime{4'000'000'000})).error().kind, Kind::no_answer);
}

}  // namespace
}  // namespace quadsonde::ingest
