#include "ingest/dataflash/flight_from_dataflash.h"

#include <gtest/gtest.h>

#include "ingest/flight/rotation.h"
#include "tests/ingest/dataflash/dataflash_writer.h"

namespace quadsonde::ingest {
namespace {

using support::CopterLog;
using support::DataflashWriter;

LogContent read(const DataflashWriter& log) { return read_dataflash(log.bytes, "test.bin").value(); }
Flight only(const DataflashWriter& log) {
  auto content = read(log);
  EXPECT_EQ(content.flights.size(), 1u);
  return content.flights.at(0);
}

TEST(FlightFromDataflash, TurnsGroundSpeedCourseAndVzIntoNed) {
  CopterLog log;
  log.fly();
  const auto flight = only(log);
  ASSERT_EQ(flight.velocity.size(), 50u);
  EXPECT_EQ(flight.velocity.origin, VelocityOrigin::receiver);
  EXPECT_LT((flight.velocity.value[0] - Eigen::Vector3d(0, 2, -0.5)).norm(), 1e-6);
  const auto angles = euler_from_q_NB(flight.attitude.value[0]);
  EXPECT_NEAR(angles.roll, 1 * 0.0174532925, 1e-8);
  EXPECT_NEAR(angles.pitch, -2 * 0.0174532925, 1e-8);
  EXPECT_NEAR(angles.yaw, -10 * 0.0174532925, 1e-8);
  EXPECT_EQ(flight.attitude.time[0].ns, 60'000'000'000);
}

TEST(FlightFromDataflash, TakesTheReceiversAccuracyAsStandardDeviation) {
  CopterLog log;
  for (int k = 0; k < 40; ++k) {
    log.attitude(60e6 + k * 2e5);
    log.gps(60e6 + k * 2e5);
    log.accuracy(60e6 + k * 2e5, k < 20 ? 0.3 : 0.5);
  }
  const auto flight = only(log);
  ASSERT_EQ(flight.velocity.sd.size(), 40u);
  EXPECT_DOUBLE_EQ(flight.velocity.sd[19], 0.3);
  EXPECT_DOUBLE_EQ(flight.velocity.sd[20], 0.5);
}

TEST(FlightFromDataflash, TakesTheFilterWhereTheReceiverIsSlow) {
  for (const double step : {0.2, 0.5}) {
    CopterLog log;
    log.fly(step, 60, 7);
    const auto flight = only(log);
    EXPECT_EQ(flight.velocity.origin, step > 0.25 ? VelocityOrigin::fused : VelocityOrigin::receiver);
    EXPECT_EQ(flight.velocity.value[0].x() > 6, step > 0.25);
  }
}

TEST(FlightFromDataflash, TakesTheFilterWhereTheReceiverHasNoVerticalVelocity) {
  CopterLog log;
  log.fly(0.2, 60, 7, 0);
  EXPECT_EQ(only(log).velocity.origin, VelocityOrigin::fused);
}

TEST(FlightFromDataflash, TakesTheFilterCoreThatFlew) {
  CopterLog log;
  for (int k = 0; k < 100; ++k) {
    log.attitude(60e6 + k * 1e5);
    log.filter(60e6 + k * 1e5, 1, 0);
    log.filter(60e6 + k * 1e5, 2, 1);
    log.add("XKF2", {60e6 + k * 1e5, 0., 100., 0.});
    log.add("XKF2", {60e6 + k * 1e5, 1., -51., -172.});
    log.add("XKF4", {60e6 + k * 1e5, 0., k < 10 ? 0. : 1.});
  }
  const auto flight = only(log);
  EXPECT_EQ(flight.velocity.value[50].x(), 2);
  EXPECT_LT((flight.autopilot_wind.value[50].v_NA_N - Eigen::Vector2d(-0.51, -1.72)).norm(), 1e-9);
}

TEST(FlightFromDataflash, KnowsTheNamesOfCoresInTheSecondFilter) {
  DataflashWriter log;
  log.define(1, "ATT", "QcccB", "TimeUS,Roll,Pitch,Yaw,AEKF");
  log.define(2, "NKF1", "Qfff", "TimeUS,VN,VE,VD");
  log.define(3, "NKF6", "Qfff", "TimeUS,VN,VE,VD");
  log.define(4, "NKF4", "Qb", "TimeUS,PI");
  log.define(5, "XKF1", "QBfff", "TimeUS,C,VN,VE,VD");
  for (int k = 0; k < 20; ++k) {
    log.add("ATT", {60e6 + k * 1e5, 0., 0., 0., 2.});
    log.add("NKF1", {60e6 + k * 1e5, 1., 0., 0.});
    log.add("NKF6", {60e6 + k * 1e5, 2., 0., 0.});
    log.add("XKF1", {60e6 + k * 1e5, 0., 3., 0., 0.});
    log.add("XKF1", {60e6 + k * 1e5 + 10, 1., 3., 0., 0.});
    log.add("NKF4", {60e6 + k * 1e5, 1.});
  }
  EXPECT_EQ(only(log).velocity.value[0].x(), 2) << "core 1 of EKF2 flew, EKF3 only ran beside it";
}

TEST(FlightFromDataflash, TakesTheReceiverThatTheVehicleUsed) {
  CopterLog log;
  for (int k = 0; k < 60; ++k) {
    log.attitude(60e6 + k * 1e5);
    log.gps(60e6 + k * 1e5, {1, 0, 0, 0, 0});
    log.gps(60e6 + k * 1e5, {2, 0, 0, 1, 1});
  }
  const auto flight = only(log);
  EXPECT_EQ(flight.velocity.size(), 60u);
  EXPECT_EQ(flight.velocity.value[0].x(), 2);
}

TEST(FlightFromDataflash, DropsFixesThatAreNone) {
  CopterLog log;
  log.fly();
  for (const int status : {0, 1, 2}) log.gps(71e6, {50, 0, 0, 0, 1, status});
  log.gps(71.2e6, {50, 0, 0, 0, 1, 4, 2046, 312816600, 0, 0});
  const auto flight = only(log);
  for (const auto& v : flight.velocity.value) EXPECT_LT(v.norm(), 10);
  for (const auto& p : flight.position.value) EXPECT_GT(p.lat_deg, 47);
}

TEST(FlightFromDataflash, HasTheFusedPositionWhereNoReceiverHadAFix) {
  CopterLog log;
  log.define(30, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt");
  for (int k = 0; k < 20; ++k) {
    log.attitude(60e6 + k * 1e5);
    log.gps(60e6 + k * 1e5, {1, 0, 0, 0, 1, 1});
    log.add("POS", {60e6 + k * 1e5, 473565765., 85189121., 430., 12.5, 13.});
  }
  const auto flight = only(log);
  ASSERT_EQ(flight.position.size(), 20u);
  EXPECT_DOUBLE_EQ(flight.position.value[0].lat_deg, 47.3565765);
  EXPECT_DOUBLE_EQ(flight.height_msl.value.at(0).m, 430);
  EXPECT_DOUBLE_EQ(flight.height_ground.value.at(0).m, 12.5);
  EXPECT_TRUE(flight.velocity.empty()) << "an unknown velocity is not zero";
}

TEST(FlightFromDataflash, LeavesOutValuesThatNoSensorGives) {
  CopterLog log;
  log.fly();
  log.attitude(70.1e6, 300);
  log.gps(70.2e6, {8e8, 0, 0});
  const auto flight = only(log);
  EXPECT_EQ(flight.attitude.size(), 100u);
  EXPECT_EQ(flight.velocity.size(), 50u);
  ASSERT_EQ(flight.problems.size(), 2u);
  EXPECT_EQ(flight.problems[0].kind, Kind::damaged);
}

TEST(FlightFromDataflash, ReadsLogsOf2014WithoutTimeUs) {
  DataflashWriter log;
  log.define(1, "GPS", "BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T");
  log.define(2, "ATT", "IccccCCCC", "TimeMS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw");
  log.define(3, "PARM", "Nf", "Name,Value");
  log.define(4, "MSG", "Z", "Message");
  log.define(5, "EKF1", "IccCffffff", "TimeMS,Roll,Pitch,Yaw,VN,VE,VD,PN,PE,PD");
  log.define(6, "EKF2", "Icc", "TimeMS,VWN,VWE");
  log.add("MSG", {std::string("ArduCopter V3.2.1 (36b405fb)")});
  log.add("PARM", {std::string("FRAME"), 1.});
  for (int k = 0; k < 20; ++k) {
    log.add("GPS", {3., 1e8 + k * 200, 1800., 9., 120., 473565765., 85189121., 100., 42892., 123., 9000., -0.5,
                    60e3 + k * 200});
    log.add("ATT", {60010. + k * 200, 0., 150., 0., -220., 0., 27000., 0., 0.});
    log.add("EKF1", {60010. + k * 200, 0., 0., 0., 1., 2., 3., 4., 5., 6.});
    log.add("EKF2", {60010. + k * 200, 150., -50.});
  }
  const auto flight = only(log);
  EXPECT_EQ(flight.vehicle.airframe, Airframe::multirotor);
  EXPECT_EQ(flight.velocity.time[0].ns, 60'000'000'000) << "T, not the GPS's time of week";
  EXPECT_LT((flight.velocity.value[0] - Eigen::Vector3d(0, 1.23, -0.5)).norm(), 1e-6);
  EXPECT_DOUBLE_EQ(flight.height_msl.value[0].m, 428.92);
  EXPECT_EQ(flight.autopilot_wind.value[0].v_NA_N, Eigen::Vector2d(1.5, -0.5));
  EXPECT_EQ(to_iso8601(*flight.clock.to_utc(LogTime{60'000'000'000}), 0),
            to_iso8601(utc_from_gps(1800, 100'000'000), 0));
}

TEST(FlightFromDataflash, MakesOneFlightOfEachBoot) {
  CopterLog log;
  log.fly(0.2, 600);
  log.fly(0.2, 60);
  const auto content = read(log);
  ASSERT_EQ(content.flights.size(), 2u);
  EXPECT_EQ(content.flights[0].attitude.size(), 100u);
  EXPECT_EQ(content.flights[1].attitude.size(), 100u);
  EXPECT_EQ(content.flights[1].velocity.size(), 50u);
}

TEST(FlightFromDataflash, IsNotSplitByOneWrongTime) {
  CopterLog log;
  log.fly(0.2, 60);
  log.attitude(3e6);
  log.attitude(9e12);
  log.fly(0.2, 70);
  const auto content = read(log);
  ASSERT_EQ(content.flights.size(), 1u);
  EXPECT_EQ(content.flights[0].attitude.size(), 200u);
}

TEST(FlightFromDataflash, GoesOnAfterAPauseOfLogging) {
  CopterLog log;
  log.fly(0.2, 60);
  log.fly(0.2, 800);
  const auto flight = only(log);
  EXPECT_EQ(flight.attitude.size(), 200u);
  EXPECT_TRUE(flight.problems.empty());
}

TEST(FlightFromDataflash, BelievesTheLandDetector) {
  CopterLog log;
  log.add("EV", {59e6, 10.});
  log.fly();
  log.add("EV", {70e6, 28.});
  log.fly(0.2, 70);
  log.add("EV", {80e6, 18.});
  const auto flight = only(log);
  ASSERT_EQ(flight.landed.size(), 3u);
  EXPECT_TRUE(flight.landed.value[0]) << "on the ground before its first word";
  EXPECT_FALSE(flight.landed.value[1]);
  EXPECT_TRUE(flight.landed.value[2]);
}

TEST(FlightFromDataflash, DoesNotTakeArmingForFlying) {
  CopterLog log;
  log.add("EV", {59e6, 10.});
  log.fly();
  log.add("EV", {70e6, 11.});
  EXPECT_TRUE(only(log).landed.empty());
}

TEST(FlightFromDataflash, NamesTheVehicle) {
  struct Case {
    const char *message, *parameter;
    double value;
    Airframe airframe;
    int rotors;
  };
  for (const auto& [message, parameter, value, airframe, rotors] :
       {Case{"ArduCopter V4.5.0 (x)", "FRAME_CLASS", 2, Airframe::multirotor, 6},
        Case{"ArduCopter V4.5.0 (x)", "FRAME_CLASS", 6, Airframe::helicopter, 0},
        Case{"ArduPlane V4.5.0 (x)", "Q_ENABLE", 0, Airframe::fixed_wing, 0},
        Case{"ArduPlane V4.5.0 (x)", "Q_ENABLE", 1, Airframe::vtol, 0},
        Case{"ArduRover V4.5.0 (x)", "FRAME_CLASS", 1, Airframe::other, 0},
        Case{"no firmware", "WPNAV_SPEED", 500, Airframe::multirotor, 0}}) {
    CopterLog log;
    log.add("MSG", {59e6, std::string(message)});
    log.add("PARM", {59e6, std::string(parameter), value});
    log.fly();
    const auto flight = only(log);
    EXPECT_EQ(flight.vehicle.airframe, airframe) << message << " " << parameter;
    EXPECT_EQ(flight.vehicle.rotors, rotors) << message << " " << parameter;
  }
}

TEST(FlightFromDataflash, KnowsASimulatedFlight) {
  CopterLog log;
  log.add("PARM", {59e6, std::string("SIM_SPEEDUP"), 1.});
  log.fly();
  EXPECT_TRUE(only(log).vehicle.simulated);
}

TEST(FlightFromDataflash, MendsATenBitWeek) {
  CopterLog log;
  for (int k = 0; k < 40; ++k) {
    log.attitude(60e6 + k * 2e5);
    log.gps(60e6 + k * 2e5, {0, 0, 0, 0, 1, 4, 2046 - 1024});
  }
  EXPECT_EQ(to_iso8601(*only(log).clock.to_utc(LogTime{60'000'000'000}), 0), "2019-03-27T14:53:18Z");
}

TEST(FlightFromDataflash, IsNotLedAstrayByAWrongDateOrAJumpOfTheReceiversClock) {
  CopterLog log;
  for (int k = 0; k < 100; ++k) {
    CopterLog::Fix fix;
    if (k < 20) fix.week = 1800;                     // a date of the past, until the almanac is there
    if (k >= 20 && k < 25) fix.week = 0;             // unknown
    if (k > 90) fix.ms += 2000;                      // a jump at the end
    if (k > 25 && k < 60) fix.ms += k % 2 ? 20 : 0;  // jitter
    log.attitude(60e6 + k * 2e5);
    log.gps(60e6 + k * 2e5, fix);
  }
  const auto clock = only(log).clock;
  ASSERT_TRUE(clock.utc_minus_log);
  EXPECT_NEAR(to_seconds(*clock.to_utc(LogTime{60'000'000'000}) - utc_from_gps(2046, 312816600)), 0, 0.021);
  EXPECT_LT(clock.uncertainty_s, 0.11) << "what is further off than 1 s does not count";
  EXPECT_EQ(clock.source, "GPS week and time of week");
}

TEST(FlightFromDataflash, GivesEachBootItsOwnClock) {
  CopterLog log;
  log.fly(0.2, 600);
  log.fly(0.2, 60);
  auto content = read(log);
  ASSERT_EQ(content.flights.size(), 2u);
  // The writer's GPS time follows its boot time, so both boots have one offset: it must come from each one's own fixes.
  for (const auto& flight : content.flights) {
    ASSERT_TRUE(flight.clock.utc_minus_log);
    EXPECT_NEAR(to_seconds(*flight.clock.to_utc(LogTime{60'000'000'000}) - utc_from_gps(2046, 312816600)), 0, 1e-3);
  }
}

TEST(FlightFromDataflash, TellsHowOldSamplesAre) {
  CopterLog log;
  log.define(20, "BARO", "QBffI", "TimeUS,I,Alt,Press,SMS");
  log.define(3, "GPA", "QBCCCBI", "TimeUS,I,VDop,HAcc,SAcc,VV,SMS");
  for (int k = 0; k < 50; ++k) {
    const double us = 60e6 + k * 2e5;
    log.attitude(us);
    log.gps(us);
    log.add("GPA", {us, 0., 120., 50., 30., 1., us / 1000 - 35});
    log.add("BARO", {us, 0., 12., 98061., us / 1000 - 8});
  }
  const auto flight = only(log);
  ASSERT_TRUE(flight.barometer.latency && flight.velocity.latency);
  EXPECT_NEAR(flight.barometer.latency->median_s, 0.008, 1e-6);
  EXPECT_FALSE(flight.barometer.latency->at_least);
  EXPECT_NEAR(flight.velocity.latency->median_s, 0.035, 1e-6);
  EXPECT_TRUE(flight.velocity.latency->at_least) << "the receiver's own delay is not in the log";
}

TEST(FlightFromDataflash, DoesNotTakePx4sOldLogForArdupilots) {
  DataflashWriter log;
  log.define(1, "ATT", "fffffff", "qw,qx,qy,qz,Roll,Pitch,Yaw");
  log.add("ATT", {1., 0., 0., 0., 0.1, 0.1, 0.1});
  const auto content = read(log);
  EXPECT_TRUE(content.flights.empty());
  EXPECT_EQ(content.problems.at(0).kind, Kind::unsupported);
}

TEST(FlightFromDataflash, KeepsRotorSpeedsAndTheAirOfItsOwnSensors) {
  CopterLog log;
  log.define(30, "ESC", "QBf", "TimeUS,Instance,RPM");
  log.define(31, "HYGR", "QBff", "TimeUS,Id,Humidity,Temp");
  log.fly();
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 4; ++i) log.add("ESC", {70e6 + k * 1e5, double(i), 5000. + i});
    log.add("HYGR", {70e6 + k * 1e5, 0., 55., 12.});
  }
  const auto flight = only(log);
  ASSERT_EQ(flight.rotors.size(), 2u);
  EXPECT_EQ(flight.rotors.value[0], (RotorSpeeds{5000, 5001, 5002, 5003}));
  EXPECT_EQ(flight.rotors.time[0].ns, 70'000'000'000);
  EXPECT_DOUBLE_EQ(*flight.air.value[0].temperature_k, 285.15);
  EXPECT_DOUBLE_EQ(*flight.air.value[0].relative_humidity_pct, 55);
}

TEST(FlightFromDataflash, StopsAtTheFirstDamageWhenStrict) {
  CopterLog log;
  log.fly();
  EXPECT_TRUE(read_dataflash(log.bytes, "x.bin", {Reading::strict}));
  log.bytes.insert(log.bytes.end(), 50, 0x11);
  log.attitude(71e6);
  const auto strict = read_dataflash(log.bytes, "x.bin", {Reading::strict});
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().kind, Kind::damaged);
  EXPECT_TRUE(strict.error().where.byte.has_value());
  EXPECT_TRUE(read_dataflash(log.bytes, "x.bin"));
}

TEST(FlightFromDataflash, KeepsWhatWasCompleteBeforeEveryCut) {
  CopterLog log;
  std::vector<std::size_t> attitude_ends;
  for (int k = 0; k < 12; ++k) {
    log.attitude(60e6 + k * 1e5);
    attitude_ends.push_back(log.bytes.size());
    log.gps(60e6 + k * 1e5);
  }
  for (std::size_t cut = attitude_ends.front(); cut <= log.bytes.size(); ++cut) {
    const auto content = read_dataflash(Bytes(log.bytes).first(cut), "cut.bin").value();
    const auto complete = std::upper_bound(attitude_ends.begin(), attitude_ends.end(), cut) - attitude_ends.begin();
    ASSERT_EQ(content.flights.at(0).attitude.size(), static_cast<std::size_t>(complete)) << "cut at " << cut;
  }
}

}  // namespace
}  // namespace quadsonde::ingest
