#include "ingest/csv/column_map.h"

#include <gmock/gmock.h>

#include "ingest/csv/table.h"
#include "ingest/csv/time_text.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

using ::testing::HasSubstr;

TEST(ColumnMap, EveryShippedMapParses) {
  std::vector<std::string> names;
  for (const auto& map : shipped_column_maps()) names.push_back(map.name);
  EXPECT_THAT(names, ::testing::ElementsAre("airdata", "dronedeploy", "dronedeploy_android", "nmt_m600", "skyhub",
                                            "wemuav", "quadsonde"));
}

TEST(ColumnMap, TheExamplesAreRight) {
  const std::filesystem::path maps = QUADSONDE_EXAMPLE_MAPS;
  const auto exchanged = read_column_map(maps / "skyhub_exchanged.toml");
  ASSERT_TRUE(exchanged) << to_string(exchanged.error());
  EXPECT_EQ(exchanged->columns.at("roll_deg")[0].columns[0], "Pitch");
  EXPECT_EQ(exchanged->columns.at("pitch_deg")[0].columns[0], "Roll");
  const auto wemuav = read_column_map(maps / "wemuav.toml");
  ASSERT_TRUE(wemuav) << to_string(wemuav.error());
  EXPECT_EQ(wemuav->name, "my_wemuav");
}

TEST(ColumnMap, ReadsEveryFormOfALine) {
  const auto map = parse_column_map(R"(
vn_m_s = "VelN"
roll_deg = { column = "roll", scale = 57.29577951308232, offset = 1 }
utc = { columns = ["Date", "Time"] }
height_msl_m = ["a", { column = "b", scale = 0.3048 }]
[read]
delimiter = "tab"
header_row = 3
comment = "//"
time_format = "%d.%m.%Y %H:%M:%S"
zone = "+02:00"
)",
                                    "mine")
                       .value();
  EXPECT_EQ(map.name, "mine");
  EXPECT_EQ(map.columns.at("roll_deg")[0].scale, 57.29577951308232);
  EXPECT_EQ(map.columns.at("roll_deg")[0].offset, 1.0);
  EXPECT_EQ(map.columns.at("utc")[0].columns.size(), 2U);
  EXPECT_EQ(map.columns.at("height_msl_m").size(), 2U);
  EXPECT_EQ(map.delimiter, '\t');
  EXPECT_EQ(map.header, 3U);
  EXPECT_EQ(map.zone_s, 7200);
}

TEST(ColumnMap, NamesTheLineOfAMistake) {
  const auto error_of = [](const char* toml) {
    const auto map = parse_column_map(toml, "m.toml");
    return map ? Problem{} : map.error();
  };
  const auto typo = error_of("vn_m_s = \"a\"\nvelocity_n = \"b\"\n");
  EXPECT_EQ(typo.kind, Kind::usage);
  EXPECT_EQ(typo.where.line, 2U);
  EXPECT_THAT(typo.what, HasSubstr("velocity_n"));
  EXPECT_THAT(error_of("vn_m_s = { colum = \"a\" }").what, HasSubstr("colum"));
  EXPECT_THAT(error_of("vn_m_s = { column = \"a\", scale = \"2\" }").what, HasSubstr("scale should be a number"));
  EXPECT_THAT(error_of("utc = { column = \"a\", format = \"epoch\" }").what, HasSubstr("epoch"));
  EXPECT_THAT(error_of("vn_m_s = 3").what, HasSubstr("vn_m_s"));
  EXPECT_THAT(error_of("[read]\nzone = \"CET\"").what, HasSubstr("zone"));
  EXPECT_THAT(error_of("").what, HasSubstr("no column"));
  EXPECT_EQ(error_of("vn_m_s = \"a").where.line, 1U);
  EXPECT_EQ(read_column_map("/no/such/map.toml").error().kind, Kind::unreadable);
}

TEST(ColumnMap, KnowsRotorsByNumber) {
  EXPECT_TRUE(is_canonical_column("rotor_1_rpm"));
  EXPECT_TRUE(is_canonical_column("rotor_12_rpm"));
  EXPECT_FALSE(is_canonical_column("rotor_0_rpm"));
  EXPECT_FALSE(is_canonical_column("rotor__rpm"));
  EXPECT_FALSE(is_canonical_column("rotor_1_rps"));
}

TEST(TableText, ReadsTimesAsTablesWriteThem) {
  const auto utc = [](const char* text, const char* format, int zone = 0) {
    const auto t = csv::parse_time(text, {format, zone});
    return t ? to_iso8601(*t) : "none";
  };
  EXPECT_EQ(utc("2023/10/24 09:55:15.336", "iso"), "2023-10-24T09:55:15.336Z");
  EXPECT_EQ(utc("2023/10/24 09:55:15.336", "iso", 10800), "2023-10-24T06:55:15.336Z");
  EXPECT_EQ(utc("2023-04-19 07:10:05.669701-07:00", "iso", 10800), "2023-04-19T14:10:05.669Z") << "its own zone wins";
  EXPECT_EQ(utc("05/23/2018 20:50:18", "%m/%d/%Y %H:%M:%S"), "2018-05-23T20:50:18.000Z");
  EXPECT_EQ(utc("5/3/2021 2:39:09 PM", "%m/%d/%Y %I:%M:%S %p"), "2021-05-03T14:39:09.000Z");
  EXPECT_EQ(utc("12:05:00 AM 1.2.21 +0130", "%I:%M:%S %p %d.%m.%y %z"), "2021-01-31T22:35:00.000Z");
  EXPECT_EQ(utc("1618910966.1", "unix"), "2021-04-20T09:29:26.100Z");
  EXPECT_EQ(utc("1557756559716392", "unix_us"), "2019-05-13T14:09:19.716Z");
  EXPECT_EQ(utc("1557756559716", "unix_ms"), "2019-05-13T14:09:19.716Z");
  EXPECT_EQ(utc("2021-02-30 00:00:00", "%Y-%m-%d %H:%M:%S"), "none");
  EXPECT_EQ(utc("", "iso"), "none");
}

TEST(TableText, TakesSecondsWithoutRoundingThemThroughADouble) {
  EXPECT_EQ(csv::parse_seconds_ns("1618910966.123456789"), 1618910966123456789);
  EXPECT_EQ(csv::parse_seconds_ns("-0.5"), -500000000);
  EXPECT_EQ(csv::parse_seconds_ns("5081.007923"), 5081007923000);
  EXPECT_EQ(csv::parse_seconds_ns("1e3"), 1000000000000);
  EXPECT_EQ(csv::parse_seconds_ns("12:30"), std::nullopt);
  EXPECT_EQ(csv::parse_seconds_ns(""), std::nullopt);
  EXPECT_EQ(csv::parse_seconds_ns("nan"), std::nullopt);
  EXPECT_EQ(csv::parse_seconds_ns("99999999999"), std::nullopt);
}

TEST(TableText, SplitsQuotedAndBlankSeparatedFields) {
  std::vector<std::string_view> fields;
  csv::split(R"(1,"a, b", 3 ,,"x")", ',', 99, fields);
  EXPECT_EQ(fields, (std::vector<std::string_view>{"1", "a, b", "3", "", "x"}));
  csv::split("  1  2\t3 ", ' ', 99, fields);
  EXPECT_EQ(fields, (std::vector<std::string_view>{"1", "2", "3"}));
  csv::split("1,2,3", ',', 2, fields);
  EXPECT_EQ(fields.size(), 2U);
  csv::split("", ',', 9, fields);
  EXPECT_EQ(fields, (std::vector<std::string_view>{""}));
}

}  // namespace
}  // namespace quadsonde::ingest
