#include "ingest/open/open_log.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <zlib.h>

#include "ingest/open/mapped_file.h"
#include "ingest/open/sniff.h"
#include "tests/ingest/ulog/ulog_writer.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

using support::UlogWriter;
using ::testing::HasSubstr;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

std::vector<std::uint8_t> gzip(Bytes data) {
  std::vector<std::uint8_t> out(compressBound(data.size()) + 64);
  z_stream z{};
  deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  z.next_in = const_cast<Bytef*>(data.data());
  z.avail_in = static_cast<uInt>(data.size());
  z.next_out = out.data();
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

struct Parts {
  bool attitude = true, velocity = true;
  int mav_type = 2;
};

std::vector<std::uint8_t> ulog(Parts parts = {}) {
  UlogWriter log;
  log.flags();
  log.format("vehicle_attitude:uint64_t timestamp;float[4] q;");
  log.format(
      "vehicle_local_position:uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;"
      "bool xy_valid;bool z_valid;bool v_xy_valid;bool v_z_valid;");
  log.parameter("MAV_TYPE", parts.mav_type);
  log.subscribe(0, "vehicle_attitude");
  log.subscribe(1, "vehicle_local_position");
  const auto raw = [](auto v) { return UlogWriter::raw(v); };
  for (int i = 0; i < 50; ++i) {
    const auto us = std::uint64_t(1000000 + i * 100000);
    if (parts.attitude) log.data(0, raw(us) + raw(1.0F) + raw(0.0F) + raw(0.0F) + raw(0.0F));
    const std::string valid(4, parts.velocity ? '\1' : '\0');
    log.data(1, raw(us) + raw(1.0F) + raw(2.0F) + raw(-3.0F) + raw(0.5F) + raw(0.0F) + raw(0.0F) + valid);
  }
  return log.bytes;
}

constexpr const char* table =
    "time_s,qw,qx,qy,qz,vn_m_s,ve_m_s,vd_m_s,height_msl_m\n0,1,0,0,0,1,2,3,500\n1,1,0,0,0,1,2,3,501\n";

/// A file of its own in a folder of its own.
class OpenLog : public ::testing::Test {
 protected:
  Result<LogContent> open(const std::string& name, const std::vector<std::uint8_t>& bytes,
                          const OpenSettings& settings = {}) {
    support::write_bytes(folder_ / name, bytes);
    return open_log(folder_ / name, settings);
  }
  support::TemporaryFolder folder_;
};

TEST_F(OpenLog, ChoosesTheReaderByBytesAndNotByName) {
  EXPECT_EQ(open("flight.csv", ulog()).value().format, "ulog");
  EXPECT_EQ(open("flight", bytes_of(table)).value().format, "csv");
  EXPECT_EQ(open("flight.bin", gzip(bytes_of(table))).value().format, "csv");
  EXPECT_EQ(open("flight.dat", gzip(ulog())).value().format, "ulog");
}

TEST_F(OpenLog, SaysThatAFileIsEmptyOrNotThere) {
  const auto empty = open("empty.ulg", {});
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().what, "the file is empty");
  EXPECT_THAT(empty.error().where.file, HasSubstr("empty.ulg"));
  const auto none = open_log(folder_ / "none.ulg");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, Kind::unreadable);
  EXPECT_THAT(none.error().what, HasSubstr("No such file"));
  EXPECT_THAT(open_log(folder_.path()).error().what, HasSubstr("folder"));
}

TEST_F(OpenLog, SaysThatATextFileIsNotTheLogItsNamePromises) {
  const auto text = open("letter.ulg", bytes_of("Dear pilot,\nthe log is lost.\n"));
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().kind, Kind::not_a_log);
  EXPECT_EQ(text.error().what, "this is a text file, not the .ulg log that its name says");
  EXPECT_FALSE(text.error().hint.empty());
}

TEST_F(OpenLog, SaysThatNobodyKnowsTheBytes) {
  std::vector<std::uint8_t> noise(4000);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<std::uint8_t>((i * 2654435761U) >> 13);
  const auto unknown = open("x.ulg", noise);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, Kind::not_a_log);
  EXPECT_THAT(unknown.error().hint, HasSubstr(".tlog"));
}

TEST_F(OpenLog, NamesTheExportsThatWorkForANativeDjiFile) {
  std::vector<std::uint8_t> aircraft(1000, 0x90);
  const std::string build = "BUILD 2016-01-01";
  std::copy(build.begin(), build.end(), aircraft.begin() + 16);
  std::vector<std::uint8_t> app(5000, 0xA7);
  const std::uint8_t head[] = {0x80, 0x10, 0, 0, 0, 0, 0, 0, 0x90, 0x01, 13, 0};
  std::copy(std::begin(head), std::end(head), app.begin());
  for (const auto& bytes : {aircraft, app}) {
    const auto native = open("FLY001.DAT", bytes);
    ASSERT_FALSE(native);
    EXPECT_EQ(native.error().kind, Kind::unsupported);
    EXPECT_THAT(native.error().hint,
                ::testing::AllOf(HasSubstr("Airdata"), HasSubstr("DroneDeploy"), HasSubstr("DatCon")));
  }
}

TEST_F(OpenLog, KeepsWhatIsCompleteOfALogCutInTheMiddle) {
  auto whole = ulog();
  const auto all = open("whole.ulg", whole).value();
  whole.resize(whole.size() / 2 + 3);
  const auto half = open("half.ulg", whole).value();
  EXPECT_FALSE(why_no_flight(half));
  EXPECT_GT(half.flights.at(0).attitude.size(), 15U);
  EXPECT_LT(half.flights.at(0).attitude.size(), all.flights.at(0).attitude.size());
  ASSERT_EQ(half.problems.size(), 1U);
  EXPECT_EQ(half.problems[0].kind, Kind::truncated);
  auto packed = gzip(ulog());
  packed.resize(packed.size() - 40);
  const auto cut = open("cut.ulg.gz", packed).value();
  EXPECT_GE(cut.problems.size(), 1U);
  EXPECT_FALSE(why_no_flight(cut));
}

TEST_F(OpenLog, SaysWhatALogWithoutAttitudeWouldNeed) {
  Parts parts;
  parts.attitude = false;
  const auto why = why_no_flight(open("x.ulg", ulog(parts)).value());
  ASSERT_TRUE(why);
  EXPECT_EQ(why->kind, Kind::missing);
  EXPECT_EQ(why->what, "the log has no attitude");
  EXPECT_THAT(why->hint, HasSubstr("vehicle_attitude"));
  const auto column =
      why_no_flight(open("x.csv", bytes_of("time_s,roll_deg,pitch_deg,vn_m_s,ve_m_s,vd_m_s\n0,1,2,3,4,5\n")).value());
  ASSERT_TRUE(column);
  EXPECT_THAT(column->what, HasSubstr("yaw_deg"));
}

TEST_F(OpenLog, SaysWhatALogWithoutVelocityOrPositionWouldNeed) {
  Parts parts;
  parts.velocity = false;
  const auto why = why_no_flight(open("x.ulg", ulog(parts)).value());
  ASSERT_TRUE(why);
  EXPECT_THAT(why->what, HasSubstr("neither a valid velocity nor a valid position"));
  EXPECT_THAT(why->hint, HasSubstr("GPS"));
  const auto column =
      why_no_flight(open("x.csv", bytes_of("time_s,roll_deg,pitch_deg,yaw_deg\n0,1,2,3\n1,1,2,3\n")).value());
  ASSERT_TRUE(column);
  EXPECT_THAT(column->hint, HasSubstr("vn_m_s"));
}

TEST_F(OpenLog, RefusesWingsByName) {
  Parts parts;
  parts.mav_type = 1;
  const auto why = why_no_flight(open("x.ulg", ulog(parts)).value());
  ASSERT_TRUE(why);
  EXPECT_EQ(why->kind, Kind::unsupported);
  EXPECT_THAT(why->what, HasSubstr("fixed-wing"));
}

TEST_F(OpenLog, SaysThatAForeignUlogHoldsNoFlight) {
  UlogWriter log;
  log.format("powers:uint64_t timestamp;double x;");
  log.subscribe(0, "powers");
  log.data(0, std::string(16, '\0'));
  const auto content = open("x.ulg", log.bytes).value();
  EXPECT_TRUE(content.flights.empty());
  const auto why = why_no_flight(content);
  ASSERT_TRUE(why);
  EXPECT_THAT(why->what, HasSubstr("none of its 1 topics (1 messages)"));
}

TEST_F(OpenLog, MakesAVelocityOfThePositionWhereTheLogHasNone) {
  UlogWriter log;
  log.format("vehicle_attitude:uint64_t timestamp;float[4] q;");
  log.format(
      "vehicle_local_position:uint64_t timestamp;float x;float y;float z;float vx;bool xy_valid;bool v_xy_valid;");
  log.subscribe(0, "vehicle_attitude");
  log.subscribe(1, "vehicle_local_position");
  const auto raw = [](auto v) { return UlogWriter::raw(v); };
  for (int i = 0; i < 50; ++i) {
    const auto us = std::uint64_t(1000000 + i * 100000);
    log.data(0, raw(us) + raw(1.0F) + raw(0.0F) + raw(0.0F) + raw(0.0F));
    log.data(1, raw(us) + raw(float(i) * 0.2F) + raw(0.0F) + raw(0.0F) + raw(0.0F) + '\1' + '\0');
  }
  const auto content = open("x.ulg", log.bytes).value();
  const auto& v = content.flights.at(0).velocity;
  EXPECT_EQ(v.origin, VelocityOrigin::differentiated);
  EXPECT_NEAR(v.value.at(25).x(), 2.0, 1e-3);
  EXPECT_FALSE(why_no_flight(content));
}

TEST_F(OpenLog, ShiftsTheDatumOfHeightsAboveTheSea) {
  OpenSettings settings;
  settings.height_offset_m = -39;
  EXPECT_EQ(open("x.csv", bytes_of(table), settings).value().flights.at(0).height_msl.value.at(0).m, 461);
}

TEST_F(OpenLog, PutsASensorFileOnTheClockOfTheFlight) {
  OpenSettings settings;
  settings.sensor = folder_ / "air.csv";
  settings.sensor_offset_s = 0.25;
  support::write_bytes(*settings.sensor,
                       bytes_of("time_s,temperature_k,relative_humidity_pct,pressure_pa\n0,283,50,95000\n1,284,51,\n"));
  const auto by_log = open("x.csv", bytes_of(table), settings).value();
  const auto& air = by_log.flights.at(0).air;
  ASSERT_EQ(air.size(), 2U);
  EXPECT_EQ(air.time[0].ns, 250000000);
  EXPECT_EQ(air.value[0].pressure_pa, 95000);
  EXPECT_EQ(air.value[1].temperature_k, 284);

  support::write_bytes(*settings.sensor,
                       bytes_of("utc,temperature_k\n2026-01-01T00:00:10Z,283\n2026-01-01T00:00:11Z,284\n"));
  const auto no_utc = open("x.csv", bytes_of(table), settings).value();
  EXPECT_TRUE(no_utc.flights.at(0).air.empty());
  ASSERT_EQ(no_utc.flights[0].problems.size(), 1U);
  const auto by_utc =
      open("y.csv",
           bytes_of("time_s,utc,qw,qx,qy,qz\n5,2026-01-01T00:00:10.5Z,1,0,0,0\n6,2026-01-01T00:00:11.5Z,1,0,0,0\n"),
           settings)
          .value();
  ASSERT_EQ(by_utc.flights.at(0).air.size(), 2U);
  EXPECT_EQ(by_utc.flights[0].air.time[1].ns, 5750000000);

  support::write_bytes(*settings.sensor, bytes_of("time_s,temperature_k\n900,283\n901,284\n"));
  const auto elsewhere = open("x.csv", bytes_of(table), settings).value();
  EXPECT_TRUE(elsewhere.flights.at(0).air.empty());
  EXPECT_THAT(elsewhere.flights[0].problems.at(0).what, HasSubstr("no time of the sensor file lies in the flight"));
  settings.sensor = folder_ / "none.csv";
  EXPECT_FALSE(open("x.csv", bytes_of(table), settings));
}

TEST_F(OpenLog, ReadsATableWithTheUsersMap) {
  OpenSettings settings;
  settings.columns = parse_column_map(
                         "time_s = \"t\"\nroll_deg = \"r\"\npitch_deg = \"p\"\nyaw_deg = \"y\"\nvn_m_s = \"n\"\nve_m_s "
                         "= \"e\"\nvd_m_s = \"d\"",
                         "mine")
                         .value();
  const auto bytes = bytes_of("t,r,p,y,n,e,d\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n");
  EXPECT_EQ(open("x.txt", bytes, settings).value().flights.at(0).velocity.size(), 2U);
  EXPECT_EQ(open("x.txt.gz", gzip(bytes), settings).value().flights.at(0).velocity.size(), 2U);
  EXPECT_FALSE(open("x.txt", bytes));
}

TEST(OpenSamples, EveryTableAndUlogOpensAndTellsWhetherItCanGiveAWind) {
  QUADSONDE_NEEDS_DATA("logs/ulog/sample.ulg");
  const std::pair<const char*, bool> samples[] = {
      {"logs/ulog/esc_status_log.ulg", true},
      {"logs/ulog/roboto_fmuv5_test.ulg", true},
      {"logs/ulog/sample.ulg", false},
      {"logs/ulog/sample_appended_multiple.ulg", false},
      {"logs/ulog/sample_log_small.ulg", false},
      {"logs/ulog/sample_logging_tagged_and_default_params.ulg", true},
      {"logs/ulog/sample_px4_events.ulg", true},
      {"logs/ulog/sitl_iris_v18.ulg", true},
      {"logs/ulog/yule_trig_stats.ulg", false},
      {"logs/derived/esc_flight.csv", true},
      {"flights/sph_skyhub_wind/wind-trajectory1.csv.gz", true},
      {"flights/nmt_m600_trisonica/level0.csv.gz", true},
      {"flights/dronedeploy_dji/pixel2-inspire2.log.gz", true},
      {"flights/epfl_wemuav/derived_FLY139__20210420_092926__Hover.csv.gz", true}};
  for (const auto& [name, can] : samples) {
    const auto content = open_log(support::data_file(name));
    ASSERT_TRUE(content) << name << ": " << to_string(content.error());
    EXPECT_EQ(!why_no_flight(*content), can) << name;
  }
}

}  // namespace
}  // namespace quadsonde::ingest
