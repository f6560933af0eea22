#include "export/pipeline/inspect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

using testing::HasSubstr;
using testing::Not;

LogFacts facts_of(const std::string& path_toml) {
  const support::TemporaryFolder folder;
  const std::string head = "start_height_m = 10\nseed = 5\n[wind]\nspeed_m_s = 3\nfrom_deg = 290\n";
  support::write_text(folder / "log.csv", flight_csv(support::flown(head + path_toml).flight));
  const auto log = load_log(folder / "log.csv", {});
  if (!log) throw std::runtime_error(ingest::to_string(log.error()));
  return inspect(*log);
}

const char* hover = "[[path]]\nkind = \"hover\"\nduration_s = 120\n";
const char* square = "[[path]]\nkind = \"square\"\nduration_s = 200\nspeed_m_s = 3\nyaw_rate_deg_s = 17\n";

// Design notes, section 5: X is 3.1 for a square with its own yaw, .15 (sensor noise) for a hover.
TEST(Inspect, TellsAHoverFromAFlightThatCanCalibrate) {
  const auto still = facts_of(hover), moving = facts_of(square);
  ASSERT_EQ(still.flights.size(), 1u);
  ASSERT_EQ(moving.flights.size(), 1u);
  EXPECT_LT(still.flights[0].manoeuvre.excitation, 0.5);
  EXPECT_FALSE(still.flights[0].can_calibrate);
  EXPECT_FALSE(still.flights[0].trim_can_be_measured);
  EXPECT_NEAR(moving.flights[0].manoeuvre.excitation, 3.1, 0.4);
  EXPECT_TRUE(moving.flights[0].can_calibrate);
  EXPECT_GT(moving.flights[0].manoeuvre.heading_index, 0.9);
  EXPECT_NEAR(moving.flights[0].manoeuvre.turned_deg, 17 * 200, 200);
}

TEST(Inspect, NamesTheManoeuvreThatWouldHelp) {
  const auto text = info_text(facts_of(hover));
  EXPECT_THAT(text, HasSubstr("Turn the nose"));
  EXPECT_THAT(text, HasSubstr("fly a square"));
}

TEST(Inspect, CountsAscentsAndDescentsAndHeights) {
  const support::TemporaryFolder folder;
  support::write_text(folder / "log.csv", flight_csv(support::flown().flight));
  const auto log = load_log(folder / "log.csv", {});
  ASSERT_TRUE(log);
  const auto facts = inspect(*log);
  ASSERT_EQ(facts.flights.size(), 1u);
  const auto& m = facts.flights[0].manoeuvre;
  EXPECT_EQ(m.ascents, 1);
  EXPECT_EQ(m.descents, 1);
  EXPECT_TRUE(m.above_takeoff);
  EXPECT_NEAR(*m.highest, 42, 2);
  EXPECT_TRUE(facts.flights[0].profile_possible);
}

TEST(Inspect, GivesRatesAndGapsOfStreams) {
  ingest::Flight flight;
  for (int i = 0; i < 600; ++i)
    if (i < 100 || i > 150) {
      const ingest::LogTime t{i * 100'000'000LL};
      flight.attitude.push(t, Eigen::Quaterniond(Eigen::AngleAxisd(0.02 * std::sin(i), Eigen::Vector3d::UnitX())));
      flight.velocity.push(t, {2, 0, 0});
    }
  LoadedLog log;
  log.path = "a.csv";
  log.boots = {std::make_shared<const ingest::Flight>(flight)};
  const auto facts = inspect(log);
  ASSERT_EQ(facts.boots[0].streams.size(), 2u);
  EXPECT_NEAR(*facts.boots[0].streams[0].rate_hz, 10, 1e-9);
  EXPECT_NEAR(*facts.boots[0].streams[0].longest_gap_s, 5.2, 1e-9);
  EXPECT_EQ(facts.boots[0].streams[0].gaps, 1u);
}

TEST(Inspect, TellsJitterAndLatencyAndTheAutopilotsOwnWind) {
  ingest::Flight flight;
  for (int i = 0; i < 300; ++i) {
    // Every third interval is 20 ms long, the others 110 and 170 ms: a median of 110, and 60 from it in the median.
    const ingest::LogTime t{i / 3 * 300'000'000LL + (i % 3 == 1 ? 110'000'000 : i % 3 == 2 ? 280'000'000 : 0)};
    flight.attitude.push(t, Eigen::Quaterniond::Identity());
    flight.velocity.push(t, {2, 0, 0});
    flight.autopilot_wind.push(t, {{-0.6, -1.7}, {}});
  }
  flight.attitude.latency = ingest::Latency{0.004, false};
  flight.velocity.latency = ingest::Latency{0.12, true};
  LoadedLog log;
  log.path = "a.ulg";
  log.content.messages = 900, log.content.salvaged = 7;
  log.boots = {std::make_shared<const ingest::Flight>(flight)};
  const auto facts = inspect(log);
  ASSERT_EQ(facts.boots[0].streams.size(), 3u);
  EXPECT_NEAR(*facts.boots[0].streams[0].jitter_s, 1.4826 * 0.06, 1e-6);
  const auto text = info_text(facts);
  EXPECT_THAT(text, HasSubstr(">0.120"));
  EXPECT_THAT(text, HasSubstr("0.004"));
  EXPECT_THAT(text, HasSubstr("1.8 m/s from 71 deg")) << "toward the west-southwest is from the east-northeast";
  EXPECT_THAT(text, testing::ContainsRegex("messages +900 in"));
  EXPECT_THAT(text, testing::ContainsRegex("salvaged +7 of them"));
  const auto json = nlohmann::json::parse(info_json(facts));
  EXPECT_NEAR(json["boots"][0]["streams"][1]["latency_s"].get<double>(), 0.12, 1e-9);
  EXPECT_EQ(json["boots"][0]["streams"][1]["latency_is_lower_bound"], true);
  EXPECT_TRUE(json["boots"][0]["streams"][2]["latency_s"].is_null()) << "unknown is not zero";
  EXPECT_NEAR(json["boots"][0]["autopilot_wind_east_m_s"].get<double>(), -1.7, 1e-9);
}

// The map stands in the answer as it can be saved, changed and given back.
TEST(Inspect, PrintsTheMapOfATableSoThatTheNextOneCanBeWritten) {
  const support::TemporaryFolder folder;
  support::write_text(folder / "log.csv", flight_csv(support::flown().flight));
  const auto first = load_log(folder / "log.csv", {});
  ASSERT_TRUE(first);
  const auto text = info_text(inspect(*first));
  const auto begin = text.find("--columns MAP.toml");
  ASSERT_NE(begin, std::string::npos);
  support::write_text(folder / "MAP.toml", text.substr(text.find("\n\n", begin) + 2));
  InputSettings settings;
  settings.columns = (folder / "MAP.toml").string();
  const auto again = load_log(folder / "log.csv", settings);
  ASSERT_TRUE(again) << ingest::to_string(again.error());
  EXPECT_EQ(again->boots.at(0)->velocity.value, first->boots.at(0)->velocity.value);
  EXPECT_EQ(again->boots.at(0)->attitude.time, first->boots.at(0)->attitude.time);
}

TEST(Inspect, ShowsTheTopicsOfALogWithoutAFlight) {
  LoadedLog log;
  log.path = "other.mcap";
  log.content.format = "mcap";
  log.content.messages = 12;
  log.content.topics = {{"/camera", 12}};
  log.nothing = ingest::Problem{ingest::Kind::missing, "there is no flight", {}, "do something"};
  const auto facts = inspect(log);
  EXPECT_THAT(info_text(facts), HasSubstr("/camera"));
  EXPECT_THAT(info_text(facts), HasSubstr("there is no flight"));
  const auto json = nlohmann::json::parse(info_json(facts));
  EXPECT_EQ(json["format"], "mcap");
  EXPECT_EQ(json["messages"], 12);
  EXPECT_EQ(json["salvaged"], 0);
  EXPECT_EQ(json["can_give_wind"], false);
  EXPECT_EQ(json["topics"][0]["messages"], 12);
}

TEST(Inspect, FitsIn80Columns) {
  std::istringstream lines(info_text(facts_of(square)));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

// A hover cut out of a longer log (the mast flights are such) shows no take-off; it is a flight all the same.
TEST(LoadLog, TakesAHoverWithoutTakeoffAsAFlightAndSaysSo) {
  const support::TemporaryFolder folder;
  auto flight =
      support::flown(std::string("start_height_m = 10\n[wind]\nspeed_m_s = 3\nturbulence_sd_m_s = 0.1\n") + hover)
          .flight;
  for (auto& v : flight.velocity.value) v *= 0.2;  // slower than anything that tells flight from standing
  flight.height_ground = {}, flight.local_position = {};
  for (auto& h : flight.height_msl.value) h.m = 160;
  support::write_text(folder / "log.csv", flight_csv(flight));
  const auto log = load_log(folder / "log.csv", {});
  ASSERT_TRUE(log);
  ASSERT_EQ(log->parts.size(), 1u);
  EXPECT_THAT(ingest::to_string(log->parts[0].problems.back()), HasSubstr("whole log is taken as one flight"));
  EXPECT_FALSE(log->parts[0].takeoff);
}

// epfl_wemuav Vertical3ms begins and ends in the air, its last half second at its lowest height.
TEST(LoadLog, CallsAMomentAtTheLowestHeightNoLanding) {
  const support::TemporaryFolder folder;
  auto flight = support::flown().flight;
  const auto segment = ingest::airborne_segments(flight).at(0);
  flight = ingest::cut(flight, segment.from - ingest::seconds(1), segment.to + ingest::seconds(1));
  support::write_text(folder / "log.csv", flight_csv(flight));
  const auto log = load_log(folder / "log.csv", {});
  ASSERT_TRUE(log);
  ASSERT_EQ(log->parts.size(), 1u);
  EXPECT_TRUE(log->parts[0].segment.starts_in_air);
  EXPECT_TRUE(log->parts[0].segment.ends_in_air);
  EXPECT_FALSE(log->parts[0].takeoff);
}

TEST(LoadLog, MakesHeightsAboveTakeoffOfTheLocalFrameWhereThereIsNoOther) {
  const auto flown = support::flown();
  auto boot = std::make_shared<ingest::Flight>();
  boot->attitude = flown.flight.attitude, boot->velocity = flown.flight.velocity;
  for (std::size_t i = 0; i < flown.flight.height_msl.size(); ++i)
    boot->local_position.push(flown.flight.height_msl.time[i], {0, 0, -(flown.flight.height_msl.value[i].m - 100)});
  FlightPart part;
  part.boot = boot;
  const auto segments = ingest::airborne_segments(*boot);
  ASSERT_EQ(segments.size(), 1u);
  part.segment = segments[0];
  const auto flight = part.airborne();
  ASSERT_FALSE(flight.height_ground.empty());
  double highest = 0;
  for (const auto& h : flight.height_ground.value) highest = std::max(highest, h.m);
  EXPECT_NEAR(highest, 42, 2.5) << "height noise .3 m at both ends";
  part.segment.starts_in_air = part.segment.ends_in_air = true;
  EXPECT_TRUE(part.airborne().height_ground.empty()) << "without take-off or landing nobody knows where the ground is";
}

TEST(LoadLog, FindsNoFlightOnTheGround) {
  const support::TemporaryFolder folder;
  auto flight = support::flown(std::string("start_height_m = 10\n") + hover).flight;
  for (auto& v : flight.velocity.value) v.setZero();
  for (auto& q : flight.attitude.value) q.setIdentity();
  flight.height_ground = {}, flight.local_position = {};
  for (auto& h : flight.height_msl.value) h.m = 150;
  support::write_text(folder / "log.csv", flight_csv(flight));
  const auto log = load_log(folder / "log.csv", {});
  ASSERT_TRUE(log);
  ASSERT_TRUE(log->nothing);
  EXPECT_THAT(ingest::to_string(*log->nothing), HasSubstr("never leaves the ground"));
}

}  // namespace
}  // namespace quadsonde::product
