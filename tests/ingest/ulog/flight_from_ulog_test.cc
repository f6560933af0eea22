#include "ingest/ulog/flight_from_ulog.h"

#include <fmt/format.h>

#include <functional>
#include <numbers>

#include "ingest/flight/rotation.h"
#include "tests/ingest/ulog/ulog_writer.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

using support::UlogWriter;

LogContent sample(const std::string& name, std::vector<std::uint8_t>& bytes) {
  bytes = support::read_bytes(support::data_file("logs/ulog/" + name));
  return read_ulog(bytes, name).value();
}

TEST(UlogFlight, TakesTheReceiversVelocityWithItsAccuracy) {
  QUADSONDE_NEEDS_DATA("logs/ulog/esc_status_log.ulg");
  std::vector<std::uint8_t> bytes;
  const auto content = sample("esc_status_log.ulg", bytes);
  ASSERT_EQ(content.flights.size(), 1U);
  EXPECT_EQ(content.messages, 8200U);
  const auto& f = content.flights[0];
  EXPECT_EQ(f.velocity.source, "vehicle_gps_position[0]");
  EXPECT_EQ(f.velocity.origin, VelocityOrigin::receiver);
  ASSERT_EQ(f.velocity.size(), 179U);
  ASSERT_EQ(f.velocity.sd.size(), 179U);
  EXPECT_GT(f.velocity.sd[0], 0.05);
  EXPECT_LT(f.velocity.sd[0], 2.0);
  EXPECT_NEAR(f.velocity.value[0].z(), -1.46, 1e-6);
  EXPECT_EQ(f.velocity.time[0].ns, 5080891710000);
  EXPECT_NEAR(f.position.value[0].lat_deg, 47.3565765, 1e-9);
  EXPECT_NEAR(f.height_msl.value[0].m, 428.924, 1e-6);
}

TEST(UlogFlight, HoldsTheOtherStreamsOfARealQuadrotor) {
  QUADSONDE_NEEDS_DATA("logs/ulog/esc_status_log.ulg");
  std::vector<std::uint8_t> bytes;
  const auto content = sample("esc_status_log.ulg", bytes);
  const auto& f = content.flights.at(0);
  EXPECT_EQ(f.attitude.size(), 1099U) << "every attitude of the log, at its own rate";
  EXPECT_NEAR(f.attitude.value[0].w(), 0.6007400751113892, 1e-12);
  EXPECT_EQ(f.local_position.size(), 315U);
  ASSERT_TRUE(f.origin);
  EXPECT_NEAR(f.origin->point.lat_deg, 47.3565835, 1e-9);
  EXPECT_NEAR(f.origin->height_msl->m, 419.8881530761719, 1e-9);
  EXPECT_EQ(f.barometer.size(), 110U);
  EXPECT_EQ(f.barometer.value[0].pressure_pa, 98061.0);
  EXPECT_TRUE(f.air.empty()) << "the board's temperature is not the air's";
  EXPECT_EQ(f.rotors.size(), 127U);
  EXPECT_EQ(f.rotors.value[50].size(), 4U);
  EXPECT_EQ(f.autopilot_wind.source, "wind_estimate[0]");
  EXPECT_NEAR(f.autopilot_wind.value[0].v_NA_N.y(), -0.7068348526954651, 1e-12);
  EXPECT_EQ(f.landed.size(), 46U);
  EXPECT_EQ(f.vehicle.autopilot, "PX4");
  EXPECT_EQ(f.vehicle.firmware, "1.9.0 beta 654ed4b904");
  EXPECT_EQ(f.vehicle.airframe, Airframe::multirotor);
  EXPECT_EQ(f.vehicle.rotors, 4);
  EXPECT_FALSE(f.vehicle.simulated);
}

/// Fixes at 5 Hz from second 100 on; `utc_us(i)` is what the receiver says, `sampled_ago_us` where the driver knows.
UlogWriter receiver_log(int fixes, const std::function<std::uint64_t(int)>& utc_us, std::uint64_t sampled_ago_us = 0) {
  UlogWriter log;
  log.flags();
  log.format(
      "vehicle_gps_position:uint64_t timestamp;uint64_t timestamp_sample;uint64_t time_utc_usec;int32_t lat;int32_t "
      "lon;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t fix_type;bool vel_ned_valid;");
  log.subscribe(0, "vehicle_gps_position");
  for (int i = 0; i < fixes; ++i) {
    const std::uint64_t t = 100'000'000 + 200'000 * static_cast<std::uint64_t>(i);
    log.data(0, UlogWriter::raw(t) + UlogWriter::raw(sampled_ago_us ? t - sampled_ago_us : std::uint64_t{0}) +
                    UlogWriter::raw(utc_us(i)) + UlogWriter::raw(std::int32_t{470000000}) +
                    UlogWriter::raw(std::int32_t{80000000}) + UlogWriter::raw(1.0F) + UlogWriter::raw(0.0F) +
                    UlogWriter::raw(0.0F) + UlogWriter::raw(std::uint8_t{3}) + UlogWriter::raw(true));
  }
  return log;
}

TEST(UlogFlight, IsNotLedAstrayByAWrongDateOrAJumpOfTheReceiversClock) {
  constexpr std::uint64_t right = 1'600'000'000'000'000;
  const auto log = receiver_log(100, [](int i) {
    const auto utc = right + 200'000 * static_cast<std::uint64_t>(i);
    if (i < 20) return utc - 86'400'000'000;  // yesterday, until the almanac is there
    if (i < 25) return std::uint64_t{0};      // unknown
    return i > 90 ? utc + 18'000'000 : utc;   // forgets the leap seconds at the end
  });
  const auto clock = read_ulog(log.bytes, "x.ulg").value().flights.at(0).clock;
  ASSERT_TRUE(clock.utc_minus_log);
  EXPECT_EQ(clock.to_utc(LogTime{100'000'000'000})->ns, static_cast<std::int64_t>(right) * 1000);
  EXPECT_LT(clock.uncertainty_s, 0.11);
  EXPECT_EQ(clock.source, "autopilot UTC (time_utc_usec)");
}

TEST(UlogFlight, TellsHowOldSamplesAre) {
  const auto utc = [](int i) { return 1'600'000'000'000'000 + 200'000 * static_cast<std::uint64_t>(i); };
  const auto told = read_ulog(receiver_log(100, utc, 120'000).bytes, "x.ulg").value().flights.at(0).velocity;
  ASSERT_TRUE(told.latency);
  EXPECT_NEAR(told.latency->median_s, 0.12, 1e-9);
  EXPECT_FALSE(told.latency->at_least);
  // Where the driver does not know, UTC shows that every other fix comes 60 ms later.
  const auto late = [&](int i) { return utc(i) - (i % 3 == 0 ? 0 : 60'000); };
  const auto seen = read_ulog(receiver_log(100, late).bytes, "x.ulg").value().flights.at(0).velocity;
  ASSERT_TRUE(seen.latency);
  EXPECT_NEAR(seen.latency->median_s, 0.06, 1e-9);
  EXPECT_TRUE(seen.latency->at_least);
}

TEST(UlogFlight, HasTheLatencyOfARealAutopilotsTopics) {
  QUADSONDE_NEEDS_DATA("logs/ulog/roboto_fmuv5_test.ulg");
  std::vector<std::uint8_t> bytes;
  const auto content = sample("roboto_fmuv5_test.ulg", bytes);
  const auto& f = content.flights.at(0);
  ASSERT_TRUE(f.attitude.latency && f.barometer.latency);
  EXPECT_GT(f.attitude.latency->median_s, 0) << "from the IMU's sample to the published attitude";
  EXPECT_LT(f.attitude.latency->median_s, 0.02);
  EXPECT_LT(f.barometer.latency->median_s, 0.1);
}

TEST(UlogFlight, RelatesBootTimeToUtc) {
  QUADSONDE_NEEDS_DATA("logs/ulog/esc_status_log.ulg");
  std::vector<std::uint8_t> bytes;
  const auto content = sample("esc_status_log.ulg", bytes);
  const auto utc = content.flights.at(0).clock.to_utc(LogTime{5081007923000});
  ASSERT_TRUE(utc);
  // utc_us of the same row in derived/esc_flight.csv, which took the median too.
  EXPECT_NEAR(to_seconds(*utc - UtcTime{1557756559716392000}), 0, 0.002);
}

TEST(UlogFlight, ReadsBothGenerationsOfReceiverUnits) {
  QUADSONDE_NEEDS_DATA("logs/ulog/sample_px4_events.ulg");
  std::vector<std::uint8_t> bytes;
  const auto content = sample("sample_px4_events.ulg", bytes);
  const auto& f = content.flights.at(0);
  ASSERT_FALSE(f.position.empty());
  EXPECT_NEAR(f.position.value.back().lat_deg, 47.3977417, 1e-9);
  EXPECT_NEAR(f.position.value.back().lon_deg, 8.545594, 1e-9);
  EXPECT_NEAR(f.height_msl.value.back().m, 487.992, 1e-9);
  EXPECT_TRUE(f.vehicle.simulated);
  EXPECT_EQ(f.vehicle.firmware.substr(0, 10), "1.15.0 dev");
}

TEST(UlogFlight, TellsWhatEachSampleIs) {
  QUADSONDE_NEEDS_DATA("logs/ulog/sample.ulg");
  std::vector<std::uint8_t> bytes;
  const auto simulated = sample("sitl_iris_v18.ulg", bytes);
  EXPECT_TRUE(simulated.flights.at(0).vehicle.simulated);
  const auto vtol = sample("sample_log_small.ulg", bytes);
  EXPECT_EQ(vtol.flights.at(0).vehicle.airframe, Airframe::vtol);
  EXPECT_EQ(vtol.flights.at(0).gaps.size(), 1U);
  const auto bench = sample("sample.ulg", bytes);
  EXPECT_EQ(bench.flights.at(0).attitude.size(), 6461U);
  EXPECT_TRUE(bench.flights.at(0).velocity.empty()) << "the estimator says itself that its velocity is not valid";
  EXPECT_TRUE(bench.flights.at(0).barometer.empty()) << "17070 zeros of a barometer that is not there";
  EXPECT_EQ(bench.flights.at(0).gaps.size(), 4U);
  const auto foreign = sample("yule_powers.ulg", bytes);
  EXPECT_TRUE(foreign.flights.empty()) << "no PX4 topic is in it";
  EXPECT_EQ(foreign.topics.size(), 2U);
  EXPECT_EQ(foreign.messages, 20U);
}

/// A hover with an attitude and a receiver, by hand.
UlogWriter made_flight(double receiver_hz, int mav_type = 2) {
  UlogWriter log;
  log.flags();
  log.format("vehicle_attitude:uint64_t timestamp;float[4] q;uint8_t quat_reset_counter;uint8_t[3] _padding0;");
  log.format(
      "vehicle_gps_position:uint64_t timestamp;int32_t lat;int32_t lon;int32_t alt;float s_variance_m_s;"
      "float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t fix_type;bool vel_ned_valid;");
  log.format(
      "vehicle_local_position:uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;float evh;"
      "bool xy_valid;bool z_valid;bool v_xy_valid;bool v_z_valid;");
  log.parameter("MAV_TYPE", mav_type);
  log.subscribe(0, "vehicle_attitude");
  log.subscribe(1, "vehicle_gps_position");
  log.subscribe(2, "vehicle_local_position");
  const auto raw = [](auto v) { return UlogWriter::raw(v); };
  double next_fix = 0;
  for (int ms = 0; ms < 20000; ms += 100) {
    const auto us = std::uint64_t(1000000 + ms * 1000);
    log.data(0, raw(us) + raw(1.0F) + raw(0.0F) + raw(0.0F) + raw(0.0F) + raw(std::uint8_t(ms >= 10000)));
    log.data(2,
             raw(us) + raw(1.0F) + raw(2.0F) + raw(-3.0F) + raw(0.5F) + raw(0.0F) + raw(0.0F) + raw(0.2F) + "\1\1\1\1");
    if (ms < next_fix) continue;
    next_fix += 1000 / receiver_hz;
    log.data(1, raw(us) + raw(std::int32_t(473000000)) + raw(std::int32_t(85000000)) + raw(std::int32_t(500000)) +
                    raw(0.3F) + raw(0.6F) + raw(0.0F) + raw(0.0F) + raw(std::uint8_t(3)) + raw(std::uint8_t(1)));
  }
  return log;
}

TEST(UlogFlight, PrefersTheEstimatorsVelocityToASlowReceivers) {
  const auto quick = read_ulog(made_flight(5).bytes, "x.ulg").value();
  EXPECT_EQ(quick.flights.at(0).velocity.origin, VelocityOrigin::receiver);
  EXPECT_NEAR(quick.flights[0].velocity.sd.at(0), 0.3, 1e-6);
  const auto slow = read_ulog(made_flight(1).bytes, "x.ulg").value();
  EXPECT_EQ(slow.flights.at(0).velocity.origin, VelocityOrigin::fused);
  EXPECT_NEAR(slow.flights[0].velocity.value.at(0).x(), 0.5, 1e-6);
  EXPECT_EQ(slow.flights[0].position.size(), 20U) << "the place still is the receiver's";
}

TEST(UlogFlight, MarksAJumpOfTheAttitudeEstimate) {
  const auto content = read_ulog(made_flight(5).bytes, "x.ulg").value();
  const auto& events = content.flights.at(0).events;
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events.value[0].what, Event::What::reset);
  EXPECT_EQ(events.time[0].ns, 11000000000);
}

TEST(UlogFlight, NamesAFixedWing) {
  const auto content = read_ulog(made_flight(5, 1).bytes, "x.ulg").value();
  EXPECT_EQ(content.flights.at(0).vehicle.airframe, Airframe::fixed_wing);
}

TEST(UlogFlight, KeepsEveryCompleteMessageOfAFileCutAnywhere) {
  const auto whole = made_flight(5).bytes;
  std::size_t attitudes = 0;
  for (std::size_t cut = 16; cut < whole.size(); cut += 1 + cut / 97) {
    const auto content = read_ulog(Bytes(whole).first(cut), "cut.ulg");
    ASSERT_TRUE(content) << cut;
    const auto now = content->flights.empty() ? 0 : content->flights[0].attitude.size();
    ASSERT_GE(now, attitudes) << cut;
    attitudes = now;
  }
  EXPECT_GT(attitudes, 190U);
}

}  // namespace
}  // namespace quadsonde::ingest
