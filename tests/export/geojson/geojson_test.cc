#include "export/geojson/geojson.h"

#include <gtest/gtest.h>

#include "export/csv/json.h"
#include "export/geoid/geoid.h"
#include "tests/export/made_up.h"

namespace quadsonde {
namespace {

using product::Json;

Json parsed(const ingest::Result<std::string>& text) {
  EXPECT_TRUE(text) << (text ? "" : ingest::to_string(text.error()));
  return text ? Json::parse(*text) : Json();
}
Json profile_json(const profiles::WindProfile& profile, const product::ProductSource& source) {
  return parsed(product::profile_geojson(profile, support::made_up_series(), source));
}

TEST(Geojson, IsATrackAndThePointsOfEveryBin) {
  const auto json = profile_json(support::made_up_profile(), support::made_up_source());
  EXPECT_EQ(json["type"], "FeatureCollection");
  const auto& features = json["features"];
  ASSERT_EQ(features.size(), 1u + 23 + 22 + 23) << "an empty bin was never anywhere";
  EXPECT_EQ(features[0]["geometry"]["type"], "LineString");
  EXPECT_EQ(features[0]["geometry"]["coordinates"].size(), 40u) << "40 s, a point each second";
  const auto& bin = features[1];
  EXPECT_EQ(bin["type"], "Feature");
  EXPECT_EQ(bin["geometry"]["type"], "Point");
  EXPECT_EQ(bin["properties"]["leg"], "up");
  EXPECT_EQ(bin["properties"]["height_msl_m"], 165.1);
  EXPECT_EQ(bin["properties"]["quality"], "good");
  EXPECT_TRUE(bin["properties"]["reasons"].is_array());
  EXPECT_EQ(json["quadsonde"]["source"]["sha256"], "00ff");
}

TEST(Geojson, PositionsAreLongitudeLatitudeAndTheHeightAboveTheEllipsoid) {
  const auto json = profile_json(support::made_up_profile(), support::made_up_source());
  const auto& at = json["features"][1]["geometry"]["coordinates"];
  ASSERT_EQ(at.size(), 3u);
  EXPECT_EQ(at[0], 1.4815);
  EXPECT_EQ(at[1], 43.5657);
  EXPECT_NEAR(at[2].get<double>(), 165.1 + *product::Geoid::open().undulation({43.5657, 1.4815}), 0.006);
}

TEST(Geojson, WithoutAHeightAboveTheSeaPositionsHaveTwoNumbers) {
  auto profile = support::made_up_profile();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.height_msl.reset();
  EXPECT_EQ(profile_json(profile, support::made_up_source())["features"][1]["geometry"]["coordinates"].size(), 2u);
}

TEST(Geojson, AStepWithoutAWindHasNullsAndItsReason) {
  const auto json = parsed(product::wind_geojson(support::made_up_series(), support::made_up_source()));
  ASSERT_EQ(json["features"].size(), 401u);
  const auto& properties = json["features"][1]["properties"];
  EXPECT_TRUE(properties["wind_speed_m_s"].is_null());
  EXPECT_EQ(properties["reasons"][0], "converging");
  EXPECT_EQ(properties["mode"], "smoothed");
}

TEST(Geojson, ATrackOverTheDateLineIsCutThere) {
  auto series = support::made_up_series();
  for (std::size_t i = 0; i < series.points.size(); ++i)
    series.points[i].place = ingest::GeoPoint{-17, i < 200 ? 179.999 : -179.999};
  const auto json = parsed(product::wind_geojson(series, support::made_up_source()));
  EXPECT_EQ(json["features"][0]["geometry"]["type"], "MultiLineString");
  EXPECT_EQ(json["features"][0]["geometry"]["coordinates"].size(), 2u);
}

TEST(Geojson, NamesThatJsonMindsDoNoHarm) {
  auto source = support::made_up_source();
  source.file = "a\"b\\c\x01\xff\n.ulg";
  EXPECT_EQ(profile_json(support::made_up_profile(), source)["quadsonde"]["source"]["file"],
            "a\"b\\c\x01\xef\xbf\xbd\n.ulg");
}

TEST(Geojson, WithoutAPlaceThereIsNone) {
  auto series = support::made_up_series();
  for (auto& p : series.points) p.place.reset();
  const auto text = product::wind_geojson(series, support::made_up_source());
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().kind, ingest::Kind::missing);
}

}  // namespace
}  // namespace quadsonde
