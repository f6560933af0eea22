#include "export/station/station.h"

#include "tests/support/data.h"

namespace quadsonde {
namespace {

using product::choose_station;
using product::parse_station;
using product::parse_wigos_id;

constexpr const char* whole = R"(
[station]
wigos_id = "0-454-2-AWSNAMITAMBO"
name = "Namitambo"
[uasdc]
operator_id = "007"
airframe_id = "QS001"
[platform]
name = "quad-07"
type = "quadrotor"
[contact]
name = "A \"B\" <c>"
email = "person@example.org"
url = "https://example.org"
[publisher]
name = "A Service"
[data]
institution = "Example Institute"
license = "CC-BY-4.0"
)";

void write(const std::filesystem::path& path, const std::string& text) {
  support::write_bytes(path, {text.begin(), text.end()});
}

TEST(Station, EveryKeyIsRead) {
  const auto s = parse_station(whole, "/somewhere/station.toml");
  ASSERT_TRUE(s) << ingest::to_string(s.error());
  EXPECT_EQ(s->wigos_id, "0-454-2-AWSNAMITAMBO");
  EXPECT_EQ(s->site(), "0-454-2-AWSNAMITAMBO");
  EXPECT_EQ(s->operator_id, "007");
  EXPECT_EQ(s->airframe_id, "QS001");
  EXPECT_EQ(s->platform_name, "quad-07");
  EXPECT_EQ(s->contact_name, "A \"B\" <c>");
  EXPECT_EQ(s->publisher_name, "A Service");
  EXPECT_EQ(s->publisher_email, "");
  EXPECT_EQ(s->license, "CC-BY-4.0");
  EXPECT_EQ(s->file, "station.toml") << "no folder of the machine";
}

TEST(Station, EveryKeyMayBeLeftOut) {
  const auto s = parse_station("", "station.toml");
  ASSERT_TRUE(s);
  EXPECT_EQ(s->site(), "");
  EXPECT_EQ(parse_station("[station]\nname = \"Here\"\n", "s.toml")->site(), "Here");
}

TEST(Station, WhatIsNoKeyOrNoIdentifierIsRefusedWithItsLine) {
  const struct {
    const char *toml, *topic;
    std::uint64_t line;
  } wrong[] = {
      {"[station]\nwigosid = \"0-1-1-A\"", "station.wigosid", 2},
      {"[statoin]\nname = \"x\"", "statoin", 1},
      {"[station]\nwigos_id = \"15015\"", "station.wigos_id", 2},
      {"[station]\nwigos_id = 15015", "station.wigos_id", 2},
      {"[station]\nwigos_id = \"0-20000-0-TOOLONGALTOGETHER\"", "station.wigos_id", 2},
      {"[uasdc]\noperator_id = \"7\"", "uasdc.operator_id", 2},
      {"[uasdc]\noperator_id = 7", "uasdc.operator_id", 2},
      {"[uasdc]\n\nairframe_id = \"QS-01\"", "uasdc.airframe_id", 3},
      {"[uasdc]\nairframe_id = \"QS0001\"", "uasdc.airframe_id", 2},
      {"[contact]\nphone = \"1\"", "contact.phone", 2},
  };
  for (const auto& w : wrong) {
    const auto s = parse_station(w.toml, "station.toml");
    ASSERT_FALSE(s) << w.toml;
    EXPECT_EQ(s.error().kind, ingest::Kind::usage);
    EXPECT_EQ(s.error().where.topic, w.topic);
    EXPECT_EQ(s.error().where.line, w.line) << w.toml;
  }
  EXPECT_FALSE(parse_station("[station\n", "station.toml"));
}

TEST(Station, AutoTakesTheFileBesideTheLogOnlyIfThereIsOne) {
  const support::TemporaryFolder folder;
  EXPECT_EQ(choose_station("auto", folder / "log.ulg")->file, "");
  write(folder / "station.toml", whole);
  EXPECT_EQ(choose_station("auto", folder / "log.ulg")->operator_id, "007");
  write(folder / "station.toml", "[oops");
  EXPECT_FALSE(choose_station("auto", folder / "log.ulg")) << "a broken file is not passed over";
}

TEST(Station, AFileThatIsNotThereOrIsAFolderIsSaid) {
  const support::TemporaryFolder folder;
  for (const auto& path : {folder / "none.toml", folder.path()}) {
    const auto s = choose_station(path.string(), "log.ulg");
    ASSERT_FALSE(s);
    EXPECT_EQ(s.error().kind, ingest::Kind::unreadable);
    EXPECT_EQ(s.error().where.file, path.string());
  }
}

TEST(WigosId, HasFourPartsInTheRangesOfBufr) {
  const auto id = parse_wigos_id("0-20000-0-15015");
  ASSERT_TRUE(id);
  EXPECT_EQ(id->series, 0);
  EXPECT_EQ(id->issuer, 20000);
  EXPECT_EQ(id->number, 0);
  EXPECT_EQ(id->local, "15015");
  EXPECT_TRUE(parse_wigos_id("14-65534-65534-ABCDEFGHIJKLMNOP"));
  for (const char* none : {"", "0-20000-0", "0-20000-0-", "15-1-1-A", "0-65535-0-A", "0-1-70000-A", "-1-1-1-A",
                           "0-1-1-A B", "0-1-1-A-B", "0-1-1-ABCDEFGHIJKLMNOPQ", "0-1-1-\xc3\xa9", "a-1-1-A"})
    EXPECT_FALSE(parse_wigos_id(none)) << none;
}

}  // namespace
}  // namespace quadsonde
