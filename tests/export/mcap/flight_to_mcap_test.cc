#include "export/mcap/flight_to_mcap.h"

#include <bit>
#include <set>

#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/mcap/reader.h"
#include "sample_flight.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using ingest::Flight;
using product::FlightFileSettings;
using support::sample_flight;

std::vector<std::uint8_t> written(const Flight& flight, const FlightFileSettings& settings = {},
                                  const ingest::Truth& truth = {}) {
  ingest::mcap::MemorySink sink;
  const auto done = product::write_flight(sink, flight, settings, truth);
  EXPECT_TRUE(done) << (done ? "" : to_string(done.error()));
  return sink.bytes();
}

Flight read_back(const std::vector<std::uint8_t>& bytes) {
  const auto content = ingest::read_mcap(bytes, "test.mcap", {ingest::Reading::strict, true, {}});
  EXPECT_TRUE(content) << (content ? "" : to_string(content.error()));
  if (!content || content->flights.size() != 1) {
    ADD_FAILURE() << "no flight came back";
    return {};
  }
  EXPECT_TRUE(content->problems.empty()) << to_string(content->problems.front());
  return content->flights.front();
}

template <class S>
void expect_same_times(const S& a, const S& b, const char* name) {
  EXPECT_EQ(a.source, b.source) << name;
  EXPECT_EQ(a.time, b.time) << name;
  ASSERT_EQ(a.value.size(), b.value.size()) << name;
}

/// Equal to the bit: what is NaN there is NaN here.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}

void expect_same_motion(const Flight& a, const Flight& b) {
  expect_same_times(a.attitude, b.attitude, "attitude");
  for (std::size_t i = 0; i < a.attitude.size(); ++i)
    EXPECT_TRUE(a.attitude.value[i].coeffs() == b.attitude.value[i].coeffs());
  expect_same_times(a.velocity, b.velocity, "velocity");
  EXPECT_EQ(a.velocity.value, b.velocity.value);
  EXPECT_EQ(a.velocity.sd, b.velocity.sd);
  EXPECT_EQ(a.velocity.origin, b.velocity.origin);
  expect_same_times(a.local_position, b.local_position, "local position");
  EXPECT_EQ(a.local_position.value, b.local_position.value);
  expect_same_times(a.accelerometer, b.accelerometer, "accelerometer");
  EXPECT_EQ(a.accelerometer.value, b.accelerometer.value);
}

void expect_same_place(const Flight& a, const Flight& b) {
  expect_same_times(a.position, b.position, "position");
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    EXPECT_EQ(a.position.value[i].lat_deg, b.position.value[i].lat_deg);
    EXPECT_EQ(a.position.value[i].lon_deg, b.position.value[i].lon_deg);
  }
  expect_same_times(a.height_msl, b.height_msl, "MSL");
  EXPECT_EQ(a.height_msl.value, b.height_msl.value);
  expect_same_times(a.height_ellipsoid, b.height_ellipsoid, "ellipsoid");
  EXPECT_EQ(a.height_ellipsoid.value, b.height_ellipsoid.value);
  expect_same_times(a.height_ground, b.height_ground, "ground");
  EXPECT_EQ(a.height_ground.value, b.height_ground.value);
  ASSERT_EQ(a.origin.has_value(), b.origin.has_value());
  EXPECT_EQ(a.origin->point.lat_deg, b.origin->point.lat_deg);
  EXPECT_EQ(a.origin->point.lon_deg, b.origin->point.lon_deg);
  EXPECT_EQ(a.origin->height_msl, b.origin->height_msl);
}

void expect_same_sensors(const Flight& a, const Flight& b) {
  expect_same_times(a.barometer, b.barometer, "barometer");
  expect_same_times(a.rotors, b.rotors, "rotors");
  expect_same_times(a.air, b.air, "air");
  expect_same_times(a.autopilot_wind, b.autopilot_wind, "wind");
  for (std::size_t i = 0; i < a.barometer.size(); ++i) {
    EXPECT_TRUE(same(a.barometer.value[i].pressure_pa, b.barometer.value[i].pressure_pa));
    EXPECT_TRUE(same(a.barometer.value[i].altitude_m, b.barometer.value[i].altitude_m));
    EXPECT_TRUE(same(a.air.value[i].temperature_k, b.air.value[i].temperature_k));
    EXPECT_TRUE(same(a.air.value[i].relative_humidity_pct, b.air.value[i].relative_humidity_pct));
    EXPECT_TRUE(same(a.air.value[i].pressure_pa, b.air.value[i].pressure_pa));
    EXPECT_EQ(a.autopilot_wind.value[i].v_NA_N, b.autopilot_wind.value[i].v_NA_N);
    EXPECT_TRUE(same(a.autopilot_wind.value[i].sd, b.autopilot_wind.value[i].sd));
    ASSERT_EQ(a.rotors.value[i].size(), b.rotors.value[i].size());
    for (std::size_t k = 0; k < a.rotors.value[i].size(); ++k)
      EXPECT_TRUE(a.rotors.value[i][k] == b.rotors.value[i][k] ||
                  (std::isnan(a.rotors.value[i][k]) && std::isnan(b.rotors.value[i][k])));
  }
}

void expect_same_story(const Flight& a, const Flight& b) {
  expect_same_times(a.events, b.events, "events");
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    EXPECT_EQ(a.events.value[i].what, b.events.value[i].what);
    EXPECT_EQ(a.events.value[i].text, b.events.value[i].text);
  }
  expect_same_times(a.landed, b.landed, "landed");
  EXPECT_EQ(a.landed.value, b.landed.value);
  ASSERT_EQ(a.gaps.size(), b.gaps.size());
  for (std::size_t i = 0; i < a.gaps.size(); ++i) {
    EXPECT_EQ(a.gaps[i].from, b.gaps[i].from);
    EXPECT_EQ(a.gaps[i].to, b.gaps[i].to);
  }
  ASSERT_EQ(a.problems.size(), b.problems.size());
  for (std::size_t i = 0; i < a.problems.size(); ++i) {
    EXPECT_EQ(a.problems[i].kind, b.problems[i].kind);
    EXPECT_EQ(to_string(a.problems[i]), to_string(b.problems[i]));
  }
}

void expect_same_identity(const Flight& a, const Flight& b) {
  EXPECT_EQ(a.clock.utc_minus_log, b.clock.utc_minus_log);
  EXPECT_TRUE(same(a.clock.uncertainty_s, b.clock.uncertainty_s));
  EXPECT_EQ(a.clock.source, b.clock.source);
  EXPECT_EQ(a.vehicle.name, b.vehicle.name);
  EXPECT_EQ(a.vehicle.autopilot, b.vehicle.autopilot);
  EXPECT_EQ(a.vehicle.firmware, b.vehicle.firmware);
  EXPECT_EQ(a.vehicle.airframe, b.vehicle.airframe);
  EXPECT_EQ(a.vehicle.rotors, b.vehicle.rotors);
  EXPECT_EQ(a.vehicle.simulated, b.vehicle.simulated);
  EXPECT_TRUE(same(a.vehicle.mass_kg, b.vehicle.mass_kg));
}

void expect_same(const Flight& a, const Flight& b) {
  expect_same_motion(a, b);
  expect_same_place(a, b);
  expect_same_sensors(a, b);
  expect_same_story(a, b);
  expect_same_identity(a, b);
}

TEST(FlightToMcap, GivesEveryStreamBackToTheBit) { expect_same(sample_flight(), read_back(written(sample_flight()))); }

TEST(FlightToMcap, GivesEveryStreamBackToTheBitAsJson) {
  FlightFileSettings settings;
  settings.encoding = FlightFileSettings::Encoding::json;
  expect_same(sample_flight(), read_back(written(sample_flight(), settings)));
}

TEST(FlightToMcap, GivesEveryStreamBackWithEveryCompression) {
  for (const auto compression : {FlightFileSettings::Compression::none, FlightFileSettings::Compression::lz4}) {
    FlightFileSettings settings;
    settings.compression = compression;
    expect_same(sample_flight(), read_back(written(sample_flight(), settings)));
  }
}

TEST(FlightToMcap, KeepsTheLogClockWhereUtcIsUnknown) {
  const auto flight = sample_flight(false);
  const auto back = read_back(written(flight));
  EXPECT_FALSE(back.clock.utc_minus_log);
  expect_same(flight, back);
}

TEST(FlightToMcap, KeepsTimesBeforeTheOriginOfTheClock) {
  Flight flight = sample_flight(false);
  for (auto& t : flight.attitude.time) t = t - ingest::seconds(1000);
  expect_same(flight, read_back(written(flight)));
}

TEST(FlightToMcap, KeepsTheLogClockOfAFlightBefore1970) {
  Flight flight = sample_flight();
  flight.clock.utc_minus_log = ingest::Duration(-5'000'000'000'000LL);
  expect_same(flight, read_back(written(flight)));
}

TEST(FlightToMcap, WritesUtcAsLogTimeWhereTheClockIsKnown) {
  const auto flight = sample_flight();
  const auto bytes = written(flight);
  ingest::mcap::RecordReader reader(bytes);
  ingest::mcap::Record record;
  std::optional<std::uint64_t> first;
  while (reader.next(record))
    if (record.op == ingest::mcap::Op::message && !first) first = record.message().log_time;
  EXPECT_EQ(static_cast<std::int64_t>(first.value_or(0)), flight.clock.to_utc(flight.attitude.time.front())->ns);
}

TEST(FlightToMcap, WritesTheSameBytesForTheSameFlight) {
  EXPECT_EQ(written(sample_flight(), {}, support::sample_truth()), written(sample_flight(), {}, support::sample_truth()));
}

TEST(FlightToMcap, GivesTheTrueWindBackOnTheLogClock) {
  const auto truth = support::sample_truth();
  const auto back = ingest::read_truth(written(sample_flight(), {}, truth), "test.mcap");
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ((*back)[i].time, truth[i].time);
    EXPECT_EQ((*back)[i].v_NA_N, truth[i].v_NA_N);
    EXPECT_EQ((*back)[i].height, truth[i].height);
  }
  EXPECT_TRUE(ingest::read_truth(written(sample_flight()), "test.mcap")->empty());
}

std::set<std::string> topics_of(const std::vector<std::uint8_t>& bytes) {
  std::set<std::string> names;
  const auto content = ingest::read_mcap(bytes, "test.mcap");
  for (const auto& topic : content->topics) names.insert(topic.name);
  return names;
}

TEST(FlightToMcap, PutsFoxglovesSchemasBesideOursUnlessToldNotTo) {
  FlightFileSettings bare;
  bare.viewer_topics = false;
  const auto with = topics_of(written(sample_flight())), without = topics_of(written(sample_flight(), bare));
  for (const auto* topic : {"/foxglove/location", "/foxglove/pose", "/foxglove/log"}) {
    EXPECT_TRUE(with.contains(topic)) << topic;
    EXPECT_FALSE(without.contains(topic)) << topic;
  }
}

TEST(FlightToMcap, MendsTextsThatAreNoUtf8) {
  Flight flight = sample_flight();
  flight.events.value[1].text = "caf\xe9 \xed\xa0\x80";
  EXPECT_EQ(read_back(written(flight)).events.value[1].text, "caf? ???");
}

TEST(FlightToMcap, KeepsANumberOfAVelocityNoiseThatIsUnknown) {
  Flight flight = sample_flight();
  flight.velocity.sd[3] = std::numeric_limits<double>::quiet_NaN();
  const auto back = read_back(written(flight));
  EXPECT_TRUE(std::isnan(back.velocity.sd[3]));
  flight.velocity.sd.clear();
  EXPECT_TRUE(read_back(written(flight)).velocity.sd.empty());
}

TEST(FlightToMcap, LeavesAnExistingFileAloneUnlessToldToReplaceIt) {
  const support::TemporaryFolder folder;
  const auto path = folder / "flight.mcap";
  support::write_bytes(path, {1, 2, 3});
  const auto refused = product::write_flight(path, sample_flight());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ingest::Kind::usage);
  EXPECT_EQ(support::read_bytes(path).size(), 3u);
  FlightFileSettings replace;
  replace.overwrite = true;
  ASSERT_TRUE(product::write_flight(path, sample_flight(), replace));
  EXPECT_EQ(support::read_bytes(path), written(sample_flight()));
}

TEST(FlightToMcap, LeavesNothingBehindWhereItCannotWrite) {
  const support::TemporaryFolder folder;
  const auto failed = product::write_flight(folder / "no such folder" / "flight.mcap", sample_flight());
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ingest::Kind::write_failed);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(FlightToMcap, WritesAFlightWithoutAnythingInIt) {
  const auto content = ingest::read_mcap(written(Flight{}), "test.mcap", {ingest::Reading::strict, true, {}});
  ASSERT_TRUE(content);
  EXPECT_TRUE(content->flights.empty());
  EXPECT_EQ(content->messages, 0u);
}

}  // namespace
}  // namespace quadsonde
