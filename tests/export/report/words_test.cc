#include "export/report/words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "export/report/text_answer.h"
#include "tests/export/made_up.h"

namespace quadsonde::product {
namespace {

using testing::HasSubstr;

TEST(Words, NameTheSixteenDirectionsOfTheCompass) {
  EXPECT_EQ(compass_word(360), "north");
  EXPECT_EQ(compass_word(11.2), "north");
  EXPECT_EQ(compass_word(11.3), "north-northeast");
  EXPECT_EQ(compass_word(270), "west");
  EXPECT_EQ(compass_word(337.6), "north-northwest");
}

TEST(Words, TellPlacesAndDurationsAsPeopleDo) {
  EXPECT_EQ(place_text({-33.5, -70.25}), "33.5000 S, 70.2500 W");
  EXPECT_EQ(duration_text(460.4), "7 min 40 s");
  EXPECT_EQ(duration_text(3725), "1 h 02 min");
  EXPECT_EQ(minute_text(ingest::UtcTime{1'750'000'000'000'000'000}), "2025-06-15 15:06 UTC");
}

TEST(Wrapped, KeepsWordsWholeAndLinesShort) {
  const auto text = wrapped("- one two three four", 10, 2);
  EXPECT_EQ(text, "- one two\n  three\n  four");
  EXPECT_EQ(wrapped("    indented", 79, 4), "    indented");
}

TEST(ProfileAnswer, FitsIn80ColumnsOfPlainAscii) {
  const FlightTitle title{"a.ulg", 1, 3, {}, {}, 460, std::string(100, 'v'), ""};
  const auto series = support::made_up_series();
  for (const auto& text : {profile_answer(title, support::made_up_profile(), series.diagnostics, ingest::class_prior()),
                           wind_answer(title, series, ingest::class_prior())}) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
    std::istringstream again(text);
    int too_long = 0;
    for (std::string line; std::getline(again, line);)
      too_long += line.size() > 80 && line.find("vvv") == std::string::npos;
    EXPECT_EQ(too_long, 0) << text;
    EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) { return c == '\n' || (c >= 32 && c < 127); }));
  }
}

TEST(ProfileAnswer, SaysWhatItRestsOnAndWhatWouldMakeItBetter) {
  auto diagnostics = support::made_up_series().diagnostics;
  diagnostics.trim_estimated = false;
  const auto text = profile_answer({"a.ulg", 1, 1, {}, {}, 460, "", ""}, support::made_up_profile(), diagnostics,
                                   ingest::class_prior());
  EXPECT_THAT(text, HasSubstr("No vehicle file"));
  EXPECT_THAT(text, HasSubstr("35 %"));
  EXPECT_THAT(text, HasSubstr("--vehicle FILE"));
  EXPECT_THAT(text, HasSubstr("Turn the nose"));
}

TEST(ProfileTable, PutsTheSkyAtTheTopAndTheLegsBeside) {
  const auto table = profile_table(support::made_up_profile());
  EXPECT_LT(table.find("230-240"), table.find("   10-20"));
  EXPECT_THAT(table, HasSubstr("ascent"));
  const auto row = table.substr(table.find("  150-160"));
  EXPECT_THAT(row.substr(0, row.find('\n')), testing::EndsWith("-   -")) << "the empty bin of the descent";
}

}  // namespace
}  // namespace quadsonde::product
