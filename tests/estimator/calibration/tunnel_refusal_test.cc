// What cannot calibrate is refused in words that tell the next step.
#include <gmock/gmock.h>

#include "ingest/flight/rotation.h"
#include "tests/estimator/calibration/made_runs.h"

namespace quadsonde {
namespace {

using estimator::calibrate_tunnel;
using estimator::drag_at;
using estimator::TunnelRun;
using ingest::Kind;
using support::fly;
using support::fly_each;
using support::MadeRun;
using support::published_settings;
using ::testing::HasSubstr;

ingest::Problem refusal(const std::vector<TunnelRun>& runs, const estimator::TunnelSettings& settings = published_settings()) {
  const auto found = calibrate_tunnel(runs, settings);
  EXPECT_FALSE(found) << "was not refused";
  if (found) return {};
  EXPECT_FALSE(found.error().hint.empty()) << found.error().what;
  return found.error();
}

TEST(TunnelRefusal, AMassThatCannotBe) {
  auto settings = published_settings();
  for (const double mass : {0.0, -1.0, std::nan("")}) {
    settings.mass = mass;
    const auto said = refusal(fly_each({0, 4}), settings);
    EXPECT_EQ(said.kind, Kind::usage);
    EXPECT_THAT(said.hint, HasSubstr("mass_kg"));
  }
}

TEST(TunnelRefusal, OneRunOnly) {
  const auto said = refusal(fly_each({4}));
  EXPECT_EQ(said.kind, Kind::no_answer);
  EXPECT_THAT(said.what, HasSubstr("only one run"));
  EXPECT_THAT(said.hint, HasSubstr("at least two wind speeds"));
}

TEST(TunnelRefusal, RunsThatAreAllAtOneSpeedOrAllCalm) {
  EXPECT_THAT(refusal(fly_each({4, 4, 4.1})).what, HasSubstr("at one wind speed"));
  EXPECT_THAT(refusal(fly_each({0, 0})).what, HasSubstr("no run has wind"));
}

TEST(TunnelRefusal, LessThanThreeQuartersOfATurn) {
  auto runs = fly_each({0, 4, 8});
  MadeRun half;
  half.stated = 6;
  half.turn_deg = 180;
  runs.push_back(fly(half));
  const auto said = refusal(runs);
  EXPECT_EQ(said.kind, Kind::no_answer);
  EXPECT_EQ(said.where.file, "run_6.mcap");
  EXPECT_THAT(said.what, HasSubstr("through only 180 degrees"));
  EXPECT_THAT(said.hint, HasSubstr("turn slowly through a full circle"));
}

TEST(TunnelRefusal, ButAKnownTrimLetsHalfATurnCount) {
  MadeRun half;
  half.turn_deg = 180;
  auto settings = published_settings();
  settings.trim = estimator::TunnelTrim{0.5, -0.3, 0.1};
  const auto found = calibrate_tunnel(fly_each({2, 4, 6, 8}, half), settings);
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_NEAR(drag_at(found->vehicle, 5).value, 0.277, 0.008);
}

TEST(TunnelRefusal, ACalmRunNeedsNoTurn) {
  auto runs = fly_each({2, 4, 6, 8});
  MadeRun calm;
  calm.stated = 0;
  calm.turn_deg = 0;
  runs.push_back(fly(calm));
  const auto found = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_NEAR(found->runs.back().amplitude, 0, 1e-12);
}

TEST(TunnelRefusal, OneWindInAnotherUnitIsNamedWithTheUnit) {
  const struct {
    const char* unit;
    double per_m_s;
  } cases[] = {{"km/h", 3.6}, {"knots", 1 / 0.514444}, {"mph", 1 / 0.44704}};
  for (const auto& c : cases) {
    auto runs = fly_each({0, 2, 4, 6});
    MadeRun wrong;
    wrong.stated = 8 * c.per_m_s;
    wrong.flown = 8;
    runs.push_back(fly(wrong));
    const auto said = refusal(runs);
    EXPECT_EQ(said.kind, Kind::inconsistent);
    EXPECT_EQ(said.where.file, runs.back().name);
    EXPECT_THAT(said.what, HasSubstr(std::string(c.unit) + " instead of m/s"));
    EXPECT_THAT(said.hint, HasSubstr("wind_speed_m_s"));
  }
}

TEST(TunnelRefusal, EveryWindInAnotherUnitIsDoubtedBesideOtherMultirotors) {
  // A linear law in wrong units is a linear law: only what multirotors have speaks against it.
  std::vector<TunnelRun> runs;
  for (const double speed : {2.0, 4.0, 6.0, 8.0}) {
    MadeRun wrong;
    wrong.stated = speed * 3.6;
    wrong.flown = speed;
    wrong.seed = static_cast<std::uint64_t>(speed);
    runs.push_back(fly(wrong));
  }
  const auto found = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  ASSERT_EQ(found->notes.size(), 1u);
  EXPECT_THAT(found->notes[0].what, HasSubstr("unusually low"));
  EXPECT_THAT(found->notes[0].hint, HasSubstr("km/h would make it 0.28"));
}

TEST(TunnelRefusal, TwoWindsThatNoLawJoins) {
  auto runs = fly_each({0, 4});
  MadeRun wrong;
  wrong.stated = 8 * 3.6;
  wrong.flown = 8;
  runs.push_back(fly(wrong));
  const auto said = refusal(runs);
  EXPECT_EQ(said.kind, Kind::inconsistent);
  EXPECT_THAT(said.what, HasSubstr("km/h"));
}

TEST(TunnelRefusal, AnAircraftThatMoves) {
  auto runs = fly_each({0, 4, 8});
  MadeRun moving;
  moving.stated = 6;
  moving.speed = 2;
  runs.push_back(fly(moving));
  const auto said = refusal(runs);
  EXPECT_EQ(said.kind, Kind::inconsistent);
  EXPECT_EQ(said.where.file, "run_6.mcap");
  EXPECT_THAT(said.what, HasSubstr("the aircraft moves"));
  EXPECT_THAT(said.what, HasSubstr("median speed is"));
}

TEST(TunnelRefusal, ADirectionThatTheTiltContradicts) {
  auto runs = fly_each({0, 4, 8});
  MadeRun toward;
  toward.stated = 6;
  toward.stated_from_deg = 20;  // where it blows to
  runs.push_back(fly(toward));
  auto said = refusal(runs);
  EXPECT_EQ(said.kind, Kind::inconsistent);
  EXPECT_THAT(said.what, HasSubstr("stated to come from 20 degrees, but the tilt says 200"));
  EXPECT_THAT(said.hint, HasSubstr("FROM"));

  toward.stated_from_deg = 245;
  runs.back() = fly(toward);
  said = refusal(runs);
  EXPECT_EQ(said.kind, Kind::inconsistent);
  EXPECT_THAT(said.hint, HasSubstr("45 degrees off"));
}

TEST(TunnelRefusal, ACompassSomeDegreesOffIsSaidAndDoesNoHarm) {
  MadeRun off;
  off.stated_from_deg = 208;
  const auto found = calibrate_tunnel(fly_each({0, 2, 4, 6, 8}, off), published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_NEAR(found->flow_offset_deg, -8, 0.5);
  EXPECT_NEAR(drag_at(found->vehicle, 5).value, 0.277, 0.004);
  ASSERT_FALSE(found->notes.empty());
  EXPECT_THAT(found->notes[0].hint, HasSubstr("compass"));
}

TEST(TunnelRefusal, RollAndPitchExchanged) {
  auto runs = fly_each({0, 2, 4, 6});
  for (auto& run : runs)
    for (auto& q : run.flight.attitude.value) {
      const auto e = ingest::euler_from_q_NB(q);
      q = ingest::q_NB_from_euler({e.pitch, e.roll, e.yaw});
    }
  const auto said = refusal(runs);
  EXPECT_EQ(said.kind, Kind::inconsistent);
  EXPECT_THAT(said.hint, HasSubstr("exchanged"));
}

TEST(TunnelRefusal, ATiltThatDoesNotFollowTheWind) {
  MadeRun still;
  still.flown = 0;
  const auto said = refusal(fly_each({0, 4, 8}, still));
  EXPECT_EQ(said.kind, Kind::inconsistent);
  EXPECT_THAT(said.what, HasSubstr("no tilt follows the wind"));
}

TEST(TunnelRefusal, RunsWithoutAttitudeWithoutVelocityOrOutsideTheStatedTimes) {
  auto runs = fly_each({0, 4});
  runs[1].flight.attitude = {};
  EXPECT_EQ(refusal(runs).kind, Kind::missing);
  EXPECT_THAT(refusal(runs).what, HasSubstr("no attitude"));
  runs = fly_each({0, 4});
  runs[1].flight.velocity = {};
  EXPECT_THAT(refusal(runs).what, HasSubstr("no velocity"));
  runs = fly_each({0, 4});
  runs[1].start = ingest::LogTime{1'000'000'000'000};
  EXPECT_THAT(refusal(runs).hint, HasSubstr("start_s"));
  runs[1].start = ingest::LogTime{50'000'000'000};
  EXPECT_THAT(refusal(runs).what, HasSubstr("only"));
}

TEST(TunnelRefusal, WindsThatCannotBe) {
  const auto with = [](auto change) {
    auto runs = fly_each({0, 4});
    change(runs[1]);
    return refusal(runs);
  };
  EXPECT_EQ(with([](TunnelRun& r) { r.wind_speed = -4; }).kind, Kind::usage);
  EXPECT_EQ(with([](TunnelRun& r) { r.wind_speed = std::nan(""); }).kind, Kind::usage);
  EXPECT_EQ(with([](TunnelRun& r) { r.wind_from_deg = 4000; }).kind, Kind::usage);
  EXPECT_EQ(with([](TunnelRun& r) { r.wind_speed_sd = 0.0; }).kind, Kind::usage);
  EXPECT_EQ(with([](TunnelRun& r) { r.air_density = 1190.0; }).kind, Kind::usage);
  EXPECT_EQ(with([](TunnelRun& r) { r.start = ingest::LogTime{5}, r.end = ingest::LogTime{4}; }).kind, Kind::usage);
}

TEST(TunnelRefusal, RunsThatScatterMoreThanStatedWidenTheVehicle) {
  // Winds wrong by 8 % either way, stated to 1 %.
  std::vector<TunnelRun> runs;
  int sign = 1;
  for (const double speed : {2.0, 4.0, 6.0, 8.0}) {
    MadeRun off;
    off.stated = speed;
    off.flown = speed * (1 + 0.08 * sign);
    sign = -sign;
    runs.push_back(fly(off));
    runs.back().wind_speed_sd = 0.01 * speed;
  }
  const auto found = calibrate_tunnel(runs, published_settings());
  ASSERT_TRUE(found) << to_string(found.error());
  EXPECT_GT(found->spread, 4);
  ASSERT_FALSE(found->notes.empty());
  EXPECT_THAT(found->notes[0].what, HasSubstr("scatter"));
  EXPECT_GT(drag_at(found->vehicle, 5).sd / 0.277, 0.03);
}

}  // namespace
}  // namespace quadsonde
