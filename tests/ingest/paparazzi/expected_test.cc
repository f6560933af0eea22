// Every count and value of EXPECTED_COUNTS.json for Paparazzi (an own line parser and awk agree on them).
#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "ingest/flight/local_frame.h"
#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "ingest/paparazzi/paparazzi_reader.h"
#include "tests/ingest/dataflash/esc_flight_csv.h"

namespace quadsonde::ingest {
namespace {

std::vector<std::uint8_t> file(const std::string& name) {
  return support::read_bytes(support::data_file("logs/" + name));
}

class PaparazziSample : public ::testing::TestWithParam<const char*> {};

TEST_P(PaparazziSample, HasTheCountsAndLinesOfAnIndependentParser) {
  const std::string name = GetParam();
  QUADSONDE_NEEDS_DATA("logs/" + name);
  const auto want = nlohmann::json::parse(std::ifstream(support::data_file("logs/EXPECTED_COUNTS.json"))).at(name);
  const auto data = file(name);
  const auto content = read_paparazzi(data, std::nullopt, name).value();
  EXPECT_EQ(content.messages, want.at("lines"));
  nlohmann::json counts = nlohmann::json::object(), aircraft = nlohmann::json::object();
  for (const auto& topic : content.topics) counts[topic.name] = topic.messages;
  EXPECT_EQ(counts, want.at("counts"));

  PaparazziLineReader reader(data);
  PaparazziLine line;
  std::map<std::string, std::string> first, last;
  std::map<std::string, int> by_aircraft;
  std::int64_t first_ns = -1, last_ns = 0;
  int backward = 0;
  while (reader.next(line)) {
    ++by_aircraft[std::string(line.aircraft)];
    if (first_ns < 0) first_ns = line.time.ns;
    if (line.time.ns < last_ns) ++backward;
    last_ns = line.time.ns;
    const auto from = as_text(data).substr(line.at);
    const std::string text(from.substr(0, from.find('\n')));
    first.try_emplace(std::string(line.name), text);
    last[std::string(line.name)] = text;
  }
  for (const auto& [id, lines] : by_aircraft) aircraft[id] = lines;
  EXPECT_EQ(aircraft, want.at("aircraft"));
  EXPECT_EQ(reader.unparsable(), want.at("unparsable"));
  EXPECT_EQ(backward, want.at("backward_time_steps"));
  EXPECT_EQ(static_cast<double>(first_ns) / 1e9, want.at("first_time_s"));
  EXPECT_EQ(static_cast<double>(last_ns) / 1e9, want.at("last_time_s"));
  for (const auto& [message, lines] : want.at("samples").items()) {
    EXPECT_EQ(first.at(message), lines.at("first"));
    EXPECT_EQ(last.at(message), lines.at("last"));
  }
}

INSTANTIATE_TEST_SUITE_P(All, PaparazziSample,
                         ::testing::Values("derived/esc_flight.data", "paparazzi/09_05_13__14_38_13.data",
                                           "paparazzi/20_06_02__14_19_30.data", "paparazzi/80_01_06__06_58_24_SD.data"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (auto& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

TEST(PaparazziFlight, IsTheFlightThatItWasMadeOf) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.data");
  const auto content = read_paparazzi(file("derived/esc_flight.data"), file("derived/esc_flight.log"), "x").value();
  ASSERT_EQ(content.flights.size(), 1u);
  const auto& flight = content.flights[0];
  const auto rows = support::esc_flight_rows();
  ASSERT_EQ(flight.local_position.size(), rows.size());
  constexpr double slack = 0.0011;  // times have whole milliseconds
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const LogTime t = flight.local_position.time[i];
    EXPECT_NEAR(static_cast<double>(flight.clock.to_utc(t)->ns) * 1e-9, row.at("utc_us") * 1e-6, 0.02);
    const Eigen::Vector3d p(row.at("x_m"), row.at("y_m"), row.at("z_m"));
    EXPECT_LT((flight.local_position.value[i] - p).cwiseAbs().maxCoeff(), 0.0021) << "half a step of 2^-8 m";
    const Eigen::Quaterniond q(row.at("qw"), row.at("qx"), row.at("qy"), row.at("qz"));
    EXPECT_LT(support::angle_between(support::last_value(flight.attitude, t, slack), q), 2e-4);
  }
  EXPECT_EQ(flight.vehicle.name, "DERIVED_QUAD");
  EXPECT_EQ(flight.vehicle.firmware, "quadsonde fixture");
  EXPECT_EQ(flight.vehicle.airframe, Airframe::multirotor);
  EXPECT_TRUE(content.problems.empty());
}

TEST(PaparazziFlight, ScalesWithExactPowersOfTwo) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.data");
  // Without GPS_INT velocities the filter's come out: 2^-19 m/s returns the table's values, the coefficient that
  // the .log prints (0.0000019) would be off by up to 22 mm/s (LOGS.md section 8).
  const auto data = file("derived/esc_flight.data");
  std::string filter_only;
  PaparazziLineReader reader(data);
  PaparazziLine line;
  int fixes = 0;
  while (reader.next(line)) {
    if (line.name == "GPS_INT" && fixes++ % 5 != 0) continue;
    filter_only += fmt::format("{}.{:03} 42 {} {}\n", line.time.ns / 1'000'000'000, line.time.ns / 1'000'000 % 1000,
                               line.name, line.values);
  }
  const auto content = read_paparazzi(as_bytes(filter_only), file("derived/esc_flight.log"), "x").value();
  const auto& velocity = content.flights.at(0).velocity;
  const auto rows = support::esc_flight_rows();
  EXPECT_EQ(velocity.origin, VelocityOrigin::fused);
  ASSERT_EQ(velocity.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector3d v(rows[i].at("vn_m_s"), rows[i].at("ve_m_s"), rows[i].at("vd_m_s"));
    EXPECT_LT((velocity.value[i] - v).cwiseAbs().maxCoeff(), 6e-5) << "the table has 4 decimals";
  }
}

TEST(PaparazziFlight, OfAFixedWingSaysSo) {
  QUADSONDE_NEEDS_DATA("logs/paparazzi/09_05_13__14_38_13.data");
  const auto content =
      read_paparazzi(file("paparazzi/09_05_13__14_38_13.data"), file("paparazzi/09_05_13__14_38_13.log"), "x").value();
  ASSERT_EQ(content.flights.size(), 1u);
  EXPECT_EQ(content.flights[0].vehicle.airframe, Airframe::fixed_wing);
  EXPECT_EQ(content.flights[0].vehicle.name, "HITLUSB");
  EXPECT_EQ(content.flights[0].attitude.size(), 98u);
}

TEST(PaparazziFlight, NeedsTheLogBesideTheData) {
  QUADSONDE_NEEDS_DATA("logs/paparazzi/80_01_06__06_58_24_SD.data");
  const auto content = read_paparazzi(file("paparazzi/80_01_06__06_58_24_SD.data"), std::nullopt, "80.data").value();
  EXPECT_TRUE(content.flights.empty());
  ASSERT_EQ(content.problems.size(), 1u);
  EXPECT_EQ(content.problems[0].kind, Kind::missing);
  EXPECT_NE(content.problems[0].what.find(".log"), std::string::npos);
}

}  // namespace
}  // namespace quadsonde::ingest
