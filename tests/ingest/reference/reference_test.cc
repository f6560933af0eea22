#include "ingest/reference/reference.h"

#include <gtest/gtest.h>

#include "ingest/reference/metar.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

const UtcTime march = *parse_iso8601("2014-03-01T12:00:00Z");

ReferenceWind metar(std::string_view text) {
  const auto wind = parse_metar(text, march);
  EXPECT_TRUE(wind) << text;
  return wind.value_or(ReferenceWind{});
}

TEST(Metar, KnotsBecomeMetresPerSecondAndDirectionIsWhereItComesFrom) {
  const auto wind = metar("VOHY 010040Z 13004KT 4000 FEW020 20/17 Q1014");
  EXPECT_EQ(wind.station, "VOHY");
  EXPECT_EQ(to_iso8601(wind.utc, 0), "2014-03-01T00:40:00Z");
  EXPECT_DOUBLE_EQ(*wind.speed(), 4 * 1852.0 / 3600);
  EXPECT_EQ(wind.from_deg, 130);
  EXPECT_FALSE(wind.gust);
  EXPECT_EQ(wind.height->m, 10);
}

TEST(Metar, VariableWindHasASpeedAndNoDirection) {
  const auto wind = metar("VOHY 011340Z VRB01KT 4000");
  EXPECT_FALSE(wind.from_deg);
  EXPECT_FALSE(wind.calm);
  EXPECT_NEAR(*wind.speed(), 0.514444, 1e-6);
}

TEST(Metar, CalmIsSpeedZeroWithoutDirection) {
  const auto wind = metar("VOHY 020140Z 00000KT 2000");
  EXPECT_TRUE(wind.calm);
  EXPECT_EQ(*wind.speed(), 0);
  EXPECT_FALSE(wind.from_deg);
}

TEST(Metar, GustsSectorsAndNorthAreKept) {
  const auto wind = metar("SPECI KXYZ 281553Z AUTO 36008G13KT 330V030 10SM CLR RMK AO2 PK WND 27026/1530");
  EXPECT_EQ(wind.from_deg, 360);
  EXPECT_NEAR(*wind.gust, 13 * knot, 1e-12);
  EXPECT_EQ(wind.sector_deg, std::make_pair(330.0, 30.0));
}

TEST(Metar, MetresPerSecondAndThreeDigitSpeedsAreRead) {
  EXPECT_DOUBLE_EQ(*metar("UUEE 011200Z 24007G12MPS 9999").speed(), 7);
  EXPECT_NEAR(*metar("KMWN 011200Z 280P99KT").speed(), 99 * knot, 1e-12);
  EXPECT_NEAR(*metar("CWXX 011200Z 280105KT").speed(), 105 * knot, 1e-12);
}

TEST(Metar, ReportsWithoutWindAndWindsInRemarksGiveNothing) {
  EXPECT_FALSE(parse_metar("VOHY 011340Z /////KT 9999", march));
  EXPECT_FALSE(parse_metar("VOHY 011340Z NIL=", march));
  EXPECT_FALSE(parse_metar("KABC 011340Z 10SM RMK VRB06KT", march));
  EXPECT_FALSE(parse_metar("", march));
  EXPECT_FALSE(parse_metar("VOHY 011340Z 13004KT", std::nullopt)) << "a day of the month alone is no time";
}

TEST(Metar, TheMonthIsTheOneClosestToTheFlight) {
  const auto near = *parse_iso8601("2024-01-01T00:10:00Z");
  EXPECT_EQ(to_iso8601(parse_metar("LFBO 312330Z 13004KT", near)->utc, 0), "2023-12-31T23:30:00Z");
}

TEST(Reference, PlainTableOfRangesIsReadAndBadLinesAreNamed) {
  const std::string text =
      "utc,speed_min_m_s,speed_max_m_s,wind_from_deg,height_agl_m\n"
      "2026-06-01T05:00:00Z,2,4,0,10\n"
      "yesterday,1,2,3,4\n"
      "2026-06-01T04:00:00Z,0,0,,10\n";
  const auto reference = read_reference(as_bytes(text), "t.csv", std::nullopt);
  ASSERT_TRUE(reference);
  ASSERT_EQ(reference->records.size(), 2u);
  EXPECT_TRUE(reference->records[0].calm) << "records are in time order";
  EXPECT_EQ(*reference->records[1].speed(), 3);
  EXPECT_EQ(reference->records[1].from_deg, 360) << "a direction of 0 in a table is north";
  ASSERT_EQ(reference->problems.size(), 1u);
  EXPECT_EQ(reference->problems[0].where.line, 3u);
}

TEST(Reference, AReportThatStandsThereTwiceIsKeptOnce) {
  const std::string text =
      "2014-03-01 13:40\tVOHY 011340Z VRB01KT\n2014-03-01 13:40\tVOHY 011340Z VRB01KT\n"
      "2014-03-01 13:40\tVOBL 011340Z VRB01KT\n2014-03-01 13:40\tVOHY 011340Z COR VRB02KT\n";
  const auto reference = read_reference(as_bytes(text), "x", std::nullopt);
  ASSERT_TRUE(reference);
  EXPECT_EQ(reference->records.size(), 3u) << "two stations, and a correction";
}

TEST(Reference, TheUsersPlaceAndHeightFillWhatRecordsDoNotName) {
  auto metar = *read_reference(as_bytes("VOHY 010040Z 13004KT\n"), "x", march);
  place_records(metar, {17.2, 78.4}, {8});
  EXPECT_EQ(metar.records[0].place->lat_deg, 17.2);
  EXPECT_EQ(metar.records[0].height->m, 8) << "ten metres are assumed, not told, by a METAR";
  auto table = *read_reference(as_bytes("utc,speed_min_m_s,speed_max_m_s,wind_from_deg,height_agl_m,lat_deg,lon_deg\n"
                                        "2026-06-01T05:00:00Z,2,4,10,50,1,2\n2026-06-01T05:00:00Z,2,4,10,,,\n"),
                               "t", std::nullopt);
  place_records(table, {17.2, 78.4}, {8});
  EXPECT_EQ(table.records[0].height->m, 50);
  EXPECT_EQ(table.records[0].place->lat_deg, 1);
  EXPECT_EQ(table.records[1].height->m, 8);
  EXPECT_EQ(table.records[1].place->lon_deg, 78.4);
}

TEST(Reference, WithoutAnyWindOrDateSaysSo) {
  const auto no_wind = read_reference(as_bytes("VOHY 010040Z 9999\nVOHY 010140Z NIL\n"), "x", march);
  ASSERT_FALSE(no_wind);
  EXPECT_EQ(no_wind.error().kind, Kind::missing);
  EXPECT_NE(no_wind.error().what.find("none of its reports has a wind"), std::string::npos);
  const auto no_date = read_reference(as_bytes("VOHY 010040Z 13004KT\n"), "x", std::nullopt);
  ASSERT_FALSE(no_date);
  EXPECT_NE(no_date.error().what.find("day of the month only"), std::string::npos);
}

TEST(Reference, IsToldApartFromOtherFilesByItsContents) {
  for (const auto* text : {"METAR VOHY 010040Z 13004KT\n", "2014-03-01 13:40\tVOHY 011340Z VRB01KT\n",
                           "#DEBUG: x\nstation,valid,drct\n", "utc,speed_min_m_s\n"})
    EXPECT_TRUE(looks_like_reference(as_bytes(text))) << text;
  for (const auto* text : {"", "time_s,vn_m_s\n1,2\n", "Dear diary\n", "leg,bin_bottom_m\n"})
    EXPECT_FALSE(looks_like_reference(as_bytes(text))) << text;
}

TEST(Reference, AnyOtherTextIsRefusedWithTheNextStep) {
  const auto reference = read_reference(as_bytes("hello\nworld\n"), "x.txt", march);
  ASSERT_FALSE(reference);
  EXPECT_EQ(reference.error().kind, Kind::not_a_log);
  EXPECT_NE(reference.error().hint.find("utc,speed_min_m_s"), std::string::npos);
  EXPECT_FALSE(read_reference({}, "empty", march));
}

TEST(Reference, EveryTruncationOfAListIsSurvived) {
  const std::string text = "2014-03-01 13:40\tVOHY 011340Z VRB01KT 4000\n2014-03-02 00:40\tVOHY 020040Z 28008G13KT 230V290\n";
  for (std::size_t n = 0; n <= text.size(); ++n) {
    const auto reference = read_reference(as_bytes(std::string_view(text).substr(0, n)), "x", march);
    if (reference) {
      EXPECT_LE(reference->records.size(), 2u);
    }
  }
}

TEST(Reference, IemDownloadsAndRawListsOfTheSamplesAgree) {
  QUADSONDE_NEEDS_DATA("reference/metar_iem/iem_asos_tdf_full.txt");
  const auto bytes = support::read_bytes(support::data_file("reference/metar_iem/iem_asos_tdf_full.txt"));
  const auto full = read_reference(bytes, "full", std::nullopt);
  ASSERT_TRUE(full);
  const auto at = [&](const char* time) {
    for (const auto& r : full->records)
      if (r.utc == *parse_iso8601(time)) return r;
    ADD_FAILURE() << time;
    return ReferenceWind{};
  };
  // Decoded values of PROVENANCE.md.
  EXPECT_EQ(at("2014-03-01T00:40Z").from_deg, 130);
  EXPECT_NEAR(*at("2014-03-01T00:40Z").speed(), 4 * knot, 1e-9);
  EXPECT_FALSE(at("2014-03-01T13:40Z").from_deg);
  EXPECT_TRUE(at("2014-03-02T01:40Z").calm);
  const auto raw = support::read_bytes(support::data_file("reference/metar_iem/metar_raw_list.txt"));
  const auto list = read_reference(raw, "raw", std::nullopt);
  ASSERT_TRUE(list);
  EXPECT_TRUE(list->problems.empty());
  EXPECT_GT(list->records.size(), 10u);
}

}  // namespace
}  // namespace quadsonde::ingest
