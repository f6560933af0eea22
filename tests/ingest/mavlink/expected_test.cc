// Every count and value of EXPECTED_COUNTS.json for MAVLink (pymavlink and an own decoder agree on them).
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "ingest/flight/rotation.h"
#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/mavlink/tlog_reader.h"
#include "tests/ingest/dataflash/esc_flight_csv.h"

namespace quadsonde::ingest {
namespace {

class TlogSample : public ::testing::TestWithParam<const char*> {
 protected:
  std::string name() const { return GetParam(); }
  std::vector<std::uint8_t> bytes() const { return support::read_bytes(support::data_file("logs/" + name())); }
  nlohmann::json expected() const {
    return nlohmann::json::parse(std::ifstream(support::data_file("logs/EXPECTED_COUNTS.json"))).at(name());
  }
};

TEST_P(TlogSample, HasTheCountsOfAnIndependentDecoder) {
  QUADSONDE_NEEDS_DATA("logs/" + name());
  const auto want = expected();
  const auto data = bytes();
  const auto content = read_mavlink(data, name()).value();
  EXPECT_EQ(content.messages, want.at("good_frames"));
  nlohmann::json counts = nlohmann::json::object(), sources = nlohmann::json::object(),
                 versions = nlohmann::json::object();
  for (const auto& topic : content.topics) counts[topic.name] = topic.messages;
  EXPECT_EQ(counts, want.at("counts"));

  TlogReader reader(data);
  TlogRecord record;
  std::uint64_t first = 0, last = 0;
  std::map<std::string, int> by_source, by_version;
  while (reader.next(record)) {
    if (first == 0) first = record.time_us;
    last = record.time_us;
    ++by_source[std::to_string(record.frame.system) + "/" + std::to_string(record.frame.component)];
    ++by_version[std::to_string(record.frame.version)];
  }
  for (const auto& [source, frames] : by_source) sources[source] = frames;
  for (const auto& [version, frames] : by_version) versions[version] = frames;
  EXPECT_EQ(sources, want.at("sources"));
  EXPECT_EQ(versions, want.at("frames_by_version"));
  EXPECT_EQ(first, want.at("first_tlog_us"));
  EXPECT_EQ(last, want.at("last_tlog_us"));
  EXPECT_EQ(reader.signed_frames(), want.at("signed_frames"));
  EXPECT_EQ(reader.rejected(), want.at("own_bad_crc_or_unknown_frames"));
  EXPECT_EQ(reader.skipped_bytes() + reader.trailing_partial_bytes(), want.at("own_skipped_bytes"));
}

void check_field(const MavlinkField& field, const std::uint8_t* payload, std::size_t index,
                 const nlohmann::json& want) {
  if (want.is_string())
    EXPECT_TRUE(std::isnan(field.number(payload, index))) << field.name;
  else
    EXPECT_DOUBLE_EQ(field.number(payload, index), want.get<double>()) << field.name;
}

TEST_P(TlogSample, HasTheValuesOfAnIndependentDecoder) {
  QUADSONDE_NEEDS_DATA("logs/" + name());
  const auto want = expected();
  const auto data = bytes();
  TlogReader reader(data);
  TlogRecord record;
  std::map<std::string, std::uint64_t> row;
  std::size_t checked = 0;
  while (reader.next(record)) {
    const std::string topic(record.frame.info->name);
    if (!want.at("samples").contains(topic)) continue;
    const auto at = row[topic]++;
    const auto count = want.at("counts").at(topic).get<std::uint64_t>();
    for (const auto& [place, index] : {std::pair("first", std::uint64_t{0}), {"last", count - 1}}) {
      if (at != index) continue;
      const auto& values = want.at("samples").at(topic).at(place);
      EXPECT_EQ(record.time_us, values.at("_tlog_us"));
      const PaddedPayload payload(record.frame);
      for (const auto& field : mavlink_fields(*record.frame.info)) {
        SCOPED_TRACE(topic + " " + place);
        const auto& value = values.at(std::string(field.name));
        if (value.is_array())
          for (std::size_t i = 0; i < value.size(); ++i) check_field(field, payload.data(), i, value[i]);
        else
          check_field(field, payload.data(), 0, value);
        ++checked;
      }
    }
  }
  EXPECT_GE(checked, 10u);
}

INSTANTIATE_TEST_SUITE_P(All, TlogSample,
                         ::testing::Values("derived/esc_flight_v2.tlog", "derived/esc_flight_v2_signed_800.tlog",
                                           "tlog/dronekit_quad_flight.tlog", "tlog/pymavlink_v2_battery_status.tlog",
                                           "tlog/uavlogviewer_vtol_sitl.tlog"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (auto& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

LogContent content_of(const std::string& name) {
  const auto data = support::read_bytes(support::data_file("logs/" + name));
  return read_mavlink(data, name).value();
}

TEST(MavlinkFlight, IsTheFlightThatItWasMadeOf) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight_v2.tlog");
  const auto content = content_of("derived/esc_flight_v2.tlog");
  ASSERT_EQ(content.flights.size(), 1u);
  const auto& flight = content.flights[0];
  const auto rows = support::esc_flight_rows();
  ASSERT_EQ(flight.local_position.size(), rows.size());
  constexpr double slack = 0.002;  // two times cut to whole milliseconds
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const LogTime t = flight.local_position.time[i];
    EXPECT_NEAR(static_cast<double>(t.ns) * 1e-9, row.at("time_s"), 0.001);
    EXPECT_NEAR(static_cast<double>(flight.clock.to_utc(t)->ns) * 1e-9, row.at("utc_us") * 1e-6, 0.02);
    const Eigen::Vector3d p(row.at("x_m"), row.at("y_m"), row.at("z_m"));
    EXPECT_LT((flight.local_position.value[i] - p).cwiseAbs().maxCoeff(), 6e-5) << "the table has 4 decimals";
    const Eigen::Quaterniond q(row.at("qw"), row.at("qx"), row.at("qy"), row.at("qz"));
    EXPECT_LT(support::angle_between(support::last_value(flight.attitude, t, slack), q), 1e-4);
    const double before = *support::last_value(flight.barometer, t).pressure_pa;
    const double with_slack = *support::last_value(flight.barometer, t, slack).pressure_pa;
    EXPECT_TRUE(std::abs(before - row.at("baro_pa")) < 0.5 || std::abs(with_slack - row.at("baro_pa")) < 0.5);
  }
  EXPECT_EQ(flight.velocity.sd.size(), flight.velocity.size());
  EXPECT_EQ(flight.vehicle.airframe, Airframe::multirotor);
  EXPECT_EQ(flight.vehicle.rotors, 4);
  EXPECT_TRUE(content.problems.empty());
}

TEST(MavlinkFlight, HasTheSameWindFromBothOfItsMessages) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight_v2.tlog");
  auto bytes = support::read_bytes(support::data_file("logs/derived/esc_flight_v2.tlog"));
  const auto with_cov = read_mavlink(bytes, "x").value().flights.at(0).autopilot_wind;
  EXPECT_EQ(with_cov.source, "WIND_COV wind_x wind_y");
  ASSERT_TRUE(with_cov.value.front().sd);
  // The same file without its WIND_COV frames.
  TlogReader reader(bytes);
  TlogRecord record;
  std::vector<std::uint8_t> without;
  for (std::size_t from = 0; reader.next(record); from = reader.at())
    if (record.frame.info->name != "WIND_COV")
      without.insert(without.end(), bytes.begin() + static_cast<std::ptrdiff_t>(from),
                     bytes.begin() + static_cast<std::ptrdiff_t>(reader.at()));
  const auto from = read_mavlink(without, "x").value().flights.at(0).autopilot_wind;
  EXPECT_EQ(from.source, "WIND direction speed");
  ASSERT_EQ(from.size(), with_cov.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    EXPECT_LT((from.value[i].v_NA_N - with_cov.value[i].v_NA_N).norm(), 1e-5) << "from there is toward here";
  EXPECT_LT(std::abs(to_seconds(from.time[0] - with_cov.time[0])), 0.02);
}

TEST(MavlinkFlight, SignedFramesSayTheSame) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight_v2_signed_800.tlog");
  const auto whole = content_of("derived/esc_flight_v2.tlog").flights.at(0);
  const auto part = content_of("derived/esc_flight_v2_signed_800.tlog").flights.at(0);
  ASSERT_GT(part.local_position.size(), 60u);
  for (std::size_t i = 0; i < part.local_position.size(); ++i)
    EXPECT_EQ(part.local_position.value[i], whole.local_position.value[i]);
}

TEST(MavlinkFlight, OfARealCopterHasTwoBootsAndOneVehicle) {
  QUADSONDE_NEEDS_DATA("logs/tlog/dronekit_quad_flight.tlog");
  const auto content = content_of("tlog/dronekit_quad_flight.tlog");
  ASSERT_EQ(content.flights.size(), 2u);
  EXPECT_EQ(content.flights[0].attitude.size() + content.flights[1].attitude.size(), 2829u);
  for (const auto& flight : content.flights) {
    EXPECT_EQ(flight.vehicle.airframe, Airframe::multirotor);
    for (const auto& point : flight.position.value) EXPECT_NEAR(point.lat_deg, -35.363, 0.01);
    for (const auto& v : flight.velocity.value) EXPECT_LT(v.norm(), 10);
    for (const auto& f : flight.accelerometer.value) EXPECT_LT(f.norm(), 40);
  }
  EXPECT_EQ(content.flights[1].attitude.time.front().ns, 18'951'000'000);
  // PROVENANCE.md: the host's clock is 1.43 s early against GPS.
  const auto utc = content.flights[1].clock.to_utc(LogTime{816'471'000'000});
  EXPECT_NEAR(static_cast<double>(utc->ns) * 1e-9, 1436057056.945, 0.5);
}

TEST(MavlinkFlight, OfASimulatedQuadplaneSaysSo) {
  QUADSONDE_NEEDS_DATA("logs/tlog/uavlogviewer_vtol_sitl.tlog");
  const auto flight = content_of("tlog/uavlogviewer_vtol_sitl.tlog").flights.at(0);
  EXPECT_EQ(flight.vehicle.airframe, Airframe::vtol);
  EXPECT_TRUE(flight.vehicle.simulated);
  EXPECT_TRUE(flight.autopilot_wind.empty()) << "zeros are no wind";
}

}  // namespace
}  // namespace quadsonde::ingest
