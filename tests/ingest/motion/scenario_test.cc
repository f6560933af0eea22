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
turbulence = "dryden"
turbulence_exponent = 0.2
wind_at_6m_m_s = 4
[wind.jet]
ground_speed_m_s = 1
gain_m_s = 2
gain_height_m = 100
excess_m_s = 3
height_m = 150
width_m = 40
toward_deg = 60
turn_deg = 30
turn_height_m = 200
[[wind.level]]
height_m = 0
speed_m_s = 2
from_deg = 270
[[wind.level]]
height_m = 100
speed_m_s = 6
toward_deg = 90
[[wind.level]]
time_s = 600
height_m = 0
speed_m_s = 1
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
velocity_rate_hz = 10
position_rate_hz = 2
barometer_rate_hz = 10
accelerometer_rate_hz = 25
rotor_rate_hz = 5
landed_state = true
tilt_wander_deg = 0.2
tilt_wander_s = 3
heading_wander_deg = 1
heading_wander_s = 20
velocity_wander_m_s = 0.05
velocity_wander_s = 5
velocity_bias_m_s = [0.1, 0, 0]
height_wander_m = 1
height_wander_s = 50
barometer_sd_m = 0.2
barometer_drift_m_per_hour = 2
barometer_walk_m_per_root_hour = 1
accelerometer_sd_m_s2 = 0.1
accelerometer_bias_m_s2 = [0, 0.1, 0]
gyro_sd_deg_s = 0.1
receiver_dropouts_per_hour = 10
receiver_dropout_s = 1
log_dropouts_per_hour = 5
log_dropout_s = 0.5
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
  ASSERT_EQ(s->wind.levels.size(), 3u);
  EXPECT_EQ(s->wind.levels[2].time, 600);
  EXPECT_EQ(s->wind.turbulence, WindField::Turbulence::dryden);
  EXPECT_EQ(s->wind.wind_at_6m, 4);
  EXPECT_EQ(s->wind.jet.turn_scale, 200);
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
  EXPECT_EQ(s->sensors.velocity_bias, Eigen::Vector3d(0.1, 0, 0));
  EXPECT_EQ(s->sensors.log.per_hour, 5);
  EXPECT_EQ(s->sensors.barometer_walk, 1);
  EXPECT_EQ(s->model, Scenario::Model::point_mass) << "as ever, unless told";
  EXPECT_TRUE(simulate(*s));
}

TEST(ScenarioFile, DescribesARigidBody) {
  const auto s = parse_scenario(R"(
[simulator]
model = "rigid_body"
[rigid_body]
name = "six arms"
mass_kg = 2.1
inertia_kg_m2 = [0.02, 0.02, 0.035]
rotors = 6
arm_m = 0.25
rotor_height_m = 0.03
rotor_diameter_m = 0.20
blades = 2
chord_m = 0.02
pitch_deg = 15
twist_deg = -12
lift_slope_per_rad = 5.5
profile_drag = 0.02
induced_factor = 1.2
flapping_share = 0.4
rotor_inertia_kg_m2 = 2e-5
motor_lag_s = 0.05
min_rotor_rpm = 1500
max_rotor_rpm = 15000
body_area_m2 = [0.03, 0.03, 0.06]
wash_area_m2 = 0.006
[[path]]
kind = "hover"
duration_s = 5
)",
                                "rigid.toml");
  ASSERT_TRUE(s) << to_string(s.error());
  EXPECT_EQ(s->model, Scenario::Model::rigid_body);
  EXPECT_EQ(s->rigid.rotors, 6);
  EXPECT_NEAR(s->rigid.rotor.pitch, 0.2618, 1e-4);
  EXPECT_NEAR(s->rigid.most_speed, 1570.8, 0.1);
  EXPECT_EQ(s->rigid.body_area, Eigen::Vector3d(0.03, 0.03, 0.06));
  const auto flown = simulate(*s);
  ASSERT_TRUE(flown) << to_string(flown.error());
  EXPECT_EQ(flown->vehicle.name, "six arms");
  EXPECT_EQ(flown->flight.vehicle.rotors, 6);
  EXPECT_EQ(flown->flight.vehicle.mass_kg, 2.1);
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
      {"unknown simulator", "[simulator]\nmodel = \"blob\"\n", 0, "simulator.model", "point_mass, rigid_body"},
      {"a drag for a rigid body", "[simulator]\nmodel = \"rigid_body\"\n[drag]\nlinear_per_s = 0.2\n", 0, "drag",
       "no meaning for a rigid body"},
      {"a rigid body for the point mass", "[rigid_body]\nmass_kg = 1\n", 0, "rigid_body", "model = \"rigid_body\""},
      {"odd rotors", "[simulator]\nmodel = \"rigid_body\"\n[rigid_body]\nrotors = 5\n", 0, "rigid_body.rotors",
       "4, 6 or 8"},
      {"profiles out of order", "[wind]\nmodel = \"table\"\n[[wind.level]]\ntime_s = 9\n[[wind.level]]\ntime_s = 5\n",
       0, "wind.level[1].time_s", "follow each other"},
      {"bias of two axes", "[sensors]\nvelocity_bias_m_s = [1, 2]\n", 2, "sensors.velocity_bias_m_s", "3 numbers"},
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

/// The same flight, cut short: every leg, but none for more than 15 s or 15 m.
Scenario shortened(Scenario s) {
  for (auto& leg : s.path) {
    leg.duration = std::min(leg.duration, 15.0);
    leg.pause = std::min(leg.pause, 2.0);
    if (leg.kind == PathLeg::Kind::climb)
      leg.to_height = std::clamp(leg.to_height, s.start_height, s.start_height + 15);
  }
  return s;
}

TEST(ExampleScenarios, AllParseAndFlyTheSameTwice) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(QUADSONDE_SCENARIOS)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const auto s = read_scenario(entry.path());
    ASSERT_TRUE(s) << to_string(s.error());
    const auto flown = simulate(shortened(*s)), again = simulate(shortened(*s));
    ASSERT_TRUE(flown) << entry.path() << to_string(flown.error());
    EXPECT_GT(flown->flight.velocity.size(), 50u) << entry.path();
    EXPECT_EQ(flown->flight.velocity.value, again->flight.velocity.value) << entry.path();
    // Truth stands beside every velocity that was logged.
    std::set<LogTime> known;
    for (const auto& row : flown->truth) known.insert(row.time);
    for (const auto t : flown->flight.velocity.time) ASSERT_TRUE(known.count(t)) << entry.path();
    for (const auto& v : flown->flight.velocity.value) ASSERT_TRUE(v.allFinite() && v.norm() < 10) << entry.path();
  }
  EXPECT_GE(count, 40);
}

TEST(ExampleScenarios, HaveAFlightForEveryGateAndManoeuvre) {
  const std::filesystem::path folder = QUADSONDE_SCENARIOS;
  for (const auto* name : {"s1_step_calm",      "s1_step_gusty",  "s2_hover",    "s3_ascent_1",   "s3_ascent_5",
                           "s4_square",         "s4_square_late", "s5_drawn_1",  "s5_drawn_3",    "s5_drawn_1_pauses",
                           "s5_drawn_3_pauses", "s5_far_1",       "s5_far_3",    "fixed_heading", "consider_hover",
                           "consider_square",   "fast",           "trim",        "shooting",      "hover_calibration",
                           "hover_free",        "hover_fixed",    "circle_free", "circle_along",  "circle_fixed",
                           "line_free",         "line_along",     "line_fixed",  "square_free",   "square_along",
                           "square_fixed"})
    EXPECT_TRUE(std::filesystem::exists(folder / (std::string(name) + ".toml"))) << name;
}

}  // namespace
}  // namespace quadsonde::ingest
