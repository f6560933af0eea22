#include "export/pipeline/heading.h"

#include <cmath>

#include "export/pipeline/run_log.h"
#include "ingest/flight/rotation.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::product {
namespace {

/// Toulouse, 2025-06-15: World Magnetic Model 2025 says 1.8 degrees east.
ingest::Flight toulouse() { return support::flown().flight; }

double heading_deg(const ingest::Flight& flight) { return ingest::heading(flight.attitude.value[100]) * 180 / M_PI; }

InputSettings magnetic() {
  InputSettings settings;
  settings.heading = "magnetic";
  return settings;
}

TEST(CorrectHeading, AddsTheDeclinationOnceAndSaysIt) {
  auto flight = toulouse();
  const double before = heading_deg(flight);
  const auto facts = correct_heading(flight, "csv", false, magnetic(), MagneticNorth::open(), "a.csv");
  EXPECT_NEAR(facts.added_deg, 1.8, 0.15);
  EXPECT_NEAR(std::remainder(heading_deg(flight) - before - facts.added_deg, 360), 0, 1e-9);
  EXPECT_GT(facts.sd_deg, 0.2);
  EXPECT_LT(facts.sd_deg, 1);
  EXPECT_NE(facts.words.find("World Magnetic Model 2025, valid 2025 to 2030"), std::string::npos) << facts.words;
  EXPECT_TRUE(flight.problems.empty());
}

TEST(CorrectHeading, BelievesTheMapOfATable) {
  auto flight = toulouse();
  EXPECT_NEAR(correct_heading(flight, "csv", true, {}, MagneticNorth::open(), "a.csv").added_deg, 1.8, 0.15);
  auto untouched = toulouse();
  EXPECT_EQ(correct_heading(untouched, "csv", false, {}, MagneticNorth::open(), "a.csv").added_deg, 0);
}

TEST(CorrectHeading, NeverAddsItToWhatAnAutopilotHasTurnedAlready) {
  for (const auto* autopilot : {"PX4", "ArduPilot"}) {
    auto flight = toulouse();
    flight.vehicle.autopilot = autopilot;
    const double before = heading_deg(flight);
    const auto facts = correct_heading(flight, "ulog", false, magnetic(), MagneticNorth::open(), "a.ulg");
    EXPECT_EQ(facts.added_deg, 0);
    EXPECT_EQ(heading_deg(flight), before);
    ASSERT_EQ(flight.problems.size(), 1u);
    EXPECT_NE(flight.problems[0].what.find("not added twice"), std::string::npos);
  }
}

TEST(CorrectHeading, WidensTheUncertaintyWhereTheDeclinationIsNotKnown) {
  auto flight = toulouse();
  const auto without_models =
      correct_heading(flight, "csv", false, magnetic(), MagneticNorth::open("/nonexistent"), "a.csv");
  EXPECT_EQ(without_models.added_deg, 0);
  EXPECT_EQ(without_models.sd_deg, unknown_declination_deg);
  ASSERT_EQ(flight.problems.size(), 1u);
  EXPECT_NE(flight.problems[0].what.find("no magnetic model"), std::string::npos);
  auto nowhere = toulouse();
  nowhere.position = {}, nowhere.origin.reset();
  EXPECT_EQ(correct_heading(nowhere, "csv", false, magnetic(), MagneticNorth::open(), "a.csv").sd_deg,
            unknown_declination_deg);
}

TEST(CorrectHeading, SaysThatALogHasNoDate) {
  auto flight = toulouse();
  flight.clock = {};
  const auto facts = correct_heading(flight, "csv", false, magnetic(), MagneticNorth::open(), "a.csv");
  EXPECT_GT(facts.sd_deg, 0.5);
  ASSERT_EQ(flight.problems.size(), 1u);
  EXPECT_NE(flight.problems[0].hint.find("--start-utc"), std::string::npos);
}

TEST(CorrectHeading, TurnsByTheUsersOffset) {
  auto flight = toulouse();
  const double before = heading_deg(flight);
  InputSettings settings;
  settings.heading_offset_deg = -7;
  EXPECT_EQ(correct_heading(flight, "ulog", false, settings, {}, "a.ulg").added_deg, -7);
  EXPECT_NEAR(std::remainder(heading_deg(flight) - before, 360), -7, 1e-9);
}

// A vehicle file that was flown to 8 m/s says little of 14: the kappa that it leaves open counts with the airspeed.
TEST(AirspeedRange, BeyondItTheWindIsFlaggedAndItsUncertaintyGrows) {
  const support::TemporaryFolder folder;
  auto vehicle = ingest::published_vehicle();
  vehicle.method = "tunnel";
  vehicle.airspeed_range_m_s = {0, 8};
  vehicle.covariance(ingest::p_linear, ingest::p_linear) = std::pow(0.02 * vehicle.drag.linear, 2);
  vehicle.covariance(ingest::p_quadratic, ingest::p_quadratic) = std::pow(0.003, 2);
  support::write_text(folder / "vehicle.toml", ingest::to_toml(vehicle));
  double relative_sd[2];
  for (const int fast : {0, 1}) {
    auto toml = std::string(support::ascent_toml());
    toml.replace(toml.find("speed_m_s = 5"), 13, fast ? "speed_m_s = 14" : "speed_m_s = 5");
    const auto log = folder / (fast ? "fast.csv" : "slow.csv");
    support::write_text(log, flight_csv(support::flown(toml).flight));
    RunRequest request;
    request.log = log;
    const auto result = run_log(request);
    ASSERT_TRUE(result) << ingest::to_string(result.error());
    double sum = 0, n = 0, flagged = 0;
    for (const auto& point : result->flights[0].answer.series.points)
      if (const auto* wind = std::get_if<estimator::WindEstimate>(&point.wind)) {
        sum += estimator::speed_sd(*wind) / wind->v_NA_N.norm(), n += 1;
        flagged += point.reasons.has(estimator::Reason::outside_airspeed_range);
      }
    relative_sd[fast] = sum / n;
    EXPECT_GT(fast ? flagged : n - flagged, 0.9 * n);
  }
  EXPECT_GT(relative_sd[1], 1.5 * relative_sd[0]) << "kappa's 0.003 1/m are 16 % of the drag at 14 m/s, 6 % at 5";
}

}  // namespace
}  // namespace quadsonde::product
