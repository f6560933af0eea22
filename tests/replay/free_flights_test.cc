// What recorded flights tell of their drag: a table, and what must hold in it.
#include "export/pipeline/free_flights.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/data.h"

namespace quadsonde::replay {
namespace {

estimator::FreeFlightCalibration calibrated(const std::string& file, const std::string& columns = "") {
  product::FreeFlightsRequest request;
  request.logs = {support::data_file(file)};
  if (!columns.empty()) request.input.columns = columns;
  const auto found = product::run_free_flights(request);
  if (!found) {
    ADD_FAILURE() << file << ": " << found.error().what;
    return {};
  }
  const auto& c = found->calibration;
  fmt::print("{:<64} {}\n", file,
             c.refused ? *c.refused
                       : fmt::format("{:.3f} 1/s +- {:.0f} % at {:.1f} m/s, latency {:.2f} s", c.seen->drag,
                                     100 * c.seen->rel_sd, c.airspeed, c.vehicle.latency_s));
  // Every log ends in a vehicle with an interval, or in a no with its reason and the flight to fly next.
  if (c.refused) {
    EXPECT_FALSE(c.refused->empty());
    EXPECT_FALSE(c.identifiability.advice.empty());
  } else {
    EXPECT_GT(c.vehicle.parameter_sd(ingest::p_linear), 0);
  }
  return c;
}

bool holds(const estimator::FreeFlightCalibration& c, double drag) {
  return c.seen && std::abs(std::log(drag / c.seen->drag)) < 1.96 * c.seen->rel_sd;
}

TEST(RecordedFreeFlights, ASquareOfHalfAMinuteTellsTheDragWithAWideIntervalAndNoTrim) {
  QUADSONDE_NEEDS_DATA("flights/epfl_wemuav");
  const auto c = calibrated("flights/epfl_wemuav/derived_FLY139__20210420_093827__Square.csv.gz");
  ASSERT_FALSE(c.refused) << *c.refused;
  // The hover of the same battery agrees with its mast for 0.26 to 0.28.
  EXPECT_TRUE(holds(c, 0.27)) << c.seen->drag;
  // Its trim made the next flight worse (0.63 for 0.42 m/s in the baseline).
  EXPECT_FALSE(c.trim_determined);
}

TEST(RecordedFreeFlights, ThirteenMinutesOfSurveyLinesHoldTheRightDragAndKeepTheTrim) {
  QUADSONDE_NEEDS_DATA("flights/sph_skyhub_wind");
  const auto c = calibrated("flights/sph_skyhub_wind/wind-trajectory1.csv.gz", QUADSONDE_MAPS "/skyhub_exchanged.toml");
  ASSERT_FALSE(c.refused) << *c.refused;
  EXPECT_TRUE(holds(c, 0.15)) << c.seen->drag;
  EXPECT_TRUE(c.trim_determined);
  // Least squares on the closed loop gave 0.184 to 0.191.
  for (const auto& a : c.assumed) EXPECT_LT(a.drag, 0.18) << a.noise.words();
}

TEST(RecordedFreeFlights, TenMetresPerSecondAtTwentySixMetresAreNotClaimed) {
  QUADSONDE_NEEDS_DATA("flights/dronedeploy_dji");
  for (const char* name : {"iphone-ios-11-3-matrice", "iphone-ios11-inspire", "pixel2-inspire2"})
    EXPECT_TRUE(calibrated(fmt::format("flights/dronedeploy_dji/{}.log.gz", name)).refused) << name;
}

}  // namespace
}  // namespace quadsonde::replay
