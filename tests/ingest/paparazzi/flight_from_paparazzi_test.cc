#include "ingest/paparazzi/flight_from_paparazzi.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest {
namespace {

std::string message(const std::string& name, const std::string& type, const std::vector<std::string>& fields,
                    const std::string& unit = "") {
  std::string text = fmt::format("<message name=\"{}\" id=\"1\">", name);
  for (const auto& field : fields)
    text += fmt::format("<field name=\"{}\" type=\"{}\" unit=\"{}\"/>", field, type, unit);
  return text + "</message>";
}

std::string log_with(const std::string& messages, const std::string& firmware = "rotorcraft") {
  return "<configuration time_of_day=\"1557756558.716\"><conf><aircraft name=\"Q\" ac_id=\"42\"><firmware name=\"" +
         firmware + "\"/></aircraft></conf><protocol><msg_class name=\"telemetry\" id=\"1\">" + messages +
         "</msg_class></protocol></configuration>";
}

const std::string gps_int = message("GPS_INT", "int32",
                                    {"ecef_x", "ecef_y", "ecef_z", "lat", "lon", "alt", "hmsl", "ecef_xd", "ecef_yd",
                                     "ecef_zd", "pacc", "sacc", "tow", "pdop", "numsv", "fix", "comp_id"});
const std::string ins =
    message("INS", "int32", {"ins_x", "ins_y", "ins_z", "ins_xd", "ins_yd", "ins_zd", "ins_xdd", "ins_ydd", "ins_zdd"});
const std::string attitude = message("ATTITUDE", "float", {"phi", "psi", "theta"});

std::string fix(double t, int kind, int xd, int yd, int zd, int lat = 0, int lon = 0) {
  return fmt::format("{:.3f} 42 GPS_INT 1 2 3 {} {} 476264 428924 {} {} {} 47 28 137377600 79 14 {} 1\n", t,
                     lat == 0 ? 473565765 : lat, lon == 0 ? 85189121 : lon, xd, yd, zd, kind);
}

LogContent read(const std::string& log, const std::string& data, const PaparazziReadSettings& settings = {}) {
  return read_paparazzi(as_bytes(data), as_bytes(log), "x.data", settings).value();
}

TEST(FlightFromPaparazzi, TurnsEarthFixedVelocityIntoNed) {
  // On the equator at longitude zero x is up, y east, z north; at 90 E x is west.
  std::string data;
  for (int k = 0; k < 10; ++k) data += fix(1 + 0.2 * k, 3, 100, 200, 300, k < 5 ? 1 : 1, k < 5 ? 1 : 900000000);
  const auto flight = read(log_with(gps_int), data).flights.at(0);
  ASSERT_EQ(flight.velocity.size(), 10u);
  EXPECT_EQ(flight.velocity.origin, VelocityOrigin::receiver);
  EXPECT_LT((flight.velocity.value[0] - Eigen::Vector3d(3, 2, -1)).norm(), 1e-6);
  EXPECT_LT((flight.velocity.value[9] - Eigen::Vector3d(3, -1, -2)).norm(), 1e-6);
  EXPECT_DOUBLE_EQ(flight.velocity.sd.at(0), 0.28);
  EXPECT_DOUBLE_EQ(flight.height_msl.value[0].m, 428.924);
  EXPECT_DOUBLE_EQ(flight.height_ellipsoid.value[0].m, 476.264);
}

TEST(FlightFromPaparazzi, ReadsAnglesInTheOrderOfTheDefinition) {
  const auto flight = read(log_with(attitude), "1.0 42 ATTITUDE 0.1 -1.8 0.2\n").flights.at(0);
  const auto angles = euler_from_q_NB(flight.attitude.value.at(0));
  EXPECT_NEAR(angles.roll, 0.1, 1e-12);
  EXPECT_NEAR(angles.pitch, 0.2, 1e-12);
  EXPECT_NEAR(angles.yaw, -1.8, 1e-12);
}

TEST(FlightFromPaparazzi, ReadsOldAnglesInWholeDegrees) {
  const auto flight =
      read(log_with(message("ATTITUDE", "int16", {"phi", "psi", "theta"})), "1.0 42 ATTITUDE 10 90 -20\n")
          .flights.at(0);
  const auto angles = euler_from_q_NB(flight.attitude.value.at(0));
  EXPECT_NEAR(angles.roll, 10 * 0.0174532925, 1e-8);
  EXPECT_NEAR(angles.pitch, -20 * 0.0174532925, 1e-8);
}

TEST(FlightFromPaparazzi, LeavesOutAFiltersVelocityWithoutAFix) {
  std::string data;
  for (int k = 0; k < 40; ++k) {
    if (k % 10 == 0) data += fix(1 + 0.1 * k, k < 20 ? 3 : 0, 0, 0, 0);
    data += fmt::format("{:.3f} 42 INS 256 512 -768 524288 0 0 0 0 0\n", 1.01 + 0.1 * k);
  }
  const auto content = read(log_with(gps_int + ins), data);
  const auto& flight = content.flights.at(0);
  EXPECT_EQ(flight.velocity.origin, VelocityOrigin::fused);
  EXPECT_EQ(flight.velocity.size(), 20u);
  EXPECT_EQ(flight.velocity.value[0], Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(flight.local_position.value[0], Eigen::Vector3d(1, 2, -3));
  ASSERT_EQ(flight.problems.size(), 1u);
  EXPECT_EQ(flight.problems[0].kind, Kind::doubtful);
}

TEST(FlightFromPaparazzi, HasNoVelocityWhereNoReceiverEverSpoke) {
  std::string data;
  for (int k = 0; k < 40; ++k) data += fmt::format("{:.3f} 42 INS 0 0 0 17825792 0 0 0 0 0\n", 1 + 0.1 * k);
  EXPECT_TRUE(read(log_with(ins), data).flights.at(0).velocity.empty()) << "34 m/s of drift";
}

TEST(FlightFromPaparazzi, HeedsTheFlagsOfTheWind) {
  const auto with_flags = message("WIND_INFO_RET", "float", {"flags", "east", "north", "up", "airspeed"});
  const auto without = message("WIND_INFO_RET", "float", {"east", "north", "airspeed"});
  const auto flagged =
      read(log_with(attitude + with_flags),
           "1.0 42 ATTITUDE 0 0 0\n1.1 42 WIND_INFO_RET 1 -1.7 -0.5 0. 0.\n1.2 42 WIND_INFO_RET 4 9. 9. 0. 0.\n");
  ASSERT_EQ(flagged.flights.at(0).autopilot_wind.size(), 1u);
  EXPECT_EQ(flagged.flights[0].autopilot_wind.value[0].v_NA_N, Eigen::Vector2d(-0.5, -1.7));
  const auto old = read(log_with(attitude + without), "1.0 42 ATTITUDE 0 0 0\n1.1 42 WIND_INFO_RET -1.7 -0.5 12.\n");
  EXPECT_EQ(old.flights.at(0).autopilot_wind.value.at(0).v_NA_N, Eigen::Vector2d(-0.5, -1.7));
}

TEST(FlightFromPaparazzi, ReadsTheFixedWingGpsMessage) {
  const auto gps = message(
      "GPS", "int32",
      {"mode", "utm_east", "utm_north", "course", "alt", "speed", "climb", "week", "itow", "utm_zone", "gps_nb_err"},
      "mm");
  std::string data;
  for (int k = 0; k < 10; ++k)
    data += fmt::format("{:.3f} 42 GPS 3 1 2 900 428924 200 50 2053 {} 31 0\n", 1 + 0.2 * k, 137377600 + 200 * k);
  const auto flight = read(log_with(gps, "fixedwing"), data).flights.at(0);
  EXPECT_LT((flight.velocity.value.at(0) - Eigen::Vector3d(0, 2, -0.5)).norm(), 1e-9);
  EXPECT_DOUBLE_EQ(flight.height_msl.value.at(0).m, 428.924);
  EXPECT_EQ(flight.vehicle.airframe, Airframe::fixed_wing);
  EXPECT_EQ(to_iso8601(*flight.clock.to_utc(LogTime{1'000'000'000})), to_iso8601(utc_from_gps(2053, 137377600)));
}

TEST(FlightFromPaparazzi, TakesTheWeekFromTheLogAndTheTimeFromGps) {
  std::string data;
  for (int k = 0; k < 10; ++k) data += fix(0.884, 3, 0, 0, 0);
  const auto clock = read(log_with(gps_int), data).flights.at(0).clock;
  EXPECT_EQ(to_iso8601(*clock.to_utc(LogTime{884'000'000}), 1), "2019-05-13T14:09:19.6Z");
  EXPECT_LT(clock.uncertainty_s, 1);
}

TEST(FlightFromPaparazzi, IsNotLedAstrayByAWrongDateOrAJumpOfTheReceiversClock) {
  const auto gps = message(
      "GPS", "int32",
      {"mode", "utm_east", "utm_north", "course", "alt", "speed", "climb", "week", "itow", "utm_zone", "gps_nb_err"},
      "mm");
  std::string data;
  for (int k = 0; k < 100; ++k) {
    const int week = k < 20 ? 1029 : k < 25 ? 0 : 2053, jump = k > 90 ? 4000 : 0;
    data += fmt::format("{:.3f} 42 GPS 3 1 2 900 428924 200 50 {} {} 31 0\n", 1 + 0.2 * k, week,
                        137377600 + 200 * k + jump);
  }
  const auto clock = read(log_with(gps), data).flights.at(0).clock;
  ASSERT_TRUE(clock.utc_minus_log);
  EXPECT_EQ(to_iso8601(*clock.to_utc(LogTime{1'000'000'000})), to_iso8601(utc_from_gps(2053, 137377600)));
  EXPECT_LT(clock.uncertainty_s, 0.11);
}

TEST(FlightFromPaparazzi, HasNoClockFromATimeOfDayThatWasNeverSet) {
  // File name 80_01_06: the ground station or the card began at the GPS epoch.
  auto log = log_with(gps_int);
  log.replace(log.find("1557756558.716"), 14, "315964800.0000");
  std::string data;
  for (int k = 0; k < 10; ++k) data += fix(1 + 0.2 * k, 3, 0, 0, 0);
  EXPECT_FALSE(read(log, data).flights.at(0).clock.utc_minus_log);
}

TEST(FlightFromPaparazzi, TellsHowLateFixesAreLogged) {
  std::string data;
  for (int k = 0; k < 100; ++k) {
    const double late = 0.01 * (k * 7 % 11);
    data += fmt::format("{:.3f} 42 GPS_INT 1 2 3 473565765 85189121 476264 428924 0 0 0 47 28 {} 79 14 3 1\n",
                        1 + 0.2 * k + late, 137377600 + 200 * k);
  }
  const auto velocity = read(log_with(gps_int), data).flights.at(0).velocity;
  ASSERT_TRUE(velocity.latency);
  EXPECT_NEAR(velocity.latency->median_s, 0.05, 0.002);
  EXPECT_TRUE(velocity.latency->at_least);
}

TEST(FlightFromPaparazzi, BelievesTheRotorcraftsOwnStatus) {
  const auto status = message("ROTORCRAFT_STATUS", "uint8", {"gps_status", "ap_in_flight", "ap_motors_on"});
  const auto flight = read(log_with(attitude + status),
                           "1.0 42 ATTITUDE 0 0 0\n1.1 42 ROTORCRAFT_STATUS 3 0 0\n"
                           "2.1 42 ROTORCRAFT_STATUS 3 1 1\n3.1 42 ROTORCRAFT_STATUS 3 0 1\n")
                          .flights.at(0);
  ASSERT_EQ(flight.landed.size(), 3u);
  EXPECT_TRUE(flight.landed.value[0]);
  EXPECT_FALSE(flight.landed.value[1]);
  EXPECT_TRUE(flight.landed.value[2]);
}

TEST(FlightFromPaparazzi, ChoosesOneAircraftAndSaysSo) {
  const std::string data = "1.0 42 ATTITUDE 0 0 0\n1.1 42 ATTITUDE 0 0 0\n1.2 43 ATTITUDE 1 0 0\n";
  const auto content = read(log_with(attitude), data);
  EXPECT_EQ(content.flights.at(0).attitude.size(), 2u);
  EXPECT_EQ(content.problems.at(0).kind, Kind::doubtful);
  EXPECT_EQ(read(log_with(attitude), data, {Reading::tolerant, "43"}).flights.at(0).attitude.size(), 1u);
}

TEST(FlightFromPaparazzi, DropsLinesThatDoNotFitTheDefinition) {
  const std::string data = "1.0 42 ATTITUDE 0 0 0\n1.1 42 ATTITUDE 0 0\n1.2 42 ATTITUDE 0 0 0 0\n";
  const auto content = read(log_with(attitude), data);
  EXPECT_EQ(content.flights.at(0).attitude.size(), 1u);
  ASSERT_EQ(content.problems.size(), 1u);
  EXPECT_EQ(content.problems[0].kind, Kind::damaged);
  EXPECT_EQ(content.problems[0].where.line, 2u);
  EXPECT_FALSE(read_paparazzi(as_bytes(data), as_bytes(log_with(attitude)), "x", {Reading::strict, {}}));
}

}  // namespace
}  // namespace quadsonde::ingest
