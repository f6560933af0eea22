#include "export/csv/read_tables.h"

#include <gtest/gtest.h>

#include "export/csv/tables.h"
#include "tests/export/made_up.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using estimator::WindSeries;
using profiles::WindProfile;

template <class Content>
Content read_one(const std::string& text) {
  const auto tables = read_tables(text, "t");
  if (!tables) ADD_FAILURE() << ingest::to_string(tables.error());
  if (!tables || tables->size() != 1 || !std::holds_alternative<Content>(tables->front().content)) return {};
  return std::get<Content>(tables->front().content);
}

/// Rows as far as they are not derived from others: speeds and directions are made again from rounded components.
void expect_same(const WindSeries& a, const WindSeries& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].time, b.points[i].time);
    EXPECT_EQ(a.points[i].utc, b.points[i].utc);
    EXPECT_NEAR(a.points[i].height_agl->m, b.points[i].height_agl->m, 0.0051) << "two decimals";
    EXPECT_EQ(a.points[i].quality, b.points[i].quality);
    const auto *x = std::get_if<WindEstimate>(&a.points[i].wind), *y = std::get_if<WindEstimate>(&b.points[i].wind);
    ASSERT_EQ(x != nullptr, y != nullptr);
    if (!x) continue;
    EXPECT_LT((x->v_NA_N - y->v_NA_N).norm(), 1e-4) << "four decimals";
    EXPECT_LT((x->covariance - y->covariance).norm(), 1e-4);
  }
}
void expect_same(const WindProfile& a, const WindProfile& b) {
  ASSERT_EQ(a.legs.size(), b.legs.size());
  EXPECT_EQ(a.bin_m, b.bin_m);
  for (std::size_t l = 0; l < a.legs.size(); ++l) {
    EXPECT_EQ(a.legs[l].name, b.legs[l].name);
    ASSERT_EQ(a.legs[l].bins.size(), b.legs[l].bins.size());
    for (std::size_t i = 0; i < a.legs[l].bins.size(); ++i) {
      const auto &x = a.legs[l].bins[i], &y = b.legs[l].bins[i];
      EXPECT_EQ(x.bottom, y.bottom);
      EXPECT_EQ(x.samples, y.samples);
      EXPECT_EQ(x.utc, y.utc);
      EXPECT_EQ(x.quality, y.quality);
      EXPECT_EQ(x.sd_sampling, y.sd_sampling);
      const auto *v = std::get_if<WindEstimate>(&x.wind), *w = std::get_if<WindEstimate>(&y.wind);
      ASSERT_EQ(v != nullptr, w != nullptr);
      if (v) {
        EXPECT_LT((v->v_NA_N - w->v_NA_N).norm(), 1e-4);
      }
    }
  }
}

TEST(ReadTables, GiveBackWhatWasWritten) {
  const auto series = support::made_up_series();
  const auto profile = support::made_up_profile();
  const auto source = support::made_up_source();
  expect_same(series, read_one<WindSeries>(wind_csv(series)));
  expect_same(series, read_one<WindSeries>(wind_json(series, source)));
  expect_same(profile, read_one<WindProfile>(profile_csv(profile)));
  expect_same(profile, read_one<WindProfile>(profile_json(profile, source)));
}

TEST(ReadTables, KeepWhatIsNotKnownUnknown) {
  auto series = support::made_up_series(30);
  series.points[20].utc.reset();
  series.points[20].height_agl.reset();
  const auto read = read_one<WindSeries>(wind_csv(series));
  EXPECT_FALSE(std::holds_alternative<WindEstimate>(read.points[0].wind)) << "converging";
  EXPECT_FALSE(read.points[20].utc);
  EXPECT_FALSE(read.points[20].height_agl);
  EXPECT_TRUE(read.points[20].height_msl);
}

TEST(ReadTables, OfAJsonNameTheLogAndFlightAndOfAListEachOne) {
  const auto source = support::made_up_source();
  const auto one = profile_json(support::made_up_profile(), source);
  const auto two = read_tables(json_list({one, wind_json(support::made_up_series(), source)}), "two.json");
  ASSERT_TRUE(two);
  ASSERT_EQ(two->size(), 2u);
  EXPECT_EQ(two->front().made_of, "hover.ulg");
  EXPECT_EQ(two->front().flight, 2);
  EXPECT_EQ(std::get<WindSeries>(two->back().content).diagnostics.sigma_u, 0.5);
}

TEST(ReadTables, FindTheDatumOfAProfileByItsHeights) {
  auto profile = support::made_up_profile();
  EXPECT_EQ(read_one<WindProfile>(profile_csv(profile)).datum, profiles::Datum::agl);
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.bottom += 150, bin.top += 150;
  const auto msl = read_one<WindProfile>(profile_csv(profile));
  EXPECT_EQ(msl.datum, profiles::Datum::msl);
  EXPECT_EQ(msl.bin_m, 10);
}

TEST(ReadTables, NameTheLineAndColumnOfADamagedField) {
  const auto good = profile_csv(support::made_up_profile());
  auto bad = good;
  const auto second = bad.find('\n', bad.find('\n') + 1) + 1;
  bad.replace(bad.find(',', second) + 1, 1, "x");
  const auto read = read_tables(bad, "p.csv");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ingest::Kind::damaged);
  EXPECT_EQ(read.error().where.line, 3u);
  EXPECT_EQ(read.error().where.topic, "bin_bottom_m");
}

TEST(ReadTables, RefuseWhatIsNotOurs) {
  for (const auto* text : {"", "hello\n", "a,b\n1,2\n", "{}", "[1,2]", R"({"schema":"quadsonde.info/1","rows":[]})"}) {
    EXPECT_EQ(table_kind(text), TableKind::none) << text;
    const auto read = read_tables(text, "x");
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().kind, ingest::Kind::not_a_log) << text;
  }
  EXPECT_EQ(read_tables("leg,bin_bottom_m\n", "x").error().where.topic, "bin_top_m");
  EXPECT_EQ(read_tables(wind_csv({}), "x").error().kind, ingest::Kind::missing) << "a header alone";
  EXPECT_FALSE(read_tables(R"({"schema":"quadsonde.wind/1","rows":[1,2]})", "x"));
  EXPECT_FALSE(read_tables(R"([{"schema":"quadsonde.wind/1","rows":[{}]}])", "x"));
}

TEST(ReadTables, SurviveEveryTruncationAndDeepNesting) {
  auto small = support::made_up_profile();
  for (auto& leg : small.legs) leg.bins.resize(2);
  const auto csv = profile_csv(small);
  const auto json = profile_json(small, support::made_up_source());
  for (std::size_t n = 0; n < csv.size(); ++n)
    if (const auto read = read_tables(csv.substr(0, n), "x")) {
      EXPECT_LE(read->size(), 1u);
    }
  for (std::size_t n = 0; n + 1 < json.size(); n += 7) EXPECT_FALSE(read_tables(json.substr(0, n), "x"));
  const auto deep = std::string(200'000, '[') + R"("quadsonde.wind/1")";
  EXPECT_FALSE(read_tables(deep, "x"));
  EXPECT_FALSE(read_tables(deep + std::string(200'000, ']'), "x"));
}

}  // namespace
}  // namespace quadsonde::product
