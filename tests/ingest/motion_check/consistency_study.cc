// Every fault in twenty flights that can show it, and a hundred clean flights of every manoeuvre.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/ingest/motion_check/flights.h"

namespace quadsonde::ingest {
namespace {

constexpr int seeds = 20;

ConsistencySettings quick() {
  ConsistencySettings settings;
  settings.confirmed_windows = 1;
  return settings;
}

class InjectedFault : public testing::TestWithParam<Spoilt> {};

TEST_P(InjectedFault, IsPutInItsClassNineteenTimesOutOfTwenty) {
  int right = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto report = check_consistency(GetParam().fly(static_cast<std::uint64_t>(seed)), {}, quick());
    ASSERT_TRUE(report);
    const bool named = !report->findings.empty() && report->findings.front().fault == GetParam().fault;
    right += named && report->verdict == Verdict::inconsistent;
    if (!named) fmt::print("{} seed {}: {}", GetParam().name, seed, described(*report));
  }
  fmt::print("{}: {} of {}\n", GetParam().name, right, seeds);
  EXPECT_GE(right, 19);
}

INSTANTIATE_TEST_SUITE_P(Study, InjectedFault, testing::ValuesIn(spoilt_flights(160)),
                         [](const auto& test) { return test.param.name; });

struct Clean {
  const char* name;
  Manoeuvre manoeuvre;
};
class CleanFlight : public testing::TestWithParam<Clean> {};

TEST_P(CleanFlight, IsNeverCondemnedNorDoubted) {
  const HeadingRule rules[] = {
      {HeadingRule::Kind::turning, 0, 17}, {HeadingRule::Kind::along_track, 0, 0}, {HeadingRule::Kind::fixed, 40, 0}};
  int alarms = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto scenario = scenario_of(GetParam().manoeuvre, rules[seed % 3], 120, 1000 + static_cast<std::uint64_t>(seed));
    // Every other vehicle has an attitude whose errors are slow, as an autopilot's are.
    scenario.sensors.tilt_correlation = seed % 2 ? 0 : 1;
    const auto report = check_consistency(flown(scenario), {}, quick());
    ASSERT_TRUE(report);
    const bool alarm = report->verdict == Verdict::inconsistent || report->verdict == Verdict::doubtful;
    alarms += alarm;
    if (alarm) fmt::print("{} seed {}: {}", GetParam().name, seed, described(*report));
  }
  fmt::print("{}: {} alarms in {}\n", GetParam().name, alarms, seeds);
  EXPECT_EQ(alarms, 0);
}

INSTANTIATE_TEST_SUITE_P(Study, CleanFlight,
                         testing::Values(Clean{"Hover", Manoeuvre::hover}, Clean{"Circle", Manoeuvre::circle},
                                         Clean{"Line", Manoeuvre::line}, Clean{"Square", Manoeuvre::square},
                                         Clean{"Ascent", Manoeuvre::ascent}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace quadsonde::ingest
