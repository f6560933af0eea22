// Every count and value of EXPECTED_COUNTS.json for DataFlash (pymavlink's reader and an own one agree on them).
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "ingest/dataflash/dataflash_reader.h"
#include "ingest/dataflash/flight_from_dataflash.h"
#include "tests/ingest/dataflash/esc_flight_csv.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

class DataflashSample : public ::testing::TestWithParam<const char*> {
 protected:
  std::string name() const { return GetParam(); }
  std::vector<std::uint8_t> bytes() const { return support::read_bytes(support::data_file("logs/" + name())); }
  nlohmann::json expected() const {
    return nlohmann::json::parse(std::ifstream(support::data_file("logs/EXPECTED_COUNTS.json"))).at(name());
  }
};

/// The numbers of the reference have the letter's implied scale only, and floats rounded to 7 decimals.
double as_in_the_reference(const DataflashMessage& message, const DataflashField& field) {
  const bool implied = std::string_view("cCeEL").find(field.code) != std::string_view::npos;
  return implied ? message.scaled(field) : message.raw(field);
}

TEST_P(DataflashSample, HasTheCountsOfAnIndependentDecoder) {
  QUADSONDE_NEEDS_DATA("logs/" + name());
  const auto want = expected();
  const auto content = read_dataflash(bytes(), name()).value();
  EXPECT_EQ(content.messages, want.at("total"));
  nlohmann::json counts = nlohmann::json::object();
  for (const auto& topic : content.topics) counts[topic.name] = topic.messages;
  EXPECT_EQ(counts, want.at("counts"));

  const auto data = bytes();
  DataflashReader reader(data);
  DataflashMessage message;
  while (reader.next(message)) {
  }
  EXPECT_EQ(reader.skipped_bytes(), want.at("own_skipped_bytes"));
  EXPECT_EQ(reader.losses(), want.at("own_resyncs"));
  EXPECT_EQ(reader.trailing_partial_bytes(), want.at("trailing_partial_bytes"));
}

TEST_P(DataflashSample, HasTheValuesOfAnIndependentDecoder) {
  QUADSONDE_NEEDS_DATA("logs/" + name());
  const auto want = expected();
  const auto data = bytes();
  DataflashReader reader(data);
  DataflashMessage message;
  std::map<std::string, std::uint64_t> row;
  std::size_t checked = 0;
  while (reader.next(message)) {
    const auto& topic = message.layout->name;
    if (!want.at("samples").contains(topic)) continue;
    const auto at = row[topic]++;
    const auto count = want.at("counts").at(topic).get<std::uint64_t>();
    for (const auto& [place, index] : {std::pair("first", std::uint64_t{0}), {"mid", count / 2}, {"last", count - 1}}) {
      if (at != index) continue;
      for (const auto& [label, value] : want.at("samples").at(topic).at(place).items()) {
        SCOPED_TRACE(topic + "." + label + " " + place);
        const auto* field = message.layout->find(label);
        ASSERT_NE(field, nullptr);
        const double expected_value = value.get<double>();
        EXPECT_NEAR(as_in_the_reference(message, *field), expected_value, 6e-8 + 1e-7 * std::abs(expected_value));
        ++checked;
      }
    }
  }
  EXPECT_GE(checked, 100u);
}

INSTANTIATE_TEST_SUITE_P(All, DataflashSample,
                         ::testing::Values("dataflash/copter344_quad_log_0036.bin",
                                           "dataflash/copter364_quad_sample.bin", "dataflash/pymavlink_test_plane.BIN",
                                           "dataflash/spark404_log.bin", "derived/esc_flight.bin",
                                           "derived/esc_flight_damaged.bin"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (auto& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

Flight only_flight(const std::string& name) {
  const auto data = support::read_bytes(support::data_file("logs/" + name));
  auto content = read_dataflash(data, name).value();
  EXPECT_EQ(content.flights.size(), 1u);
  return content.flights.at(0);
}

TEST(DataflashFlight, IsTheFlightThatItWasMadeOf) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.bin");
  const auto flight = only_flight("derived/esc_flight.bin");
  const auto rows = support::esc_flight_rows();
  ASSERT_EQ(flight.local_position.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const LogTime t = flight.local_position.time[i];
    EXPECT_NEAR(static_cast<double>(t.ns) * 1e-9, row.at("time_s"), 1e-6);
    // The clock has the GPS's whole milliseconds.
    EXPECT_NEAR(static_cast<double>(flight.clock.to_utc(t)->ns) * 1e-3, row.at("utc_us"), 1500);
    const Eigen::Vector3d p(row.at("x_m"), row.at("y_m"), row.at("z_m"));
    EXPECT_LT((flight.local_position.value[i] - p).cwiseAbs().maxCoeff(), 6e-5) << "the table has 4 decimals";
    const Eigen::Quaterniond q(row.at("qw"), row.at("qx"), row.at("qy"), row.at("qz"));
    EXPECT_LT(support::angle_between(support::last_value(flight.attitude, t), q), 0.012) << "three angles of 0.01 deg";
    EXPECT_NEAR(support::last_value(flight.position, t).lat_deg, row.at("lat_deg"), 1e-7);
    EXPECT_NEAR(support::last_value(flight.position, t).lon_deg, row.at("lon_deg"), 1e-7);
    EXPECT_NEAR(support::last_value(flight.height_msl, t).m, row.at("alt_msl_m"), 0.0051) << "0.01 m steps";
    EXPECT_NEAR(*support::last_value(flight.barometer, t).pressure_pa, row.at("baro_pa"), 0.5);
  }
  EXPECT_EQ(flight.velocity.origin, VelocityOrigin::receiver);
  EXPECT_EQ(flight.velocity.sd.size(), flight.velocity.size());
  EXPECT_NEAR(flight.velocity.sd.front(), 0.28, 0.006);
  EXPECT_NEAR(flight.height_ellipsoid.value.front().m, 476.264, 0.006);
  EXPECT_EQ(flight.vehicle.airframe, Airframe::multirotor);
  EXPECT_EQ(flight.vehicle.rotors, 4);
}

TEST(DataflashFlight, HasTheAutopilotsWindWhereItBlowsTo) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.bin");
  const auto flight = only_flight("derived/esc_flight.bin");
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& wind : flight.autopilot_wind.value) mean += wind.v_NA_N;
  mean /= static_cast<double>(flight.autopilot_wind.size());
  // LOGS.md section 6: the on-board estimate averages N -0.51, E -1.72 m/s.
  EXPECT_NEAR(mean.x(), -0.51, 0.006);
  EXPECT_NEAR(mean.y(), -1.72, 0.006);
}

TEST(DataflashFlight, OfTheDamagedSampleLosesOnlyTheMessagesItMust) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight_damaged.bin");
  const auto whole = only_flight("derived/esc_flight.bin"), damaged = only_flight("derived/esc_flight_damaged.bin");
  EXPECT_EQ(damaged.attitude.time, whole.attitude.time);
  EXPECT_EQ(damaged.local_position.time, whole.local_position.time);
  EXPECT_EQ(damaged.barometer.time, whole.barometer.time);
  EXPECT_EQ(damaged.velocity.size() + 1, whole.velocity.size());
  for (const auto& v : damaged.velocity.value) EXPECT_LT(v.norm(), 8) << "none of the garbage came through";
  ASSERT_EQ(damaged.problems.size(), 1u);
  EXPECT_EQ(damaged.problems[0].where.topic, "GPS");
}

TEST(DataflashFlight, OfRealCoptersIsRecognised) {
  QUADSONDE_NEEDS_DATA("logs/dataflash/spark404_log.bin");
  for (const auto* name : {"copter344_quad_log_0036.bin", "copter364_quad_sample.bin", "spark404_log.bin"}) {
    const auto flight = only_flight(std::string("dataflash/") + name);
    EXPECT_EQ(flight.vehicle.airframe, Airframe::multirotor) << name;
    EXPECT_EQ(flight.vehicle.rotors, 4) << name;
    EXPECT_FALSE(flight.vehicle.simulated);
    EXPECT_EQ(flight.velocity.origin, VelocityOrigin::receiver);
    EXPECT_TRUE(flight.autopilot_wind.empty()) << "zeros are no wind";
    EXPECT_FALSE(flight.landed.empty());
    EXPECT_TRUE(flight.problems.empty()) << to_string(flight.problems.front());
  }
  EXPECT_EQ(only_flight("dataflash/pymavlink_test_plane.BIN").vehicle.airframe, Airframe::fixed_wing);
}

TEST(DataflashFlight, CountsTheLeapSecondsOfItsDay) {
  QUADSONDE_NEEDS_DATA("logs/dataflash/copter364_quad_sample.bin");
  // Worked values of LOGS.md section 7; 2016 has 17 leap seconds.
  const auto copter364 = only_flight("dataflash/copter364_quad_sample.bin");
  EXPECT_EQ(to_iso8601(*copter364.clock.to_utc(LogTime{208'734'295'000}), 1).substr(0, 19), "2019-03-27T14:53:18");
  const auto spark404 = only_flight("dataflash/spark404_log.bin");
  EXPECT_EQ(to_iso8601(*spark404.clock.to_utc(LogTime{402'735'374'000}), 1).substr(0, 19), "2017-09-10T10:49:22");
  const auto copter344 = only_flight("dataflash/copter344_quad_log_0036.bin");
  const UtcTime first = utc_from_gps(1928, 483338600);
  EXPECT_LT(std::abs(to_seconds(*copter344.clock.to_utc(LogTime{224'714'179'000}) - first)), 0.2);
  EXPECT_EQ(gps_minus_utc_s(1928LL * 604800 + 483338), 17);
}

}  // namespace
}  // namespace quadsonde::ingest
