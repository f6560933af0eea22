#include <gmock/gmock.h>

#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "ingest/paparazzi/paparazzi_reader.h"

namespace quadsonde::ingest {
namespace {

std::vector<std::string> names(std::string_view text) {
  PaparazziLineReader reader(as_bytes(text));
  PaparazziLine line;
  std::vector<std::string> all;
  while (reader.next(line)) all.emplace_back(line.name);
  return all;
}

TEST(PaparazziLineReader, ReadsTimeAircraftNameAndValues) {
  PaparazziLineReader reader(as_bytes("30.5554 186 ATTITUDE -0.09 0.59 0.52\r\n1084 7 X \n"));
  PaparazziLine line;
  ASSERT_TRUE(reader.next(line));
  EXPECT_EQ(line.time.ns, 30'555'400'000);
  EXPECT_EQ(line.aircraft, "186");
  EXPECT_EQ(line.name, "ATTITUDE");
  EXPECT_EQ(line.values, "-0.09 0.59 0.52");
  ASSERT_TRUE(reader.next(line));
  EXPECT_EQ(line.time.ns, 1'084'000'000'000);
  EXPECT_EQ(line.line, 2u);
  EXPECT_FALSE(reader.next(line));
}

TEST(PaparazziLineReader, LeavesOutBlankGroundAndBrokenLines) {
  const std::string_view text = "\n1.0 42 A 1\n1.1 ground PING\n1.2 jsbsim B 2\nx 42 C 3\n  \n1.3 42\n1.4 42 D\n";
  EXPECT_THAT(names(text), ::testing::ElementsAre("A", "D"));
  PaparazziLineReader reader(as_bytes(text));
  PaparazziLine line;
  while (reader.next(line)) {
  }
  EXPECT_EQ(reader.of_the_ground(), 2u);
  EXPECT_EQ(reader.unparsable(), 2u);
  EXPECT_EQ(reader.first_unparsable(), 5u);
}

TEST(PaparazziLineReader, KeepsEveryCompleteLineOfACutFile) {
  std::string text;
  std::vector<std::size_t> ends;
  for (int k = 0; k < 50; ++k) {
    text += std::to_string(k) + ".25 42 ATTITUDE 0.1 0.2 0.3\n";
    ends.push_back(text.size());
  }
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    const auto complete = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), cut) - ends.begin());
    ASSERT_EQ(names(std::string_view(text).substr(0, cut)).size(), complete) << "cut at " << cut;
  }
}

TEST(PaparazziValues, MayBeListsAndQuotedTexts) {
  std::vector<std::string_view> values;
  split_paparazzi_values("1. \"a b  c\" 1500,1002  -3 \"open", values);
  EXPECT_THAT(values, ::testing::ElementsAre("1.", "a b  c", "1500,1002", "-3", "open"));
}

constexpr std::string_view old_log = R"(<configuration time_of_day="1242218293.02" data_file="x.data"><conf>
<aircraft name="OLD" ac_id="61"><x call="a && b < c"/><!-- <message NAME="NOT"> --></aircraft></conf>
<telemetry><process><mode><message name="NEITHER" period="1"/></mode></process></telemetry>
<protocol><class NAME="datalink"><message NAME="BOTH" ID="3"><field NAME="no" TYPE="uint8"/></message></class>
<class NAME="telemetry"><message NAME="BOTH" ID="87"><field NAME="East" TYPE="float" UNIT="m/s"/></message></class>
</protocol></configuration>)";

TEST(PaparazziDefinitions, AreFoundInWhatIsNoXml) {
  const auto definitions = PaparazziDefinitions::scan(as_bytes(old_log));
  EXPECT_EQ(definitions.size(), 1u);
  EXPECT_EQ(definitions.time_of_day()->ns, 1242218293'020'000'000);
  ASSERT_EQ(definitions.aircraft().size(), 1u);
  EXPECT_EQ(definitions.aircraft()[0].id, "61");
  const auto* both = definitions.find("BOTH");
  ASSERT_NE(both, nullptr);
  ASSERT_EQ(both->fields.size(), 1u);
  EXPECT_EQ(both->fields[0].name, "east") << "the telemetry class counts";
  EXPECT_TRUE(both->fields[0].is_float());
}

TEST(PaparazziDefinitions, SurviveEveryCut) {
  for (std::size_t cut = 0; cut <= old_log.size(); ++cut)
    EXPECT_LE(PaparazziDefinitions::scan(as_bytes(old_log.substr(0, cut))).size(), 1u);
}

TEST(PaparazziData, IsRecognisedByItsLines) {
  EXPECT_TRUE(looks_like_paparazzi_data(as_bytes("3.047 185 LINK_REPORT 185 -1 3\n3.053 185 NAVIGATION 0 2\n")));
  EXPECT_FALSE(looks_like_paparazzi_data(as_bytes("time_s,roll_deg\n1.0,2.0\n")));
  EXPECT_FALSE(looks_like_paparazzi_data(as_bytes("1.0 2.0 3.0\n1 2 3\n")));
  EXPECT_FALSE(looks_like_paparazzi_data({}));
}

}  // namespace
}  // namespace quadsonde::ingest
