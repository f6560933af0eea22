#include "export/archive/query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "export/archive/answer.h"
#include "export/archive/regrid.h"
#include "export/archive/subset.h"
#include "ingest/flight/local_frame.h"
#include "tests/export/archive/made_up_netcdf.h"
#include "tests/export/cf_netcdf/nc_reader.h"
#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

using support::TemporaryFolder;
using testing::HasSubstr;

/// Rows anywhere on Earth that no netCDF stands behind.
std::vector<ArchiveEntry> made_up_rows(int count, unsigned seed = 5) {
  std::mt19937 random(seed);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  std::vector<ArchiveEntry> rows;
  for (int i = 0; i < count; ++i) {
    ArchiveEntry e;
    e.name = fmt::format("row-{:05}", i), e.flight_id = e.name;
    e.folder = "profiles/2025/06/x/" + e.name;
    e.start_s = 1.75e9 + any(0, 1e7), e.end_s = e.start_s + any(60, 3600);
    e.lat_deg = any(-90, 90), e.lon_deg = any(-180, 180);
    if (i % 5) e.surface_msl_m = any(-50, 3000);
    e.bottom_msl_m = e.surface_msl_m.value_or(100) + any(5, 50), e.top_msl_m = e.bottom_msl_m + any(10, 900);
    e.speed_min_m_s = any(0, 10), e.speed_max_m_s = e.speed_min_m_s + any(0, 10);
    e.quality = static_cast<ArchiveQuality>(i % 3), e.superseded = i % 7 == 0;
    e.vehicle = fmt::format("quad-{}", i % 4), e.station = i % 2 ? "north" : "";
    rows.push_back(e);
  }
  return rows;
}

class Queries : public testing::Test {
 protected:
  Queries() : index_(std::move(*ArchiveIndex::open(folder_ / "i.sqlite", ArchiveIndex::Mode::create))) {
    EXPECT_TRUE(index_.begin());
    for (const auto& row : rows_) EXPECT_TRUE(index_.put(row));
    EXPECT_TRUE(index_.commit());
  }
  /// The index answers what a plain look at every row answers, and neither everything nor nothing.
  void expect_like(const ArchiveQuery& query, const std::function<bool(const ArchiveEntry&)>& fits) {
    std::set<std::string> expected, got;
    for (const auto& row : rows_)
      if ((query.all_versions || !row.superseded) && fits(row)) expected.insert(row.name);
    const auto answer = query_index(index_, query);
    ASSERT_TRUE(answer) << ingest::to_string(answer.error());
    for (const auto& entry : *answer) got.insert(entry.name);
    EXPECT_EQ(got, expected);
    EXPECT_GT(expected.size(), 3u);
    EXPECT_LT(expected.size(), rows_.size());
  }

  const TemporaryFolder folder_;
  const std::vector<ArchiveEntry> rows_ = made_up_rows(3000);
  ArchiveIndex index_;
};

TEST_F(Queries, ByTimeFindWhatLiesAtLeastPartlyBetween) {
  ArchiveQuery q;
  q.from = "2025-07-01", q.to = "2025-07-20T12:00Z";
  const double from = 1751328000, to = 1753012800;
  expect_like(q, [&](const auto& e) { return e.end_s >= from && e.start_s < to; });
}

TEST_F(Queries, ByBoxGoAcrossTheDateLine) {
  ArchiveQuery q;
  q.box = "10,-20,60,45.5";
  expect_like(
      q, [](const auto& e) { return e.lon_deg >= 10 && e.lon_deg <= 60 && e.lat_deg >= -20 && e.lat_deg <= 45.5; });
  q.box = "170,-90,-160,90";
  expect_like(q, [](const auto& e) { return e.lon_deg >= 170 || e.lon_deg <= -160; });
}

TEST_F(Queries, ByDistanceAreExactAtPolesAndTheDateLine) {
  for (const auto& [near, km] : std::vector<std::pair<std::string, double>>{
           {"48.2,16.37", 1500}, {"89.9,12", 900}, {"-88,-179.9", 2500}, {"0,179.95", 1200}, {"0,0", 15000}}) {
    ArchiveQuery q;
    q.near = near, q.within_km = km;
    const auto comma = near.find(',');
    const ingest::GeoPoint place{std::stod(near.substr(0, comma)), std::stod(near.substr(comma + 1))};
    expect_like(q, [&](const auto& e) { return ingest::distance_m(place, {e.lat_deg, e.lon_deg}) <= km * 1000; });
  }
}

TEST_F(Queries, ByHeightAboveTakeOffLeaveOutWhatDoesNotKnowIt) {
  ArchiveQuery q;
  q.min_height_m = 400, q.max_height_m = 30;
  expect_like(q, [](const auto& e) {
    return e.surface_msl_m && e.top_msl_m - *e.surface_msl_m >= 400 && e.bottom_msl_m - *e.surface_msl_m <= 30;
  });
  q.datum = "msl";
  q.max_height_m = 1000;
  expect_like(q, [](const auto& e) { return e.top_msl_m >= 400 && e.bottom_msl_m <= 1000; });
}

TEST_F(Queries, ByVehicleStationQualityAndWindAllHold) {
  ArchiveQuery q;
  q.vehicle_id = "quad-1", q.station_id = "north", q.least_quality = "doubtful";
  q.min_speed_m_s = 6, q.max_speed_m_s = 9;
  expect_like(q, [](const auto& e) {
    return e.vehicle == "quad-1" && e.station == "north" && e.quality != ArchiveQuality::bad && e.speed_max_m_s >= 6 &&
           e.speed_min_m_s <= 9;
  });
  ArchiveQuery old;
  old.all_versions = true, old.vehicle_id = "quad-2";
  expect_like(old, [](const auto& e) { return e.vehicle == "quad-2"; });
}

TEST_F(Queries, WhatCannotBeReadIsToldAndNothingIsPastedIntoSql) {
  for (const auto& change : std::vector<std::function<void(ArchiveQuery&)>>{
           [](auto& q) { q.from = "yesterday"; }, [](auto& q) { q.to = "2025-13-01"; },
           [](auto& q) { q.box = "1,2,3"; }, [](auto& q) { q.box = "1,50,3,40"; }, [](auto& q) { q.box = "nan,0,1,1"; },
           [](auto& q) { q.near = "91,0"; }, [](auto& q) { q.near = "1,2;DROP TABLE profile"; }}) {
    ArchiveQuery q;
    change(q);
    const auto answer = query_index(index_, q);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().kind, ingest::Kind::usage);
  }
  ArchiveQuery q;
  q.vehicle_id = "x' OR '1'='1";
  EXPECT_TRUE(query_index(index_, q)->empty());
}

TEST(ArchiveAnswers, StayWithin80ColumnsAndQuoteWhatCsvMinds) {
  auto rows = made_up_rows(5);
  rows[0].vehicle = "a, \"b\"\nc", rows[1].station = std::string(60, 'x');
  const auto text = entries_text(rows);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_THAT(entries_csv(rows, "a"), HasSubstr("\"a, \"\"b\"\"\nc\""));
  EXPECT_EQ(Json::parse(entries_json(rows, "a"))["profiles"].size(), 5u);
}

Archive archive_of(const std::filesystem::path& root, const std::vector<support::MadeUp>& all) {
  auto archive = Archive::open_or_create(root);
  for (const auto& made : all) EXPECT_TRUE(archive->add({support::made_up_candidate(made)}));
  return std::move(*archive);
}

TEST(ArchiveExport, ASubsetIsAnArchiveOfItsOwn) {
  const TemporaryFolder folder;
  auto archive = archive_of(folder / "a", {{1}, {2}, {2, 20}, {3}});
  ArchiveQuery q;
  q.all_versions = true;
  q.to = "2025-06-15T20:00Z";
  const auto entries = *archive.query(q);
  ASSERT_TRUE(export_subset(archive, entries, folder / "b", false, {}));
  auto subset = *Archive::open(folder / "b");
  EXPECT_EQ(subset.query(q)->size(), entries.size());
  EXPECT_TRUE(subset.verify()->findings.empty());
  for (const auto& e : entries) EXPECT_EQ(*subset.read(e), *archive.read(e));
  EXPECT_FALSE(export_subset(archive, entries, folder / "b", false, {})) << "nothing is overwritten unasked";
  ASSERT_TRUE(export_subset(archive, {entries[0]}, folder / "b", true, {}));
  EXPECT_EQ(Archive::open(folder / "b")->query({})->size(), 1u);
}

TEST(ArchiveExport, OneNetcdfHoldsEveryRecordWithItsOwnNumbers) {
  const TemporaryFolder folder;
  auto archive = archive_of(folder / "a", {{1, 10, "here"}, {2, 10, "here", "quad-08", 2.5}});
  const auto entries = *archive.query({});
  const auto merged = merged_netcdf(archive, entries, {}, {});
  ASSERT_TRUE(merged) << ingest::to_string(merged.error());
  EXPECT_EQ(*merged, *merged_netcdf(archive, entries, {}, {}));
  support::NcReader nc(*merged);
  EXPECT_EQ(nc.attribute(nullptr, "featureType"), "timeSeriesProfile");
  ASSERT_EQ(nc.length("time"), 4u);
  const auto times = nc.numbers("time"), east = nc.numbers("eastward_wind"), z = nc.numbers("altitude"),
             from = nc.numbers("wind_from_direction"), se = nc.numbers("northward_wind_se");
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  std::size_t row = 0;
  for (const auto& e : entries) {
    support::NcReader own(*archive.read(e));
    const auto own_east = own.numbers("eastward_wind"), own_z = own.numbers("altitude"),
               own_from = own.numbers("wind_from_direction"), own_se = own.numbers("northward_wind_se");
    for (std::size_t r = 0; r < own.length("time"); ++r, ++row)
      for (std::size_t i = 0; i < own_z.size(); ++i) {
        const auto k = static_cast<std::size_t>(std::find(z.begin(), z.end(), own_z[i]) - z.begin());
        ASSERT_LT(k, z.size());
        const auto there = row * z.size() + k, here = r * own_z.size() + i;
        const auto expect_same = [&](double a, double b) {
          EXPECT_TRUE((std::isnan(a) && std::isnan(b)) || std::abs(a - b) < 1e-4) << a << " " << b;
        };
        expect_same(east[there], own_east[here]), expect_same(from[there], own_from[here]);
        expect_same(se[there], own_se[here]);
      }
  }
  EXPECT_FALSE(archive_candidate(*merged, "merged.nc")) << "it is no profile of one flight";
}

TEST(ArchiveExport, SitesApartGiveAPlacePerRecord) {
  const TemporaryFolder folder;
  auto archive = archive_of(folder / "a", {{1}, {9}});
  const auto merged = merged_netcdf(archive, *archive.query({}), {MergeAxis::height, 20.0}, {});
  ASSERT_TRUE(merged) << ingest::to_string(merged.error());
  support::NcReader nc(*merged);
  EXPECT_EQ(nc.attribute(nullptr, "featureType"), "profile");
  EXPECT_EQ(nc.numbers("lat").size(), nc.length("time"));
  EXPECT_DOUBLE_EQ(nc.numbers("height")[0], 10);
}

TEST(ArchiveExport, FlightsAtTheSameMomentAreNotMixed) {
  const TemporaryFolder folder;
  auto archive = archive_of(folder / "a", {{1}});
  auto twin = support::made_up_candidate({1, 20});
  twin.entry.flight_id[0] = twin.entry.flight_id[0] == '0' ? '1' : '0';
  twin.entry.input_sha256 = twin.entry.flight_id.substr(0, 64);
  ASSERT_TRUE(archive.add({twin}));
  const auto merged = merged_netcdf(archive, *archive.query({}), {}, {});
  ASSERT_FALSE(merged);
  EXPECT_THAT(merged.error().hint, HasSubstr("--vehicle-id"));
}

TEST(Regrid, AveragesByOverlapAndNeedsHalfOfABin) {
  StoredProfile p;
  p.bottom_msl_m = {100, 110, 120}, p.top_msl_m = {110, 120, 130};
  StoredRecord r;
  const auto bin = [](double east, int quality) {
    StoredBin b;
    b.east = east, b.north = 0, b.speed = east, b.se_east = 0.2, b.se_north = 0.1, b.covariance = 0.01;
    b.quality = quality, b.samples = 100;
    return b;
  };
  r.bins = {bin(2, 1), bin(6, 3), StoredBin{}};
  const auto out = regrid(p, r, 95, {0, 10, 20, 30, 40});
  ASSERT_EQ(out.size(), 4u);
  EXPECT_DOUBLE_EQ(*out[0].east, 2);  // 100 to 105 covers half of it
  EXPECT_DOUBLE_EQ(*out[1].east, 4);  // half of each
  EXPECT_EQ(out[1].quality, 3);
  EXPECT_EQ(out[1].samples, 100);
  EXPECT_NEAR(*out[1].se_east, 0.2, 1e-12);
  EXPECT_NEAR(*out[1].covariance, 0.01, 1e-12);
  EXPECT_DOUBLE_EQ(*out[2].east, 6);
  EXPECT_FALSE(out[3].has_wind());
}

}  // namespace
}  // namespace quadsonde::product
