#include "export/csv/flight_csv.h"

#include <gtest/gtest.h>

#include "ingest/csv/flight_from_csv.h"
#include "ingest/flight/rotation.h"

namespace quadsonde::product {
namespace {

using ingest::LogTime;

ingest::Flight small_flight() {
  ingest::Flight f;
  f.clock.utc_minus_log = ingest::seconds(1.7e9);
  for (int i = 0; i < 20; ++i) {
    const LogTime t{i * 100'000'001};
    f.attitude.push(t, ingest::q_NB_from_euler({0.01 * i, -0.02, 0.1 * i}));
    f.velocity.push(t, {0.1 * i, -0.5, 0.25});
    if (i % 2) f.position.push(t, {43.5 + i * 1e-7, 1.25});
    if (i % 2) f.height_msl.push(t, ingest::MslHeight{150.0 + i});
    if (i % 5 == 0) f.rotors.push(t + ingest::Duration(7), {1000.5f, 2000.25f, 3000.0f, 4000.0f});
  }
  return f;
}

TEST(FlightCsv, IsReadBackByTheTableReaderSampleForSample) {
  const auto flight = small_flight();
  const auto text = flight_csv(flight);
  const auto read = ingest::read_csv(ingest::as_bytes(text), "flight.csv");
  ASSERT_TRUE(read) << ingest::to_string(read.error());
  ASSERT_EQ(read->flights.size(), 1u);
  const auto& back = read->flights[0];
  EXPECT_EQ(back.attitude.time, flight.attitude.time);
  EXPECT_EQ(back.velocity.time, flight.velocity.time);
  EXPECT_EQ(back.velocity.value, flight.velocity.value);
  EXPECT_EQ(back.position.time, flight.position.time);
  EXPECT_EQ(back.height_msl.value, flight.height_msl.value);
  EXPECT_EQ(back.rotors.value, flight.rotors.value);
  EXPECT_EQ(back.clock.utc_minus_log, flight.clock.utc_minus_log);
  for (std::size_t i = 0; i < flight.attitude.size(); ++i)
    EXPECT_LT(back.attitude.value[i].angularDistance(flight.attitude.value[i]), 1e-7);
}

TEST(FlightCsv, HasNoColumnForAStreamThatIsNotThere) {
  ingest::Flight f;
  f.velocity.push(LogTime{0}, {1, 2, 3});
  EXPECT_EQ(flight_csv(f), "time_s,utc,vn_m_s,ve_m_s,vd_m_s\n0.000000000,,1,2,3\n");
}

}  // namespace
}  // namespace quadsonde::product
