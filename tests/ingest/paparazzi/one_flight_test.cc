// One flight in three autopilots' formats is one Flight, within the step of each format.
#include "ingest/dataflash/flight_from_dataflash.h"
#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "tests/ingest/dataflash/esc_flight_csv.h"

namespace quadsonde::ingest {
namespace {

std::vector<std::uint8_t> file(const std::string& name) {
  return support::read_bytes(support::data_file("logs/derived/" + name));
}

class OneFlight : public ::testing::Test {
 protected:
  void SetUp() override {
    QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.bin");
    dataflash = read_dataflash(file("esc_flight.bin"), "a").value().flights.at(0);
    mavlink = read_mavlink(file("esc_flight_v2.tlog"), "b").value().flights.at(0);
    paparazzi = read_paparazzi(file("esc_flight.data"), file("esc_flight.log"), "c").value().flights.at(0);
  }
  Flight dataflash, mavlink, paparazzi;
};

TEST_F(OneFlight, HasTheSameReceiverVelocities) {
  ASSERT_EQ(mavlink.velocity.size(), dataflash.velocity.size());
  ASSERT_EQ(paparazzi.velocity.size(), dataflash.velocity.size());
  for (std::size_t i = 0; i < dataflash.velocity.size(); ++i) {
    const auto& v = dataflash.velocity.value[i];
    // 1 cm/s and 0.01 deg at up to 8 m/s; the down part is the filter's there.
    EXPECT_LT((mavlink.velocity.value[i] - v).head<2>().norm(), 0.011);
    // 1 cm/s on each Earth-fixed axis (LOGS.md section 8: within 7 mm/s).
    EXPECT_LT((paparazzi.velocity.value[i] - v).cwiseAbs().maxCoeff(), 0.01);
    EXPECT_NEAR(mavlink.velocity.sd.at(i), dataflash.velocity.sd.at(i), 0.006);
    EXPECT_NEAR(paparazzi.velocity.sd.at(i), dataflash.velocity.sd.at(i), 0.011);
  }
}

TEST_F(OneFlight, HasTheSamePlacesHeightsAndPressures) {
  for (const auto* other : {&mavlink, &paparazzi}) {
    ASSERT_EQ(other->position.size(), dataflash.position.size());
    ASSERT_EQ(other->barometer.size(), dataflash.barometer.size());
    for (std::size_t i = 0; i < dataflash.position.size(); ++i) {
      EXPECT_NEAR(other->position.value[i].lat_deg, dataflash.position.value[i].lat_deg, 1e-9);
      EXPECT_NEAR(other->position.value[i].lon_deg, dataflash.position.value[i].lon_deg, 1e-9);
      EXPECT_NEAR(other->height_msl.value[i].m, dataflash.height_msl.value[i].m, 0.011);
      EXPECT_NEAR(other->height_ellipsoid.value[i].m, dataflash.height_ellipsoid.value[i].m, 0.011);
    }
    for (std::size_t i = 0; i < dataflash.barometer.size(); ++i)
      EXPECT_NEAR(*other->barometer.value[i].pressure_pa, *dataflash.barometer.value[i].pressure_pa, 0.06);
  }
}

TEST_F(OneFlight, HasTheSameAttitudeAtTheSameUtc) {
  for (const auto* other : {&mavlink, &paparazzi}) {
    ASSERT_EQ(other->attitude.size(), dataflash.attitude.size());
    for (std::size_t i = 0; i < dataflash.attitude.size(); ++i) {
      EXPECT_LT(support::angle_between(other->attitude.value[i], dataflash.attitude.value[i]), 0.012);
      const auto utc = *dataflash.clock.to_utc(dataflash.attitude.time[i]);
      EXPECT_LT(std::abs(to_seconds(*other->clock.to_utc(other->attitude.time[i]) - utc)), 0.02);
    }
  }
}

TEST_F(OneFlight, HasTheSameWindOfTheAutopilot) {
  for (const auto* other : {&mavlink, &paparazzi}) {
    ASSERT_EQ(other->autopilot_wind.size(), dataflash.autopilot_wind.size());
    for (std::size_t i = 0; i < dataflash.autopilot_wind.size(); ++i)
      EXPECT_LT(
          (other->autopilot_wind.value[i].v_NA_N - dataflash.autopilot_wind.value[i].v_NA_N).cwiseAbs().maxCoeff(),
          0.011);
  }
}

}  // namespace
}  // namespace quadsonde::ingest
