#include "export/kml/kml.h"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/export/cf_netcdf/run_python.h"
#include "tests/export/made_up.h"
#include "tests/export/report/xml_check.h"

namespace quadsonde {
namespace {

using testing::HasSubstr;

product::FlightTitle title() {
  product::FlightTitle t;
  t.file = "hover.ulg";
  return t;
}
std::string kml_of(const profiles::WindProfile& profile, product::ProductSource source = support::made_up_source(),
                   const product::FlightTitle& named = title()) {
  const auto text = product::profile_kml(profile, support::made_up_series(), source, named);
  EXPECT_TRUE(text) << (text ? "" : ingest::to_string(text.error()));
  return text.value_or("");
}

/// What a parser that is not ours finds in it.
std::vector<std::string> seen(const std::string& kml) {
  const support::TemporaryFolder folder;
  support::write_bytes(folder / "a.kml", {kml.begin(), kml.end()});
  const auto command = std::string("/usr/bin/python3 '") + QUADSONDE_KML_CHECK + "' '" + (folder / "a.kml").string() +
                       "' > '" + (folder / "out").string() + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const auto bytes = support::read_bytes(folder / "out");
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Kml, ShowsTheTrackAndABarbAtEveryBinOfTheWholeFlight) {
  const auto lines = seen(kml_of(support::made_up_profile()));
  ASSERT_EQ(lines.size(), 1u + 23);
  EXPECT_THAT(lines[0], testing::StartsWith("69 24 ")) << "the track, three legs less an empty bin; legs are hidden";
}

TEST(Kml, BarbsPointToWhereTheWindComesFrom) {
  auto profile = support::made_up_profile();
  profile.legs.resize(1);
  profile.legs[0].bins.resize(3);
  profile.legs[0].bins[0].wind = support::estimate_of(7.5, 270, 0.1);
  profile.legs[0].bins[1].wind = support::estimate_of(30, 360, 0.1);
  profile.legs[0].bins[2].wind = support::estimate_of(4, 45, 0.1);
  const auto lines = seen(kml_of(profile));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_THAT(lines[0], testing::EndsWith(" 1")) << "one pennant, for 25 m/s";
  EXPECT_THAT(lines[1], testing::MatchesRegex("15 m: 7.5 m/s from 270.*\\|(19.9|20.0|20.1)\\|2(70.0|69.9)"));
  EXPECT_THAT(lines[2], testing::MatchesRegex("25 m: 30.0 m/s from 360.*\\|(19.9|20.0|20.1)\\|(0.0|360.0)"));
  EXPECT_THAT(lines[3], testing::MatchesRegex("35 m: 4.0 m/s from 45.*\\|(19.9|20.0|20.1)\\|4(5.0|4.9|5.1)"));
}

TEST(Kml, HeightsAreAboveTheSeaElseAboveTheGround) {
  EXPECT_THAT(kml_of(support::made_up_profile()), HasSubstr("<coordinates>1.4815000,43.5657000,165.10</coordinates>"));
  auto series = support::made_up_series();
  auto profile = support::made_up_profile();
  for (auto& p : series.points) p.height_msl.reset();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.height_msl.reset();
  const auto text = product::profile_kml(profile, series, support::made_up_source(), title());
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, HasSubstr("relativeToGround"));
  EXPECT_THAT(*text, testing::Not(HasSubstr("absolute")));
  EXPECT_THAT(*text, HasSubstr("<coordinates>1.4815000,43.5657000,15.10</coordinates>"));
}

TEST(Kml, AWindWhoseDirectionIsNotKnownHasNoBarb) {
  auto profile = support::made_up_profile();
  profile.legs.resize(1);
  profile.legs[0].bins.resize(2);
  profile.legs[0].bins[0].wind = support::estimate_of(2, 270, 2);
  profile.legs[0].bins[1].wind = support::estimate_of(0.5, 270, 0.4);
  const auto text = kml_of(profile);
  EXPECT_THAT(text, HasSubstr("2.0 m/s, direction not determined"));
  EXPECT_EQ(seen(text).size(), 1u + 1) << "a ring for the calm only";
}

TEST(Kml, TheWindAlongTheFlightIsThinned) {
  const auto text = product::wind_kml(support::made_up_series(5000), support::made_up_source(), title());
  ASSERT_TRUE(text);
  const auto lines = seen(*text);
  EXPECT_GT(lines.size(), 50u);
  EXPECT_LE(lines.size(), 61u);
}

TEST(Kml, NamesThatXmlMindsDoNoHarm) {
  auto source = support::made_up_source();
  auto named = title();
  source.file = named.file = "]]></name><script>&amp;\"'\x01\xff.ulg";
  const auto text = kml_of(support::made_up_profile(), source, named);
  EXPECT_EQ(support::xml_fault(text.substr(text.find('\n') + 1)).value_or(""), "") << "after the XML declaration";
  EXPECT_EQ(text.find("<script>"), std::string::npos);
  EXPECT_FALSE(seen(text).empty());
}

TEST(Kml, WithoutAPlaceOrAHeightThereIsNone) {
  auto series = support::made_up_series(), no_height = series;
  for (auto& p : series.points) p.place.reset();
  for (auto& p : no_height.points) p.height_msl.reset(), p.height_agl.reset();
  EXPECT_THAT(product::wind_kml(series, support::made_up_source(), title()).error().what, HasSubstr("place"));
  EXPECT_THAT(product::wind_kml(no_height, support::made_up_source(), title()).error().what, HasSubstr("height"));
}

}  // namespace
}  // namespace quadsonde
