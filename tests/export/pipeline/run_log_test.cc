#include "export/pipeline/run_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "export/csv/tables.h"
#include "ingest/flight/rotation.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

using support::read_text;
using support::write_text;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// A folder with a flown log, its truth beside it.
struct Flown {
  support::TemporaryFolder folder;
  ingest::Simulation simulation = support::flown();
  Flown() {
    write_text(folder / "ascent.csv", flight_csv(simulation.flight));
    write_text(folder / "truth.csv", truth_csv(simulation.truth));
  }
  RunRequest request() const {
    RunRequest r;
    r.log = folder / "ascent.csv";
    r.folder = folder / "out";
    return r;
  }
};

TEST(RunLog, WritesEveryProductOfTheFolder) {
  const Flown flown;
  auto request = flown.request();
  request.references = {flown.folder / "truth.csv"};
  const auto result = run_log(request);
  ASSERT_TRUE(result) << ingest::to_string(result.error());
  for (const auto* name : {"flight.mcap", "foxglove_layout.json", "wind.csv", "wind.nc", "wind.svg", "state.svg",
                           "profile.csv", "profile.nc", "profile.svg", "report.html", "compare.json", "run.json"})
    EXPECT_TRUE(fs::exists(flown.folder / "out/ascent" / name)) << name;
  const auto run = nlohmann::json::parse(read_text(flown.folder / "out/ascent/run.json"));
  EXPECT_EQ(run["source"]["file"], "ascent.csv");
  EXPECT_EQ(run["files"].size(), 12u);
  EXPECT_THAT(read_text(flown.folder / "out/ascent/wind.svg"), HasSubstr("true wind"));
  EXPECT_THAT(read_text(flown.folder / "out/ascent/profile.svg"), HasSubstr("true wind"));
}

TEST(RunLog, FindsTheWindThatWasThere) {
  const Flown flown;
  RunRequest request = flown.request();
  request.folder.reset();
  request.references = {flown.folder / "truth.csv"};
  // The drag that was flown, told in a file beside the log.
  write_text(flown.folder / "vehicle.toml", ingest::to_toml(flown.simulation.vehicle));
  const auto result = run_log(request);
  ASSERT_TRUE(result) << ingest::to_string(result.error());
  const auto& scores = result->flights.at(0).answer.comparison->references.at(0).whole();
  EXPECT_GT(scores.n, 500u);
  EXPECT_LT(scores.rmsve, 0.6)
      << "an 80 s flight with a turning nose; gates with tighter limits fly longer";
  EXPECT_GT(*scores.inside95, 0.85);
}

/// A square with a turning nose, which shows what is wrong with its telemetry; roll and pitch can be exchanged.
ingest::Flight square(bool exchanged) {
  auto flight = support::flown(R"(
seed = 5
start_height_m = 20
[wind]
speed_m_s = 3
from_deg = 290
[[path]]
kind = "square"
speed_m_s = 3
duration_s = 200
yaw_rate_deg_s = 17
)").flight;
  if (exchanged)
    for (auto& q : flight.attitude.value) {
      const auto angles = ingest::euler_from_q_NB(q);
      q = ingest::q_NB_from_euler({angles.pitch, angles.roll, angles.yaw});
    }
  return flight;
}

TEST(RunLog, RatesEveryNumberOfAnInconsistentLogBadAndSaysWhy) {
  const support::TemporaryFolder folder;
  write_text(folder / "square.csv", flight_csv(square(true)));
  RunRequest request;
  request.log = folder / "square.csv";
  const auto result = run_log(request);
  ASSERT_TRUE(result) << ingest::to_string(result.error());
  const auto& answer = result->flights.at(0).answer;
  ASSERT_TRUE(answer.check);
  EXPECT_EQ(answer.check->verdict, ingest::Verdict::inconsistent);
  EXPECT_TRUE(result->with_doubts());
  for (const auto& point : answer.series.points)
    EXPECT_THAT(point.quality, testing::AnyOf(estimator::Quality::bad, estimator::Quality::none));
  for (const auto& leg : answer.profile->legs)
    for (const auto& bin : leg.bins)
      EXPECT_THAT(bin.quality, testing::AnyOf(estimator::Quality::bad, estimator::Quality::none));
  const bool told = std::any_of(answer.source.problems.begin(), answer.source.problems.end(),
                                [](const auto& p) { return p.kind == ingest::Kind::inconsistent; });
  EXPECT_TRUE(told);
}

TEST(RunLog, BelievesAConsistentLogAndLeavesTheCheckOutOnRequest) {
  const support::TemporaryFolder folder;
  write_text(folder / "square.csv", flight_csv(square(false)));
  RunRequest request;
  request.log = folder / "square.csv";
  const auto checked = run_log(request);
  ASSERT_TRUE(checked) << ingest::to_string(checked.error());
  ASSERT_TRUE(checked->flights.at(0).answer.check);
  EXPECT_NE(checked->flights.at(0).answer.check->verdict, ingest::Verdict::inconsistent);
  request.settings.trust.check = false;
  EXPECT_FALSE(run_log(request)->flights.at(0).answer.check);
}

TEST(RunLog, GivesTheSameBytesEveryTime) {
  const Flown flown;
  auto first = flown.request(), second = flown.request();
  second.folder = flown.folder / "again";
  ASSERT_TRUE(run_log(first));
  ASSERT_TRUE(run_log(second));
  for (const auto& entry : fs::directory_iterator(flown.folder / "out/ascent"))
    EXPECT_EQ(read_text(entry.path()), read_text(flown.folder / "again/ascent" / entry.path().filename().string()))
        << entry.path();
}

TEST(RunLog, OfItsOwnMcapGivesTheSameWind) {
  const Flown flown;
  ASSERT_TRUE(run_log(flown.request()));
  auto again = flown.request();
  again.log = flown.folder / "out/ascent/flight.mcap";
  again.folder = flown.folder / "again";
  const auto result = run_log(again);
  ASSERT_TRUE(result) << ingest::to_string(result.error());
  EXPECT_EQ(read_text(flown.folder / "again/flight/wind.csv"), read_text(flown.folder / "out/ascent/wind.csv"));
}

TEST(RunLog, RefusesToOverwriteBeforeItComputesAndObeysWhenAllowed) {
  const Flown flown;
  auto request = flown.request();
  ASSERT_TRUE(run_log(request));
  const auto refused = run_log(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
  request.overwrite = true;
  EXPECT_TRUE(run_log(request));
}

TEST(RunLog, LeavesNoProductOfAnOlderRunThatWouldContradictTheNewOne) {
  const Flown flown;
  auto request = flown.request();
  request.references = {flown.folder / "truth.csv"};
  ASSERT_TRUE(run_log(request));
  write_text(flown.folder / "out/ascent/notes.txt", "mine");
  request.references.clear();
  request.overwrite = true;
  ASSERT_TRUE(run_log(request));
  EXPECT_FALSE(fs::exists(flown.folder / "out/ascent/compare.json"));
  EXPECT_TRUE(fs::exists(flown.folder / "out/ascent/notes.txt")) << "other people's files stay";
}

TEST(RunLog, StoppedLeavesNothingBehind) {
  const Flown flown;
  const std::atomic<bool> stop{true};
  const auto result = run_log(flown.request(), {{}, &stop, nullptr});
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().what, HasSubstr("stopped"));
  EXPECT_FALSE(fs::exists(flown.folder / "out"));
}

TEST(RunLog, FailsOnABadReferenceBeforeItReadsTheLog) {
  const Flown flown;
  auto request = flown.request();
  write_text(flown.folder / "bad.csv", "time_s\n1\n");
  request.references = {flown.folder / "bad.csv"};
  const auto result = run_log(request);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().where.topic, "height_agl_m");
}

TEST(ChooseVehicle, TakesTheFileBesideTheLogElseTheClassPrior) {
  const support::TemporaryFolder folder;
  auto prior = choose_vehicle({}, folder / "a.ulg");
  ASSERT_TRUE(prior);
  EXPECT_TRUE(prior->vehicle.is_prior());
  auto vehicle = ingest::published_vehicle();
  vehicle.id = "quad-07";
  write_text(folder / "vehicle.toml", ingest::to_toml(vehicle));
  const auto beside = choose_vehicle({}, folder / "a.ulg");
  ASSERT_TRUE(beside);
  EXPECT_EQ(beside->vehicle.id, "quad-07");
  const auto asked = choose_vehicle({"class:generic", {}}, folder / "a.ulg");
  ASSERT_TRUE(asked);
  EXPECT_TRUE(asked->vehicle.is_prior());
  EXPECT_FALSE(choose_vehicle({"class:balloon", {}}, folder / "a.ulg"));
  EXPECT_FALSE(choose_vehicle({(folder / "none.toml").string(), {}}, folder / "a.ulg"));
}

// CLI.md: the drag is scaled to --mass-kg from the file's mass_kg; delta goes with the root of the mass ratio.
TEST(ChooseVehicle, ScalesTheDragToTheMassFlownAndRefusesWithoutAMassToScaleFrom) {
  const support::TemporaryFolder folder;
  auto vehicle = ingest::published_vehicle();
  vehicle.method = "tunnel";
  write_text(folder / "v.toml", ingest::to_toml(vehicle));
  const auto heavy = choose_vehicle({(folder / "v.toml").string(), 4 * *vehicle.mass_kg}, "a.ulg");
  ASSERT_TRUE(heavy);
  EXPECT_NEAR(heavy->vehicle.drag.linear, vehicle.drag.linear / 2, 1e-12);
  vehicle.mass_kg.reset();
  write_text(folder / "v.toml", ingest::to_toml(vehicle));
  const auto refused = choose_vehicle({(folder / "v.toml").string(), 1.0}, "a.ulg");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
  EXPECT_EQ(choose_vehicle({"auto", 1.0}, folder / "a.ulg")->notes.size(), 1u)
      << "a prior has no mass: said, not refused";
}

TEST(ChooseFlights, TakesTheLongestAndSaysSoOrWhatWasAskedFor) {
  LoadedLog log;
  log.path = "a.ulg";
  for (int i = 1; i <= 3; ++i) {
    FlightPart part;
    part.number = i;
    part.segment = {ingest::LogTime{0}, ingest::LogTime{(i == 2 ? 100 : 50) * 1'000'000'000LL}};
    log.parts.push_back(part);
  }
  std::vector<ingest::Problem> notes;
  EXPECT_EQ(choose_flights(log, "", false, notes)->at(0).number, 2);
  EXPECT_EQ(notes.size(), 1u);
  EXPECT_EQ(choose_flights(log, "", true, notes)->size(), 3u);
  EXPECT_EQ(choose_flights(log, "all", false, notes)->size(), 3u);
  EXPECT_EQ(choose_flights(log, "3", false, notes)->at(0).number, 3);
  EXPECT_EQ(notes.size(), 1u) << "only a choice that nobody made is said";
  for (const auto* bad : {"4", "0", "x", "1x"}) EXPECT_FALSE(choose_flights(log, bad, false, notes)) << bad;
}

TEST(FlightFolderName, IsTheStemWithANumberWhereThereAreSeveral) {
  EXPECT_EQ(flight_folder_name("/a/b.ulg", 1, 1), "b");
  EXPECT_EQ(flight_folder_name("/a/b.csv.gz", 2, 3), "b-2");
}

}  // namespace
}  // namespace quadsonde::product
