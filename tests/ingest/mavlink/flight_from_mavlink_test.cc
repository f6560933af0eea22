#include "ingest/mavlink/flight_from_mavlink.h"

#include <gtest/gtest.h>

#include "ingest/flight/rotation.h"
#include "tests/ingest/mavlink/mavlink_writer.h"

namespace quadsonde::ingest {
namespace {

using support::TlogWriter;

LogContent read(const TlogWriter& log) { return read_mavlink(log.bytes, "test.tlog").value(); }
Flight only(const TlogWriter& log) {
  auto content = read(log);
  EXPECT_EQ(content.flights.size(), 1u);
  return content.flights.at(0);
}

TEST(FlightFromMavlink, KeepsUnitsAndFrames) {
  TlogWriter log;
  log.fly();
  log.add("SCALED_PRESSURE", {{"time_boot_ms", 70000}, {"press_abs", 980.5}});
  log.add("GLOBAL_POSITION_INT", {{"time_boot_ms", 70000},
                                  {"lat", 473565765},
                                  {"lon", 85189121},
                                  {"alt", 428924},
                                  {"relative_alt", 12302},
                                  {"vx", 100},
                                  {"vy", 200},
                                  {"vz", -300}});
  log.add("RAW_IMU", {{"time_usec", 70e6}, {"zacc", -1000}});
  log.add("HYGROMETER_SENSOR", {{"temperature", 1234}, {"humidity", 5678}});
  log.add("EXTENDED_SYS_STATE", {{"landed_state", 2}});
  log.add("SYSTEM_TIME", {{"time_boot_ms", 70000}, {"time_unix_usec", 1'557'756'570e6}});
  const auto flight = only(log);
  const auto angles = euler_from_q_NB(flight.attitude.value[0]);
  EXPECT_NEAR(angles.roll, 0.1, 1e-7);
  EXPECT_NEAR(angles.pitch, -0.2, 1e-7);
  EXPECT_NEAR(angles.yaw, 0.3, 1e-7);
  EXPECT_LT((flight.velocity.value[0] - Eigen::Vector3d(1, 2, -0.5)).norm(), 1e-6);
  EXPECT_EQ(flight.velocity.origin, VelocityOrigin::fused);
  EXPECT_DOUBLE_EQ(*flight.barometer.value.at(0).pressure_pa, 98050);
  EXPECT_DOUBLE_EQ(flight.height_msl.value.at(0).m, 428.924);
  EXPECT_DOUBLE_EQ(flight.height_ground.value.at(0).m, 12.302);
  EXPECT_NEAR(flight.position.value.at(0).lat_deg, 47.3565765, 1e-9);
  EXPECT_NEAR(flight.accelerometer.value.at(0).z(), -9.80665, 1e-9);
  EXPECT_NEAR(*flight.air.value.at(0).temperature_k, 285.49, 1e-9);
  EXPECT_NEAR(*flight.air.value.at(0).relative_humidity_pct, 56.78, 1e-9);
  EXPECT_FALSE(flight.landed.value.at(0));
  EXPECT_EQ(to_iso8601(*flight.clock.to_utc(LogTime{70'000'000'000}), 0), "2019-05-13T14:09:30Z");
}

TEST(FlightFromMavlink, TakesARawReceiverOfFourHertzWithItsAccuracy) {
  for (const int step : {200, 500}) {
    TlogWriter log;
    log.heartbeat();
    for (int k = 0; k < 100; ++k) {
      const double ms = 60000 + 100 * k;
      log.add("LOCAL_POSITION_NED", {{"time_boot_ms", ms}, {"vx", 7}, {"vz", -0.5}});
      if (100 * k % step == 0)
        log.add("GPS_RAW_INT", {{"time_usec", ms * 1000},
                                {"fix_type", 3},
                                {"lat", 473565765},
                                {"lon", 85189121},
                                {"vel", 200},
                                {"cog", 9000},
                                {"vel_acc", 300}});
    }
    const auto flight = only(log);
    if (step == 500) {
      EXPECT_EQ(flight.velocity.origin, VelocityOrigin::fused);
      continue;
    }
    EXPECT_EQ(flight.velocity.origin, VelocityOrigin::receiver);
    EXPECT_LT((flight.velocity.value[3] - Eigen::Vector3d(0, 2, -0.5)).norm(), 1e-6) << "down is the filter's";
    EXPECT_DOUBLE_EQ(flight.velocity.sd.at(3), 0.3);
  }
}

TEST(FlightFromMavlink, CountsARepeatedFixOnce) {
  TlogWriter log;
  log.fly();
  for (int k = 0; k < 10; ++k)
    log.add("GPS_RAW_INT",
            {{"time_usec", 70e6 + (k / 2) * 2e5}, {"fix_type", 3}, {"lat", 473565765}, {"lon", 85189121}, {"eph", k}});
  EXPECT_EQ(only(log).position.size(), 5u);
}

TEST(FlightFromMavlink, KnowsWhereWindComesFrom) {
  TlogWriter log;
  log.fly();
  log.add("WIND", {{"direction", 90}, {"speed", 5}, {"speed_z", 3}});
  const auto flight = only(log);
  ASSERT_EQ(flight.autopilot_wind.size(), 1u);
  // From the east is toward west; ArduPilot's speed is the length of all three parts: 5, 3 down, 4 along the ground.
  EXPECT_LT((flight.autopilot_wind.value[0].v_NA_N - Eigen::Vector2d(0, -4)).norm(), 1e-6);
  EXPECT_NEAR(static_cast<double>(flight.autopilot_wind.time[0].ns) * 1e-9, 70, 0.2)
      << "the host's time on the boot clock";
}

TEST(FlightFromMavlink, TakesTheVehicleAmongSeveralSystems) {
  TlogWriter log;
  log.options.system = 255;
  log.heartbeat(6);  // a ground station that also talks of attitudes
  for (int k = 0; k < 300; ++k) log.add("ATTITUDE", {{"time_boot_ms", k}, {"roll", 1}});
  log.options.system = 3;
  log.fly();
  const auto content = read(log);
  ASSERT_EQ(content.flights.size(), 1u);
  EXPECT_EQ(content.flights[0].vehicle.name, "system 3");
  EXPECT_EQ(content.flights[0].attitude.size(), 100u);
  EXPECT_TRUE(content.problems.empty());
}

TEST(FlightFromMavlink, SaysThatItChoseOneOfTwoVehicles) {
  TlogWriter log;
  log.fly();
  log.options.system = 2;
  log.heartbeat();
  log.add("ATTITUDE", {{"time_boot_ms", 60000}, {"roll", 0.7}});
  const auto content = read(log);
  ASSERT_EQ(content.flights.size(), 1u);
  EXPECT_EQ(content.flights[0].vehicle.name, "system 1");
  ASSERT_EQ(content.problems.size(), 1u);
  EXPECT_EQ(content.problems[0].kind, Kind::doubtful);
  const auto other = read_mavlink(log.bytes, "x", {Reading::tolerant, std::uint8_t{2}}).value();
  EXPECT_EQ(other.flights.at(0).attitude.size(), 1u);
  EXPECT_TRUE(other.problems.empty());
}

TEST(FlightFromMavlink, LeavesOtherComponentsOut) {
  TlogWriter log;
  log.fly();
  log.options.component = 154;  // a gimbal with an attitude of its own
  log.add("ATTITUDE", {{"time_boot_ms", 70000}, {"roll", 1.5}});
  EXPECT_EQ(only(log).attitude.size(), 100u);
}

TEST(FlightFromMavlink, MakesOneFlightOfEachBoot) {
  TlogWriter log;
  log.fly(600000);
  log.fly(60000);
  const auto content = read(log);
  ASSERT_EQ(content.flights.size(), 2u);
  for (const auto& flight : content.flights) {
    EXPECT_EQ(flight.attitude.size(), 100u);
    EXPECT_EQ(flight.velocity.size(), 50u);
  }
}

TEST(FlightFromMavlink, IsNotSplitByALateFrame) {
  TlogWriter log;
  log.fly(60000);
  log.add("ATTITUDE", {{"time_boot_ms", 61000}, {"roll", 1}});
  log.fly(70000);
  EXPECT_EQ(only(log).attitude.size(), 200u);
}

TEST(FlightFromMavlink, GoesOnWhenTheBootClockWraps) {
  TlogWriter log;
  log.fly(4294967296.0 - 5000);
  EXPECT_EQ(only(log).attitude.size(), 100u);
  TlogWriter wrapped;
  wrapped.fly(4294967296.0 - 10000);
  wrapped.fly(0);
  const auto flight = only(wrapped);
  ASSERT_EQ(flight.attitude.size(), 200u);
  EXPECT_EQ((flight.attitude.time[100] - flight.attitude.time[99]).count(), 100'000'000);
}

TEST(FlightFromMavlink, HearsAFrameOfTwoLinksOnce) {
  TlogWriter log;
  log.fly();
  std::vector<std::uint8_t> twice;
  std::size_t at = 0;
  while (at < log.bytes.size()) {
    const auto size = 8 + probe_mavlink(Bytes(log.bytes).subspan(at + 8)).length;
    for (int i = 0; i < 2; ++i)
      twice.insert(twice.end(), log.bytes.begin() + static_cast<std::ptrdiff_t>(at),
                   log.bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
    at += size;
  }
  const auto content = read_mavlink(twice, "x").value();
  EXPECT_EQ(content.messages, 302u);
  EXPECT_EQ(content.flights.at(0).attitude.size(), 100u);
}

TEST(FlightFromMavlink, HasNoClockBeforeGpsButTheGroundStations) {
  TlogWriter log;
  log.fly();
  log.add("SYSTEM_TIME", {{"time_boot_ms", 70000}, {"time_unix_usec", 0}});
  const auto flight = only(log);
  ASSERT_TRUE(flight.clock.utc_minus_log);
  EXPECT_GE(flight.clock.uncertainty_s, 1);
  TlogWriter unset;
  unset.host_us = 47'333'000;
  unset.fly();
  EXPECT_FALSE(only(unset).clock.utc_minus_log);
}

TEST(FlightFromMavlink, IsNotLedAstrayByAWrongDateBeforeTheFix) {
  TlogWriter log;
  log.heartbeat();
  for (int k = 0; k < 60; ++k) {
    const double ms = 60000 + 200. * k, right_us = 1'557'756'500e6 + ms * 1000;
    // 0, then a day of 2012 out of the receiver's memory, then what is right, a jump at the end.
    const double told = k < 5 ? 0 : k < 20 ? 1.33e15 + ms * 1000 : k > 55 ? right_us + 5e6 : right_us;
    log.add("ATTITUDE", {{"time_boot_ms", ms}, {"roll", 0.1}});
    log.add("SYSTEM_TIME", {{"time_boot_ms", ms}, {"time_unix_usec", told}});
    log.host_us += 200'000;
  }
  const auto clock = only(log).clock;
  ASSERT_TRUE(clock.utc_minus_log);
  EXPECT_NEAR(static_cast<double>(clock.utc_minus_log->count()) * 1e-9, 1'557'756'500.0, 1e-3);
  EXPECT_EQ(clock.source, "autopilot UTC (SYSTEM_TIME)");
  EXPECT_LT(clock.uncertainty_s, 0.11);
}

TEST(FlightFromMavlink, TellsHowLateFramesAreLogged) {
  TlogWriter log;
  log.heartbeat();
  for (int k = 0; k < 200; ++k) {
    const auto sent_us = 1'557'756'559'000'000 + 100'000 * static_cast<std::uint64_t>(k);
    log.host_us = sent_us + 1000 * static_cast<std::uint64_t>(k * 7 % 11) * 10;  // 0 to 100 ms on the way
    log.add("ATTITUDE", {{"time_boot_ms", 60000 + 100. * k}, {"roll", 0.1}});
  }
  const auto content = read(log);
  std::string link;
  for (const auto& [name, value] : content.details)
    if (name == "link") link = value;
  EXPECT_EQ(link, "frames are logged 0.050 s (median) after the quickest one");
}

TEST(FlightFromMavlink, RunsOnTheGroundStationsClockWhereNoMessageHasABootTime) {
  TlogWriter log;
  log.heartbeat();
  for (int k = 0; k < 20; ++k) {
    log.add("GPS_RAW_INT", {{"fix_type", 3}, {"lat", 473565765}, {"lon", 85189121}, {"eph", k}});
    log.host_us += 200'000;
  }
  const auto flight = only(log);
  ASSERT_EQ(flight.position.size(), 20u);
  EXPECT_EQ(flight.clock.to_utc(flight.position.time[0])->ns, 1'557'756'559'001'000'000);
}

TEST(FlightFromMavlink, PutsFixesWithUnixTimeOnTheBootClock) {
  for (const bool with_pair : {true, false}) {
    TlogWriter log;
    log.heartbeat();
    log.host_us += 3'000'000;  // the host's clock is wrong
    for (int k = 0; k < 20; ++k) {
      const double ms = 60000 + 200. * k, unix_us = 1'557'756'500e6 + ms * 1000;
      log.add("ATTITUDE", {{"time_boot_ms", ms}, {"roll", 0.1}});
      if (with_pair) log.add("SYSTEM_TIME", {{"time_boot_ms", ms}, {"time_unix_usec", unix_us}});
      log.add("GPS_RAW_INT", {{"time_usec", unix_us - 50000}, {"fix_type", 3}, {"lat", 473565765}, {"lon", 85189121}});
      log.host_us += 200'000;
    }
    const auto flight = only(log);
    ASSERT_EQ(flight.position.size(), 20u);
    // The receiver's latency of 50 ms shows only where UTC and boot time were paired.
    EXPECT_NEAR(static_cast<double>(flight.position.time[5].ns) * 1e-9, with_pair ? 60.95 : 61.0, 0.02);
  }
}

TEST(FlightFromMavlink, DropsPositionsBeforeTheFilterHasOne) {
  TlogWriter log;
  log.heartbeat();
  for (int k = 0; k < 20; ++k)
    log.add("GLOBAL_POSITION_INT", {{"time_boot_ms", 1000. * k},
                                    {"lat", k < 10 ? 0. : 473565765.},
                                    {"lon", k < 10 ? 0. : 85189121.},
                                    {"vx", k < 10 ? 500. : 100.}});
  const auto flight = only(log);
  EXPECT_EQ(flight.velocity.size(), 10u);
  EXPECT_EQ(flight.position.size(), 10u);
}

TEST(FlightFromMavlink, NamesTheVehicle) {
  struct Case {
    int type;
    Airframe airframe;
    int rotors;
  };
  for (const auto& [type, airframe, rotors] :
       {Case{2, Airframe::multirotor, 4}, Case{13, Airframe::multirotor, 6}, Case{14, Airframe::multirotor, 8},
        Case{4, Airframe::helicopter, 0}, Case{1, Airframe::fixed_wing, 0}, Case{20, Airframe::vtol, 0},
        Case{10, Airframe::other, 0}}) {
    TlogWriter log;
    log.heartbeat(type);
    log.fly();
    log.heartbeat(type);
    const auto flight = only(log);
    EXPECT_EQ(flight.vehicle.airframe, airframe) << type;
    EXPECT_EQ(flight.vehicle.rotors, rotors) << type;
  }
}

TEST(FlightFromMavlink, PutsLongTextsTogether) {
  TlogWriter log;
  log.fly();
  const std::string text(70, 'x');
  log.add("STATUSTEXT", {{"id", 5}, {"chunk_seq", 0}}, text.substr(0, 50));
  log.add("STATUSTEXT", {{"id", 5}, {"chunk_seq", 1}}, text.substr(50));
  log.add("STATUSTEXT", {}, "ArduCopter V4.5.7 (2a3dc4b7)");
  const auto flight = only(log);
  EXPECT_EQ(flight.vehicle.firmware, "ArduCopter V4.5.7 (2a3dc4b7)");
  std::vector<std::string> texts;
  for (const auto& event : flight.events.value)
    if (event.what == Event::What::text) texts.push_back(event.text);
  EXPECT_EQ(texts.at(0), text);
}

TEST(FlightFromMavlink, SaysWhatIsMissing) {
  TlogWriter log;
  log.heartbeat();
  const auto content = read(log);
  EXPECT_TRUE(content.flights.empty());
  EXPECT_EQ(content.problems.at(0).kind, Kind::missing);
}

TEST(FlightFromMavlink, StopsAtTheFirstDamageWhenStrict) {
  TlogWriter log;
  log.fly();
  EXPECT_TRUE(read_mavlink(log.bytes, "x", {Reading::strict, {}}));
  log.bytes.insert(log.bytes.end(), 50, 0x11);
  log.heartbeat();
  EXPECT_FALSE(read_mavlink(log.bytes, "x", {Reading::strict, {}}));
  EXPECT_TRUE(read_mavlink(log.bytes, "x"));
}

}  // namespace
}  // namespace quadsonde::ingest
