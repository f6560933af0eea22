#include "ingest/csv/flight_from_csv.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <zlib.h>
#include <zstd.h>

#include <numbers>

#include "ingest/csv/decompress.h"
#include "ingest/flight/rotation.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

using ::testing::HasSubstr;

std::string detail(const LogContent& content, const std::string& key) {
  for (const auto& [k, v] : content.details)
    if (k == key) return v;
  return {};
}

LogContent read(std::string_view text) { return read_csv(as_bytes(text), "t.csv").value(); }

LogContent read_mapped(std::string_view text, const char* toml) {
  CsvReadSettings settings;
  settings.map = parse_column_map(toml, "m.toml").value();
  return read_csv(as_bytes(text), "t.csv", settings).value();
}

TEST(CsvReader, NeedsNoMapForCanonicalNames) {
  const auto content = read(
      "time_s,utc,roll_deg,pitch_deg,yaw_deg,vn_m_s,ve_m_s,vd_m_s,sd_velocity_m_s,lat_deg,lon_deg,height_msl_m,"
      "height_ellipsoid_m,height_agl_m,baro_alt_m,pressure_pa,temperature_k,relative_humidity_pct,ax_m_s2,ay_m_s2,az_m_"
      "s2,"
      "rotor_1_rpm,rotor_2_rpm\n"
      "1.5,2026-11-23T12:00:00.5Z,10,-5,90,1,2,-3,0.2,47,8,500,548,20,21,95000,283.5,55,0.1,0.2,-9.7,5000,5100\n"
      "1.6,2026-11-23T12:00:00.6Z,10,-5,90,1,2,-3,0.2,47,8,501,549,21,22,94990,283.4,56,0.1,0.2,-9.7,5000,5100\n");
  ASSERT_EQ(content.flights.size(), 1U);
  const auto& f = content.flights[0];
  EXPECT_TRUE(f.problems.empty());
  EXPECT_EQ(content.messages, 2U);
  EXPECT_EQ(detail(content, "map"), "quadsonde");
  EXPECT_EQ(f.attitude.time[0].ns, 1500000000);
  const auto angles = euler_from_q_NB(f.attitude.value[0]);
  EXPECT_NEAR(angles.roll * 180 / std::numbers::pi, 10, 1e-9);
  EXPECT_NEAR(angles.pitch * 180 / std::numbers::pi, -5, 1e-9);
  EXPECT_NEAR(angles.yaw * 180 / std::numbers::pi, 90, 1e-9);
  EXPECT_EQ(f.velocity.value[1], Eigen::Vector3d(1, 2, -3));
  EXPECT_EQ(f.velocity.sd, (std::vector<double>{0.2, 0.2}));
  EXPECT_EQ(f.velocity.origin, VelocityOrigin::receiver);
  EXPECT_EQ(f.position.value[0].lon_deg, 8);
  EXPECT_EQ(f.height_msl.value[1].m, 501);
  EXPECT_EQ(f.height_ellipsoid.value[1].m, 549);
  EXPECT_EQ(f.height_ground.value[1].m, 21);
  EXPECT_EQ(f.barometer.value[0].pressure_pa, 95000);
  EXPECT_EQ(f.barometer.value[0].altitude_m, 21);
  EXPECT_EQ(f.air.value[1].temperature_k, 283.4);
  EXPECT_EQ(f.air.value[1].relative_humidity_pct, 56);
  EXPECT_EQ(f.accelerometer.value[0].z(), -9.7);
  EXPECT_EQ(f.rotors.value[0], (RotorSpeeds{5000, 5100}));
  EXPECT_EQ(to_iso8601(*f.clock.to_utc(LogTime{1500000000})), "2026-11-23T12:00:00.500Z");
}

TEST(CsvReader, KeepsTheRateOfEveryColumn) {
  const auto content = read(
      "time_s,qw,qx,qy,qz,vn_m_s,ve_m_s,vd_m_s,height_msl_m\n"
      "0.0,1,0,0,0,,,,\n0.1,1,0,0,0,1,2,3,\n0.2,1,0,0,0,,,,500\n");
  const auto& f = content.flights.at(0);
  EXPECT_EQ(f.attitude.size(), 3U);
  EXPECT_EQ(f.velocity.size(), 1U);
  EXPECT_EQ(f.height_msl.size(), 1U);
  EXPECT_TRUE(f.problems.empty()) << "an empty cell is no sample and no damage";
}

TEST(CsvReader, LeavesOutWhatIsNoNumberAndSaysWhere) {
  const auto content = read(
      "time_s,qw,qx,qy,qz,vn_m_s,ve_m_s,vd_m_s\n"
      "0,1,0,0,0,1,2,3\n1,1,0,0,0,nan,2,3\n2,1,0,0,0,1,2,3\n3,1,0,0,0,abc,2,3\nx,1,0,0,0,1,2,3\n");
  const auto& f = content.flights.at(0);
  EXPECT_EQ(f.attitude.size(), 4U);
  EXPECT_EQ(f.velocity.size(), 2U);
  ASSERT_EQ(f.problems.size(), 2U);
  EXPECT_EQ(f.problems[0].what, "2 of 4 values of column vn_m_s are not numbers");
  EXPECT_EQ(f.problems[0].where.line, 3U);
  EXPECT_THAT(f.problems[1].what, HasSubstr("1 rows have no time"));
  EXPECT_EQ(f.problems[1].where.line, 6U);
  CsvReadSettings strict;
  strict.mode = Reading::strict;
  EXPECT_FALSE(read_csv(as_bytes("time_s,vn_m_s\n0,1\n1,nan\n"), "t.csv", strict));
}

TEST(CsvReader, NamesAMissingColumn) {
  const auto no_time = read_csv(as_bytes("qw,qx,qy,qz,vn_m_s,ve_m_s,vd_m_s\n1,0,0,0,1,2,3\n"), "t.csv");
  ASSERT_FALSE(no_time);
  EXPECT_EQ(no_time.error().kind, Kind::missing);
  EXPECT_EQ(no_time.error().where.line, 1U);
  EXPECT_THAT(no_time.error().what, HasSubstr("time"));
  const auto no_yaw = read("time_s,roll_deg,pitch_deg,vn_m_s,ve_m_s,vd_m_s\n0,1,2,3,4,5\n");
  ASSERT_EQ(no_yaw.flights.at(0).problems.size(), 1U);
  EXPECT_EQ(no_yaw.flights[0].problems[0].kind, Kind::missing);
  EXPECT_THAT(no_yaw.flights[0].problems[0].what, HasSubstr("yaw_deg"));
  CsvReadSettings mapped;
  mapped.map = parse_column_map("time_s = \"t\"\nvn_m_s = \"VelN\"", "m.toml").value();
  const auto wrong = read_csv(as_bytes("t,VelE\n0,1\n"), "t.csv", mapped);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().what, HasSubstr("\"VelN\" (for vn_m_s)"));
  EXPECT_THAT(wrong.error().hint, HasSubstr("t, VelE"));
}

TEST(CsvReader, SaysThatATableIsUnknown) {
  const auto unknown = read_csv(as_bytes("a,b,c\n1,2,3\n"), "t.csv");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().hint, HasSubstr("--columns"));
  const auto prose = read_csv(as_bytes("Dear pilot\nthis is a letter\n"), "t.csv");
  ASSERT_FALSE(prose);
  EXPECT_EQ(prose.error().kind, Kind::not_a_log);
  EXPECT_FALSE(read_csv({}, "t.csv"));
  const auto only_header = read_csv(as_bytes("time_s,vn_m_s\n"), "t.csv");
  ASSERT_FALSE(only_header);
  EXPECT_EQ(only_header.error().kind, Kind::missing);
}

TEST(CsvReader, LetsTheQuaternionWinAndTellsAContradiction) {
  const auto content =
      read("time_s,qw,qx,qy,qz,roll_deg,pitch_deg,yaw_deg\n0,1,0,0,0,0,0,0.4\n1,1,0,0,0,0,0,2\n2,1,0,0,0,3,0,0\n");
  const auto& f = content.flights.at(0);
  EXPECT_TRUE(f.attitude.value[2].isApprox(Eigen::Quaterniond::Identity()));
  ASSERT_EQ(f.problems.size(), 1U);
  EXPECT_EQ(f.problems[0].kind, Kind::inconsistent);
  EXPECT_THAT(f.problems[0].what, HasSubstr("up to 3.0 deg"));
  EXPECT_THAT(f.problems[0].what, HasSubstr("2 of 3 rows"));
  EXPECT_EQ(f.problems[0].where.line, 3U);
}

TEST(CsvReader, MakesTheVelocityOfThePositionOnlyWhereThereIsNoOther) {
  std::string text = "time_s,roll_deg,pitch_deg,yaw_deg,lat_deg,lon_deg,height_msl_m\n";
  // 2 m/s to the north at 47 N (111.17 km per degree there), climbing 1 m/s.
  for (int i = 0; i < 50; ++i)
    text += fmt::format("{},0,0,0,{:.9f},8,{}\n", i * 0.1, 47 + i * 0.2 / 111170.0, 500 + i * 0.1);
  const auto content = read(text);
  const auto& f = content.flights.at(0);
  EXPECT_EQ(f.velocity.origin, VelocityOrigin::differentiated);
  EXPECT_EQ(f.velocity.size(), 50U);
  EXPECT_NEAR(f.velocity.value[25].x(), 2, 0.01);
  EXPECT_NEAR(f.velocity.value[25].z(), -1, 0.001);
  EXPECT_THAT(detail(content, "velocity"), HasSubstr("no velocity of its own"));
}

TEST(CsvReader, MakesOnlyTheVerticalVelocityOfTheHeightWhereThatIsWhatIsMissing) {
  std::string text = "time_s,roll_deg,pitch_deg,yaw_deg,vn_m_s,ve_m_s,height_agl_m\n";
  for (int i = 0; i < 50; ++i) text += fmt::format("{},0,0,0,2,3,{}\n", i * 0.1, i * 0.2);
  const auto climbing = read(text);
  const auto& f = climbing.flights.at(0);
  EXPECT_EQ(f.velocity.size(), 50U);
  EXPECT_NEAR(f.velocity.value[25].x(), 2, 1e-12);
  EXPECT_NEAR(f.velocity.value[25].z(), -2, 1e-6);
  const auto flat = read("time_s,roll_deg,pitch_deg,yaw_deg,vn_m_s,ve_m_s\n0,0,0,0,1,2\n1,0,0,0,1,2\n");
  EXPECT_TRUE(flat.flights.at(0).velocity.empty()) << "an unknown vertical velocity is not zero";
  ASSERT_EQ(flat.flights[0].problems.size(), 1U);
  EXPECT_THAT(flat.flights[0].problems[0].what, HasSubstr("vd_m_s"));
}

TEST(CsvReader, DropsRowsInWhichAFieldIsMissing) {
  const auto content = read("time_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0\n2,1,0,0,0\n3,1,0");
  const auto& f = content.flights.at(0);
  EXPECT_EQ(f.attitude.size(), 2U);
  ASSERT_EQ(f.problems.size(), 2U);
  EXPECT_EQ(f.problems[0].kind, Kind::truncated);
  EXPECT_EQ(f.problems[0].where.line, 5U);
  EXPECT_EQ(f.problems[1].where.line, 3U);
}

TEST(CsvReader, FollowsAMapWithScalesZonesAndHeaderRow) {
  const auto content = read_mapped(
      "written by a logger; units: rad\n// a "
      "remark\nDay;Clock;Roll;Pitch;Yaw;N;E;D\n01.02.2021;12:00:00,5;0,1;0;0;1;2;3\n"
      "01.02.2021;12:00:01;0.1;0;0;1;2;3\n",
      R"(utc = { columns = ["Day", "Clock"] }
roll_deg = { column = "Roll", scale = 57.29577951308232 }
pitch_deg = "Pitch"
yaw_deg = { column = "Yaw", offset = 90 }
vn_m_s = "N"
ve_m_s = "E"
vd_m_s = { column = "D", scale = -1 }
[read]
delimiter = ";"
comment = "//"
time_format = "%d.%m.%Y %H:%M:%S"
zone = "+01:00"
)");
  const auto& f = content.flights.at(0);
  ASSERT_EQ(f.attitude.size(), 1U) << "0,1 is no number here";
  EXPECT_EQ(to_iso8601(*f.clock.to_utc(f.velocity.time[0])), "2021-02-01T11:00:00.500Z");
  EXPECT_NEAR(euler_from_q_NB(f.attitude.value[0]).roll, 0.1, 1e-12);
  EXPECT_NEAR(heading(f.attitude.value[0]), std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(f.velocity.value[0].z(), -3);
  EXPECT_EQ(detail(content, "map"), "m.toml");
  EXPECT_THAT(detail(content, "map_toml"), HasSubstr("zone = \"+01:00\""));
}

TEST(CsvReader, AddsHalfASecondToClocksOfWholeSeconds) {
  std::string text = "time_s,utc,vn_m_s\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("{:.1f},2021-01-01 00:00:{:02}Z,1\n", i * 0.1, i / 10);
  const auto content = read(text);
  const auto utc = content.flights.at(0).clock.to_utc(LogTime{0});
  EXPECT_NEAR(to_seconds(*utc - *parse_iso8601("2021-01-01T00:00:00Z")), 0, 0.101) << "a row";
}

TEST(CsvReader, IsNotLedAstrayByWrongDatesBeforeTheFix) {
  std::string text = "time_s,utc,vn_m_s\n";
  for (int i = 0; i < 100; ++i)
    text +=
        fmt::format("{:.1f},{} 00:00:{:02}.{}00Z,1\n", i * 0.1, i < 30 ? "1980-01-06" : "2021-01-01", i / 10, i % 10);
  const auto clock = read(text).flights.at(0).clock;
  ASSERT_TRUE(clock.utc_minus_log);
  EXPECT_EQ(to_iso8601(*clock.to_utc(LogTime{0})), "2021-01-01T00:00:00.000Z");
  EXPECT_LT(clock.uncertainty_s, 0.11);
}

// ---- compressed tables ----

std::vector<std::uint8_t> gzip(std::string_view text) {
  std::vector<std::uint8_t> out(compressBound(text.size()) + 64);
  z_stream z{};
  deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  z.avail_in = static_cast<uInt>(text.size());
  z.next_out = out.data();
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

std::string long_table() {
  std::string text = "time_s,qw,qx,qy,qz,vn_m_s\n";
  for (int i = 0; i < 5000; ++i) text += fmt::format("{:.2f},1,0,0,0,{}\n", i * 0.02, i * 7919 % 10007 * 0.001);
  return text;
}

TEST(CsvReader, ReadsCompressedTablesByTheirBytes) {
  const auto text = long_table();
  EXPECT_EQ(read_csv(gzip(text), "t.csv").value().flights.at(0).attitude.size(), 5000U);
  std::vector<std::uint8_t> packed(ZSTD_compressBound(text.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 3));
  EXPECT_EQ(read_csv(packed, "t.csv").value().flights.at(0).attitude.size(), 5000U);
}

TEST(CsvReader, KeepsEveryFullRowOfACutCompressedTable) {
  const auto packed = gzip(long_table());
  std::size_t before = 0;
  for (std::size_t cut = 2000; cut < packed.size(); cut += 997) {
    const auto content = read_csv(Bytes(packed).first(cut), "t.csv.gz").value();
    ASSERT_EQ(content.problems.size(), 1U) << cut;
    EXPECT_EQ(content.problems[0].kind, Kind::truncated);
    ASSERT_GE(content.flights.at(0).attitude.size(), before) << cut;
    before = content.flights[0].attitude.size();
  }
  EXPECT_GT(before, 4000U);
}

TEST(CsvReader, StopsAtTheLimitOfDecompression) {
  const auto packed = gzip(std::string(1 << 20, '0'));
  csv::DecompressLimits limits;
  limits.max_bytes = 1 << 19;
  EXPECT_EQ(csv::decompress(packed, "x.gz", limits).error().kind, Kind::limit);
  limits = {};
  limits.free_bytes = 1 << 16;
  EXPECT_EQ(csv::decompress(packed, "x.gz", limits).error().kind, Kind::limit) << "1 : 1000 is no table";
  EXPECT_EQ(csv::decompress(packed, "x.gz").value().bytes.size(), 1U << 20);
}

TEST(CsvReader, KeepsEveryFullRowOfATableCutAnywhere) {
  const std::string text = "time_s,roll_deg,pitch_deg,yaw_deg\n0.0,1.5,2.5,3.5\n0.1,1.5,2.5,3.5\n0.2,1.5,2.5,3.5\n";
  for (std::size_t cut = 54; cut <= text.size(); ++cut) {
    const auto content = read_csv(as_bytes(text).first(cut), "t.csv");
    ASSERT_TRUE(content) << cut;
    const auto lines =
        static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(cut), '\n'));
    EXPECT_GE(content->flights.at(0).attitude.size(), lines - 1) << cut;
  }
}

}  // namespace
}  // namespace quadsonde::ingest
