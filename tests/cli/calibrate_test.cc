// Issue 6, point 7: logs from which no drag can come are refused, each with its reason, what to do, and the exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/cli/program.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::cli {
namespace {

using support::Ended;
using support::quadsonde;
using support::read_text;
using support::TemporaryFolder;
using support::tree;
using support::write_text;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr const char* square = R"(kind = "square"
speed_m_s = 3
side_duration_s = 10
duration_s = 150
yaw_rate_deg_s = 17
)";

struct Maker {
  std::string path = square;
  int seed = 1;
  std::string vehicle = {};  ///< tables before the wind
};

/// A log of our simulator.
void fly(const TemporaryFolder& folder, const std::string& log, const Maker& how = {}) {
  write_text(folder / "s.toml", "seed = " + std::to_string(how.seed) + "\n" + how.vehicle + R"(
[wind]
speed_m_s = 3
toward_deg = 110
turbulence_sd_m_s = 0.5
[[path]]
)" + how.path);
  const auto ended = quadsonde({"simulate", "s.toml", "-o", log}, folder.path());
  ASSERT_EQ(ended.code, 0) << ended.err;
}

/// Without the line breaks that a terminal of 80 columns needs.
std::string unwrapped(const std::string& text) { return std::regex_replace(text, std::regex("\\s+"), " "); }

/// Calibrates and expects a no: this exit code, no file, one error with a next step.
Ended refused(const TemporaryFolder& folder, std::vector<std::string> logs, int code = 1) {
  logs.insert(logs.begin(), "calibrate");
  logs.insert(logs.end(), {"-o", "v.toml"});
  auto ended = quadsonde(logs, folder.path());
  ended.err = unwrapped(ended.err);
  EXPECT_EQ(ended.code, code) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("error: "));
  EXPECT_THAT(ended.err, HasSubstr("-> "));
  EXPECT_THAT(tree(folder.path()), Not(Contains(HasSubstr("v."))));
  return ended;
}

TEST(Calibrate, WritesAFileAndItsPictureFromASquareWithATurningNose) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap");
  fly(folder, "b.mcap", {.seed = 2});
  const auto ended = quadsonde({"calibrate", "a.mcap", "b.mcap", "-o", "v.toml"}, folder.path());
  ASSERT_THAT(ended.code, testing::AnyOf(0, 3)) << ended.err;
  EXPECT_THAT(read_text(folder / "v.toml"), HasSubstr("method = \"free-flight\""));
  const auto picture = read_text(folder / "v_drag.svg");
  EXPECT_THAT(picture, HasSubstr("Drag against airspeed"));
  EXPECT_THAT(picture, HasSubstr("known before: class:generic"));
  EXPECT_THAT(picture, HasSubstr("each flight by itself"));
  EXPECT_THAT(picture, HasSubstr("</svg>"));
}

TEST(Calibrate, RefusesLogsOfTwoVehiclesByTheirNames) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap", {.vehicle = "[vehicle]\nname = \"quad-07\"\n[drag]\nlinear_per_s = 0.257\n"});
  fly(folder, "b.mcap", {.vehicle = "[vehicle]\nname = \"quad-08\"\n[drag]\nlinear_per_s = 0.257\n"});
  EXPECT_THAT(refused(folder, {"a.mcap", "b.mcap"}, 2).err, HasSubstr("quad-08"));
}

TEST(Calibrate, RefusesLogsOfTwoLoadsByTheirMasses) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap", {.vehicle = "[vehicle]\nmass_kg = 0.9\n[drag]\nlinear_per_s = 0.257\n"});
  fly(folder, "b.mcap", {.vehicle = "[vehicle]\nmass_kg = 1.3\n[drag]\nlinear_per_s = 0.214\n"});
  const auto ended = refused(folder, {"a.mcap", "b.mcap"}, 2);
  EXPECT_THAT(ended.err, HasSubstr("1.3 kg"));
  EXPECT_THAT(ended.err, HasSubstr("0.9 kg"));
}

TEST(Calibrate, RefusesUnnamedLogsWhoseDragsDoNotAgree) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap", {.vehicle = "[drag]\nlinear_per_s = 0.257\n"});
  fly(folder, "b.mcap", {.seed = 2, .vehicle = "[drag]\nlinear_per_s = 0.12\n"});
  const auto ended = refused(folder, {"a.mcap", "b.mcap"});
  EXPECT_THAT(ended.err, HasSubstr("do not share one drag"));
  EXPECT_THAT(ended.err, HasSubstr("from its own logs"));
}

TEST(Calibrate, RefusesAHover) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap", {.path = "kind = \"hover\"\nduration_s = 200\nyaw_rate_deg_s = 20\n"});
  const auto ended = refused(folder, {"a.mcap"});
  EXPECT_THAT(ended.err, HasSubstr("below 1.5"));
  EXPECT_THAT(ended.err, HasSubstr("fly a square"));
}

TEST(Calibrate, RefusesTwoMinutesStraightAhead) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap",
      {.path = "kind = \"line\"\nspeed_m_s = 5\nduration_s = 120\ncourse_deg = 40\nheading = \"along\"\n"});
  EXPECT_THAT(refused(folder, {"a.mcap"}).err, HasSubstr("fly a square"));
}

TEST(Calibrate, RefusesALogThatContradictsItself) {
  const TemporaryFolder folder;
  fly(folder, "a.mcap");
  ASSERT_THAT(quadsonde({"convert", "a.mcap", "-o", "a.csv"}, folder.path()).code, testing::AnyOf(0, 3));
  auto text = read_text(folder / "a.csv");
  const auto north = text.find("vn_m_s"), east = text.find("ve_m_s");
  ASSERT_LT(north, text.find('\n'));
  ASSERT_LT(east, text.find('\n'));
  text.replace(north, 6, "ve_m_s").replace(east, 6, "vn_m_s");
  write_text(folder / "exchanged.csv", text);
  const auto ended = refused(folder, {"exchanged.csv"});
  EXPECT_THAT(ended.err, HasSubstr("contradicts itself"));
  EXPECT_THAT(ended.err, HasSubstr("quadsonde check"));
}

// CLI.md: the drag is scaled to the mass flown, and the answer says so; 0.5 of the exponent at 1.44 times the mass.
TEST(Vehicle, IsScaledToTheMassFlownAndTheAnswerSaysSo) {
  const TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  auto vehicle = ingest::published_vehicle();
  vehicle.name = "five-inch test quad", vehicle.method = "tunnel", vehicle.mass_kg = 1;
  write_text(folder / "vehicle.toml", ingest::to_toml(vehicle));
  const auto plain = quadsonde({"profile", "a.csv"}, folder.path());
  const auto told = quadsonde({"profile", "a.csv", "--mass-kg", "1.44"}, folder.path());
  EXPECT_THAT(unwrapped(told.out), HasSubstr("scaled from 1 to 1.44 kg"));
  EXPECT_THAT(unwrapped(plain.out), Not(HasSubstr("scaled from")));
  EXPECT_THAT(unwrapped(quadsonde({"profile", "a.csv", "--mass-kg", "3"}, folder.path()).err),
              HasSubstr("3 times the mass"));
}

TEST(Vehicle, IsThatOfAClassWhereOnlyItsMassIsKnownAndTheAnswerSaysSo) {
  const TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  const auto ended = quadsonde({"profile", "a.csv", "--mass-kg", "4"}, folder.path());
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(unwrapped(ended.err), HasSubstr("class medium"));
  EXPECT_THAT(unwrapped(ended.out), HasSubstr("class prior, not calibrated"));
  EXPECT_THAT(unwrapped(ended.out), HasSubstr("45 %"));
  const auto named = quadsonde({"profile", "a.csv", "--vehicle", "class:nano"}, folder.path());
  EXPECT_THAT(named.out, HasSubstr("class:nano"));
  const auto wrong = quadsonde({"profile", "a.csv", "--vehicle", "class:balloon"}, folder.path());
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("camera"));
}

}  // namespace
}  // namespace quadsonde::cli
