#include "ingest/motion/scenario.h"

#include <fstream>
#include <set>

#include "ingest/motion/vehicle.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

const char whole_scenario[] = R"(
name = "all there is"
seed = 42
start_height_m = 12
from_ground = true

[vehicle]
id = "quad-07"
mass_kg = 1.5
[drag]
linear_per_s = 0.3
quadratic_per_m = 0.01
climb_linear_s_per_m = 0.0
climb_quadratic_s2_per_m2 = 0.0

[site]
lat_deg = -17.5
lon_deg = 178
height_msl_m = 20
start_utc = "2026-06-01T05:30:00Z"

[wind]
model = "table"
veer_deg_per_m = 0.1
turbulence_sd_m_s = 0.3
turbulence_time_s = 8
vertical_sd_m_s = 0.1
vertical_time_s = 4
[[wind.level]]
height_m = 0
speed_m_s = 2
from_deg = 270
[[wind.level]]
height_m = 100
speed_m_s = 6
toward_deg = 90
[[wind.step]]
time_s = 30
speed_m_s = 5
toward_deg = 0

[[path]]
kind = "hover"
duration_s = 5
yaw_rate_deg_s = 20
heading_deg = 45
[[path]]
kind = "square"
duration_s = 40
speed_m_s = 3
side_duration_s = 5
course_deg = 30
heading = "along"
[[path]]
kind = "line"
duration_s = 20
speed_m_s = 4
back_and_forth = true
side_duration_s = 5
[[path]]
kind = "circle"
duration_s = 20
speed_m_s = 3
radius_m = 15
[[path]]
kind = "climb"
speed_m_s = 2
to_height_m = 40
pause_every_m = 10
pause_s = 4

[sensors]
rate_hz = 5
attitude_rate_hz = 50
tilt_sd_deg = 0.4
tilt_correlation_s = 0.5
heading_error_deg = 1
trim_roll_deg = 1
trim_pitch_deg = -1
velocity_sd_m_s = 0.05
height_sd_m = 0.2
position_sd_m = 0.4
latency_s = 0.1
controller_flies_on_measured = true
)";

TEST(ScenarioFile, EveryKeyOfTheManualIsRead) {
  const auto s = parse_scenario(whole_scenario, "all.toml");
  ASSERT_TRUE(s) << to_string(s.error());
  EXPECT_EQ(s->name, "all there is");
  EXPECT_EQ(s->seed, 42u);
  EXPECT_TRUE(s->from_ground);
  EXPECT_EQ(s->vehicle.drag.linear, 0.3);
  EXPECT_EQ(s->vehicle.mass_kg, 1.5);
  EXPECT_EQ(s->site.point.lat_deg, -17.5);
  EXPECT_EQ(to_iso8601(s->site.start, 0), "2026-06-01T05:30:00Z");
  EXPECT_EQ(s->wind.sigma_u, 0.3);
  ASSERT_EQ(s->wind.levels.size(), 2u);
  EXPECT_LT((s->wind.levels[0].toward - Eigen::Vector2d(0, 2)).norm(), 1e-12) << "from the west is toward the east";
  EXPECT_LT((s->wind.levels[1].toward - Eigen::Vector2d(0, 6)).norm(), 1e-12);
  ASSERT_EQ(s->wind.steps.size(), 1u);
  ASSERT_EQ(s->path.size(), 5u);
  EXPECT_EQ(s->path[0].heading.kind, HeadingRule::Kind::turning);
  EXPECT_EQ(s->path[0].heading.degrees, 45);
  EXPECT_EQ(s->path[1].heading.kind, HeadingRule::Kind::along_track);
  EXPECT_TRUE(s->path[2].back_and_forth);
  EXPECT_EQ(s->path[4].pause_every, 10);
  EXPECT_EQ(s->sensors.latency, 0.1);
  EXPECT_TRUE(s->sensors.controller_flies_on_measured);
  EXPECT_TRUE(simulate(*s));
}

TEST(ScenarioFile, WithoutAVehicleFliesThePublishedOne) {
  const auto s = parse_scenario("[[path]]\nkind = \"hover\"\nduration_s = 5\n", "short.toml");
  ASSERT_TRUE(s) << to_string(s.error());
  EXPECT_EQ(s->vehicle.id, published_vehicle().id);
  EXPECT_EQ(s->name, "short") << "named after its file";
}

TEST(ScenarioFile, MayNameAVehicleFileBesideIt) {
  const support::TemporaryFolder folder;
  std::ofstream(folder / "v.toml") << to_toml(class_prior());
  std::ofstream(folder / "s.toml") << "vehicle = \"v.toml\"\n[[path]]\nkind = \"hover\"\nduration_s = 5\n";
  const auto s = read_scenario(folder / "s.toml");
  ASSERT_TRUE(s) << to_string(s.error());
  EXPECT_EQ(s->vehicle.id, "class:generic");
  std::ofstream(folder / "t.toml") << "vehicle = \"none.toml\"\n[[path]]\nkind = \"hover\"\nduration_s = 5\n";
  const auto t = read_scenario(folder / "t.toml");
  ASSERT_FALSE(t);
  EXPECT_NE(t.error().where.file.find("none.toml"), std::string::npos);
  EXPECT_FALSE(read_scenario(folder / "nothing.toml"));
}

TEST(ScenarioFile, EachFaultIsOneProblemWithItsLine) {
  struct Bad {
    const char *why, *text;
    std::uint64_t line;
    const char *topic, *words;
  };
  const std::string hover = "[[path]]\nkind = \"hover\"\nduration_s = 5\n";
  const Bad bad[] = {
      {"no TOML", "seed = \n", 1, "", ""},
      {"unknown key", "sed = 3\n", 1, "sed", "not a key"},
      {"unknown wind key", "[wind]\nmodle = \"jet\"\n", 2, "wind.modle", "not a key"},
      {"unknown model", "[wind]\nmodel = \"storm\"\n", 0, "wind.model", "expected one of constant, power_law"},
      {"speed out of range", "[wind]\nspeed_m_s = 400\n", 2, "wind.speed_m_s", "expected a number from 0 to 100"},
      {"table without levels", "[wind]\nmodel = \"table\"\n", 0, "wind.level", "[[wind.level]]"},
      {"levels that fall", "[wind]\nmodel = \"table\"\n[[wind.level]]\nheight_m = 9\n[[wind.level]]\nheight_m = 5\n", 0,
       "wind.level[1].height_m", "must rise"},
      {"bad switch", "from_ground = \"yes\"\n", 1, "from_ground", "true or false"},
      {"bad start", "[site]\nstart_utc = \"soon\"\n", 0, "site.start_utc", "expected a time"},
      {"bad vehicle key, in its own line", "\n\n[vehicle]\nid = \"x\"\n[drag]\nlinear_per_s = 0.2\nliner = 1\n", 7,
       "drag.liner", "not a key"},
      {"bad sensor", "[sensors]\nlatency_s = -1\n", 2, "sensors.latency_s", "expected a number"},
      {"bad seed", "seed = -1\n", 1, "seed", "expected a number"},
      {"leg without a kind", "[[path]]\nduration_s = 5\n", 0, "path[0].kind", "is missing"},
      {"leg of no duration", "[[path]]\nkind = \"hover\"\n", 0, "path[0].duration_s", "needs a duration"},
      {"climb of no speed", "[[path]]\nkind = \"climb\"\nto_height_m = 5\n", 0, "path[0].speed_m_s", "needs a speed"},
      {"unknown kind", "[[path]]\nkind = \"loop\"\nduration_s = 3\n", 0, "path[0].kind", "expected one of hover"},
      {"heading misspelt", "[[path]]\nkind = \"hover\"\nduration_s = 3\nheading = \"allong\"\n", 0, "path[0].heading",
       "yaw_rate_deg_s"},
      {"switch misspelt", "[[path]]\nkind = \"hover\"\nduration_s = 3\nback_and_forth = 1\n", 4,
       "path[0].back_and_forth", "true or false"},
  };
  for (const auto& file : bad) {
    std::string text = file.text;
    if (text.find("[[path]]") == std::string::npos) text += hover;
    const auto s = parse_scenario(text, "bad.toml");
    ASSERT_FALSE(s) << file.why;
    const Problem& p = s.error();
    EXPECT_EQ(p.kind, Kind::usage) << file.why;
    EXPECT_EQ(p.where.file, "bad.toml") << file.why;
    EXPECT_EQ(p.where.topic, file.topic) << file.why;
    EXPECT_NE(p.what.find(file.words), std::string::npos) << file.why << ": " << p.what;
    if (file.line > 0) {
      ASSERT_TRUE(p.where.line) << file.why;
      EXPECT_EQ(*p.where.line, file.line) << file.why;
    }
  }
}

TEST(ScenarioFile, ThatFliesNothingIsRefused) {
  const auto s = parse_scenario("seed = 1\n", "empty.toml");
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().where.topic, "path");
}

TEST(ExampleScenarios, AllParseAndFly) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(QUADSONDE_SCENARIOS)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const auto s = read_scenario(entry.path());
    ASSERT_TRUE(s) << to_string(s.error());
    const auto flown = simulate(*s);
    ASSERT_TRUE(flown) << entry.path() << to_string(flown.error());
    EXPECT_GT(flown->flight.velocity.size(), 50u) << entry.path();
    EXPECT_EQ(flown->truth.size(), flown->flight.velocity.size());
    for (const auto& v : flown->flight.velocity.value) ASSERT_TRUE(v.allFinite()) << entry.path();
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace quadsonde::ingest
