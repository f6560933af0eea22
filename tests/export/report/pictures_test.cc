#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "export/report/axis.h"
#include "export/report/barb.h"
#include "export/report/plot.h"
#include "export/report/profile_picture.h"
#include "export/report/section_answer.h"
#include "export/report/section_picture.h"
#include "export/report/series_picture.h"
#include "export/report/state_picture.h"
#include "tests/export/made_up.h"
#include "tests/export/report/xml_check.h"

namespace quadsonde::product {
namespace {

using testing::HasSubstr;
using testing::Not;

FlightTitle title() {
  return {"a<b>&.ulg",  1,    2, ingest::UtcTime{1'750'000'000'000'000'000}, ingest::GeoPoint{43.5657, 1.4815}, 460,
          "quad \"7\"", "PX4"};
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(ProfilePicture, IsWellFormedWhateverTheLogCallsItself) {
  const auto svg = profile_svg(support::made_up_profile(), {title(), "drag & <more>", {}, "true wind", "profile"});
  EXPECT_EQ(support::xml_fault(svg), std::nullopt);
  EXPECT_THAT(svg, HasSubstr("a&lt;b&gt;&amp;.ulg, flight 1 of 2"));
}

TEST(ProfilePicture, LoadsNothingFromElsewhere) {
  const auto svg = profile_svg(support::made_up_profile(), {title(), "", {}, "true wind", "profile"});
  for (const auto* word : {"href", "<image", "<style", "@import", "<script", "url(http"})
    EXPECT_THAT(svg, Not(HasSubstr(word))) << word;
  EXPECT_EQ(count(svg, "http"), 1u) << "the namespace of SVG and nothing else";
}

TEST(ProfilePicture, ShowsAscentAndDescentApartAndTheTruthWhereThereIsOne) {
  const auto profile = support::made_up_profile();
  ProfilePicture picture{title(), "", {}, "true wind", "profile"};
  const auto without = profile_svg(profile, picture);
  EXPECT_THAT(without, HasSubstr(">ascent<"));
  EXPECT_THAT(without, HasSubstr(">descent<"));
  EXPECT_THAT(without, Not(HasSubstr("true wind")));
  picture.reference = {{15, {1, 2}}, {225, {3, 4}}};
  EXPECT_THAT(profile_svg(profile, picture), HasSubstr(">true wind<"));
}

ReferenceMark metar_mark() {
  ReferenceMark mark;
  mark.name = "METAR <LF&BO>";
  mark.height = 10, mark.speed = 4, mark.low = 3.7, mark.high = 4.3;
  mark.from_deg = 350, mark.from_half_deg = 5;
  return mark;
}

TEST(ProfilePicture, ShowsReportsAsMarksWithTheirRangeAndGusts) {
  ProfilePicture picture{title(), "", {}, "true wind", "profile"};
  const auto profile = support::made_up_profile();
  const auto without = profile_svg(profile, picture);
  auto mark = metar_mark();
  mark.gust = 9;
  mark.sector_deg = {330, 20};
  picture.marks = {mark};
  const auto with = profile_svg(profile, picture);
  EXPECT_EQ(support::xml_fault(with), std::nullopt);
  EXPECT_THAT(with, HasSubstr(">METAR &lt;LF&amp;BO&gt;<"));
  EXPECT_THAT(with, HasSubstr(">gust<"));
  EXPECT_EQ(count(with, colour::green), count(without, colour::green) + 3 + 1 + 1 + 1 + 3 + 1 + 3 + 1 + 1)
      << "speed: bar of three strokes, diamond, gust with its line; direction: bar, diamond; the same in the legend";
}

TEST(ProfilePicture, ShowsNoDirectionOfAVariableWind) {
  ProfilePicture picture{title(), "", {}, "true wind", "profile"};
  auto mark = metar_mark();
  mark.from_deg.reset();
  picture.marks = {mark};
  const auto svg = profile_svg(support::made_up_profile(), picture);
  EXPECT_EQ(count(svg, colour::green), 3u + 1 + 3 + 1) << "speed and legend";
}

TEST(ProfilePicture, DrawsDoubtfulBinsHollowAndBadOnesAsCrosses) {
  auto profile = support::made_up_profile();
  const ProfilePicture picture{title(), "", {}, "true wind", "profile"};
  const auto hollow = [](const std::string& svg) { return count(svg, "r=\"3.4\" fill=\"#ffffff\""); };
  // Five doubtful bins in the descent, in two panels, and one in the legend.
  EXPECT_EQ(hollow(profile_svg(profile, picture)), 11u);
  profile.legs[0].bins[0].quality = estimator::Quality::bad;
  EXPECT_THAT(profile_svg(profile, picture), HasSubstr(">bad<"));
}

TEST(ProfilePicture, BreaksItsLinesWhereABinIsEmpty) {
  auto profile = support::made_up_profile();
  const ProfilePicture picture{title(), "", {}, "true wind", "profile"};
  const auto with_gap = count(profile_svg(profile, picture), "<polygon");
  profile.legs[1].bins[14] = support::bin_at(150, 8, 266, 0.2);
  EXPECT_EQ(with_gap, count(profile_svg(profile, picture), "<polygon") + 2) << "one band more in each panel";
}

TEST(ProfilePicture, DrawsDirectionsAcrossNorthWithoutALeap) {
  profiles::WindProfile profile;
  profiles::Leg all{profiles::LegName::all, {}};
  for (int i = 0; i < 10; ++i) all.bins.push_back(support::bin_at(10.0 * i, 6, i % 2 ? 355 : 5, 0.1));
  profile.legs = {all};
  const auto svg = profile_svg(profile, {title(), "", {}, "true wind", "profile"});
  EXPECT_THAT(svg, HasSubstr("360\xC2\xB0 N"));
  EXPECT_THAT(svg, Not(HasSubstr("180\xC2\xB0"))) << "the axis stays around north";
}

TEST(ProfilePicture, SaysSoWhenThereIsNoWind) {
  profiles::WindProfile profile;
  EXPECT_EQ(support::xml_fault(profile_svg(profile, {title(), "", {}, "true wind", "profile"})), std::nullopt);
  EXPECT_THAT(profile_svg(profile, {title(), "", {}, "true wind", "profile"}), HasSubstr("No wind could be estimated"));
}

TEST(SeriesPicture, IsWellFormedAndThinnedToWhatAPictureShows) {
  const auto small = series_svg(support::made_up_series(400), {title(), nullptr, "series"});
  const auto large = series_svg(support::made_up_series(60'000), {title(), nullptr, "series"});
  EXPECT_EQ(support::xml_fault(small), std::nullopt);
  EXPECT_EQ(support::xml_fault(large), std::nullopt);
  EXPECT_LT(large.size(), 300'000u);
  EXPECT_THAT(small, Not(HasSubstr("classic filter")));
  const auto classic = support::made_up_series(400);
  EXPECT_THAT(series_svg(classic, {title(), &classic, "series"}), HasSubstr("classic filter"));
}

TEST(SeriesPicture, SurvivesASeriesWithoutAnyWind) {
  estimator::WindSeries series;
  EXPECT_EQ(support::xml_fault(series_svg(series, {title(), nullptr, "series"})), std::nullopt);
}

TEST(SeriesPicture, DrawsTheReferenceOverTheTimeOfTheFlightAndNamesIt) {
  const auto series = support::made_up_series(400);
  SeriesPicture picture{title(), nullptr, "series", {}, "true wind"};
  EXPECT_THAT(series_svg(series, picture), Not(HasSubstr("true wind")));
  for (const auto& point : series.points) picture.reference.push_back({point.time, {3, 1}});
  EXPECT_THAT(series_svg(series, picture), HasSubstr(">true wind<"));
  for (auto& point : picture.reference) point.time = point.time + ingest::seconds(1e6);
  EXPECT_THAT(series_svg(series, picture), Not(HasSubstr("true wind"))) << "a reference of another day is not drawn";
}

TEST(StatePicture, ShowsOursAndTheClassicFilterWithTheMeasuredVelocity) {
  auto series = support::made_up_series(400);
  ingest::Stream<Eigen::Vector3d> velocity;
  for (auto& point : series.points) {
    point.v_AB_N = Eigen::Vector2d(1, -2);
    velocity.push(point.time, {0.5, 0.5, 0});
  }
  StatePicture picture;
  picture.title = title();
  const auto alone = state_svg(series, picture);
  picture.classic = &series;
  picture.velocity = &velocity;
  const auto all = state_svg(series, picture);
  EXPECT_EQ(support::xml_fault(all), std::nullopt);
  for (const char* word : {"airspeed north (m/s)", "airspeed east (m/s)", "wind toward north (m/s)",
                           "wind toward east (m/s)", "classic filter", "measured over ground"})
    EXPECT_THAT(all, HasSubstr(word));
  EXPECT_EQ(count(all, "<polyline"), count(alone, "<polyline") + 2 + 4 + 2) << "two in the legend, six curves";
  EXPECT_EQ(support::xml_fault(state_svg({}, picture)), std::nullopt);
}

TEST(Axis, HasRoundTicksThatHoldTheValues) {
  const auto axis = round_axis(0.3, 8.9, 0, 100, 6);
  EXPECT_EQ(axis.low, 0);
  EXPECT_EQ(axis.high, 10);
  EXPECT_EQ(axis.step, 2);
  EXPECT_EQ(axis.ticks().size(), 6u);
  EXPECT_EQ(axis.label(4), "4");
  const auto angles = angle_axis(243, 287, 0, 100, 5);
  EXPECT_EQ(angles.step, 10);
  EXPECT_EQ(angles.low, 240);
  EXPECT_EQ(angles.high, 290);
}

// WMO-No. 485: 25 m/s is one pennant, 17.5 three feathers and a half; feathers to the right of a north wind's staff in
// the northern hemisphere, to its left in the southern.
TEST(Barb, CountsFeathersBySpeedAndTurnsThemByHemisphere) {
  const auto path_of = [](double speed, bool southern) {
    Markup m;
    draw_barb(m, 0, 0, speed, 0, southern, "#000");
    return m.str();
  };
  EXPECT_EQ(count(path_of(17.5, false), "M0"), 1u + 3u + 1u);
  EXPECT_EQ(count(path_of(25, false), "Z"), 1u);
  EXPECT_THAT(path_of(5, false), HasSubstr("L10 -30"));
  EXPECT_THAT(path_of(5, true), HasSubstr("L-10 -30"));
  EXPECT_THAT(path_of(1, false), Not(HasSubstr("path"))) << "calm is a ring";
}

TEST(DirectionLabel, IsTheMeteorologistsCircle) {
  EXPECT_EQ(direction_label(0), "360\xC2\xB0 N");
  EXPECT_EQ(direction_label(-90), "270\xC2\xB0 W");
  EXPECT_EQ(direction_label(405), "45\xC2\xB0");
  EXPECT_DOUBLE_EQ(unwrapped(350, 10), -10);
}

/// Four legs of the made-up profile, an hour apart in pairs; the second is doubtful up to 60 m and has an empty bin.
profiles::Section made_up_section() {
  const auto profile = support::made_up_profile();
  profiles::Section section;
  for (int i = 0; i < 4; ++i) {
    profiles::SectionColumn column{"a<b>.ulg", profile.legs[static_cast<std::size_t>(i % 2)], {}, {}};
    const auto start = ingest::UtcTime{1'750'000'000'000'000'000} + ingest::seconds(300 * i + 3600 * (i / 2));
    column.from = start, column.to = start + ingest::seconds(240);
    for (auto& bin : column.leg.bins)
      if (bin.utc) bin.utc = start + ingest::seconds(i % 2 ? 240 - bin.bottom : bin.bottom);
    section.columns.push_back(column);
  }
  return section;
}

TEST(SectionPicture, DrawsAMarkForEachBinThatWasMeasuredAndNothingBetween) {
  const auto section = made_up_section();
  const auto svg = section_svg(section, {title(), "s"});
  EXPECT_EQ(support::xml_fault(svg), std::nullopt);
  EXPECT_EQ(count(svg, "fill-opacity"), 4u * 23 - 2) << "two bins are empty";
  EXPECT_EQ(count(svg, "fill-opacity=\"0.12\""), 10u) << "the doubtful ones are pale";
  for (const auto* word : {"UTC, from 2025-06-15", "height above take-off (m)", "wind speed (m/s)"})
    EXPECT_THAT(svg, HasSubstr(word));
}

TEST(SectionPicture, OfNothingSaysSo) {
  EXPECT_THAT(section_svg({}, {title(), "s"}), HasSubstr("No wind could be estimated"));
}

TEST(SectionPicture, ColoursGrowWithTheSpeedOverTheSectionsOwnRange) {
  const auto scale = SpeedScale::of(made_up_section());
  EXPECT_EQ(scale.step, 1.0);
  EXPECT_EQ(scale.first, 2.0);
  EXPECT_EQ(scale.colour(2.1), scale.colour(2.9));
  EXPECT_NE(scale.colour(2.1), scale.colour(3.1));
  EXPECT_EQ(scale.colour(99), scale.colour(8.5)) << "the last class is open";
}

TEST(SectionAnswer, IsATableOfAtMost80ColumnsWithHeightDownAndTimeAcross) {
  const auto text = section_answer(title(), made_up_section(), ingest::class_prior());
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_THAT(text, HasSubstr("15:08:40"));
  EXPECT_LT(text.find("  230-240"), text.find("   10-20"));
  EXPECT_THAT(text, HasSubstr("?"));
}

}  // namespace
}  // namespace quadsonde::product
