#include "ingest/motion/scenario.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "ingest/motion/toml_fields.h"
#include "ingest/motion/vehicle_tables.h"

namespace quadsonde::ingest {
namespace {

Eigen::Vector2d toward(double speed, double toward_deg) {
  const double a = toward_deg * std::numbers::pi / 180;
  return {speed * std::cos(a), speed * std::sin(a)};
}

template <class Value>
void choose(TomlFields& fields, std::string_view key, std::initializer_list<std::pair<std::string_view, Value>> choices,
            Value& into) {
  const auto text = fields.text(key);
  if (!text) return;
  std::string names;
  for (const auto& [name, value] : choices) {
    if (*text == name) {
      into = value;
      return;
    }
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  fields.complain(key, "expected one of " + names);
}

/// speed_m_s with from_deg (where it comes from) or toward_deg (where it blows).
Eigen::Vector2d read_vector(TomlFields& fields) {
  const double speed = fields.number("speed_m_s", 0, 100).value_or(0);
  if (const auto from = fields.number("from_deg", -360, 360)) return toward(speed, *from + 180);
  return toward(speed, fields.number("toward_deg", -360, 360).value_or(0));
}

void read_jet(TomlFields f, WindField::Jet& jet) {
  f.set("ground_speed_m_s", jet.ground, 0, 100);
  f.set("gain_m_s", jet.gain, -100, 100);
  f.set("gain_height_m", jet.scale, 1, 10000);
  f.set("excess_m_s", jet.excess, -100, 100);
  f.set("height_m", jet.height, 0, 10000);
  f.set("width_m", jet.width, 1, 10000);
  f.set("toward_deg", jet.toward_deg, -360, 360);
  f.set("turn_deg", jet.turn_deg, -360, 360);
  f.set("turn_height_m", jet.turn_scale, 1, 10000);
  f.leftover();
}

void read_wind(TomlFields f, WindField& wind) {
  using Model = WindField::Model;
  choose<Model>(f, "model",
                {{"constant", Model::constant},
                 {"power_law", Model::power_law},
                 {"log_law", Model::log_law},
                 {"jet", Model::jet},
                 {"table", Model::table}},
                wind.model);
  wind.toward = read_vector(f);
  f.set("reference_height_m", wind.reference_height, 0.1, 1000);
  f.set("power_exponent", wind.power_exponent, -1, 2);
  f.set("roughness_m", wind.roughness, 1e-6, 5);
  f.set("veer_deg_per_m", wind.veer_deg_per_m, -10, 10);
  f.set("turbulence_sd_m_s", wind.sigma_u, 0, 10);
  f.set("turbulence_time_s", wind.time_u, 0.01, 1000);
  f.set("vertical_sd_m_s", wind.sigma_w, 0, 10);
  f.set("vertical_time_s", wind.time_w, 0.01, 1000);
  using Turbulence = WindField::Turbulence;
  choose<Turbulence>(f, "turbulence", {{"ou", Turbulence::ornstein_uhlenbeck}, {"dryden", Turbulence::dryden}},
                     wind.turbulence);
  f.set("turbulence_exponent", wind.sigma_exponent, -2, 2);
  wind.wind_at_6m = f.number("wind_at_6m_m_s", 0, 100);
  read_jet(f.table("jet"), wind.jet);
  for (auto& level : f.tables("level")) {
    WindField::Level l;
    level.set("height_m", l.height, -100, 20000);
    level.set("time_s", l.time, 0, 86400);
    l.toward = read_vector(level);
    level.leftover();
    if (!wind.levels.empty() && l.time < wind.levels.back().time)
      level.complain("time_s", "profiles must follow each other in time");
    if (!wind.levels.empty() && l.time == wind.levels.back().time && l.height <= wind.levels.back().height)
      level.complain("height_m", "levels must rise from the first to the last");
    wind.levels.push_back(l);
  }
  for (auto& at : f.tables("step")) {
    WindField::Step s;
    at.set("time_s", s.time, 0, 86400);
    s.toward = read_vector(at);
    at.leftover();
    if (!wind.steps.empty() && s.time <= wind.steps.back().time)
      at.complain("time_s", "steps must follow each other in time");
    wind.steps.push_back(s);
  }
  if (wind.model == Model::table && wind.levels.empty()) f.complain("level", "a table needs [[wind.level]] entries");
  f.leftover();
}

HeadingRule read_heading(TomlFields& f) {
  HeadingRule rule;
  if (const auto rate = f.number("yaw_rate_deg_s", -360, 360)) {
    rule.kind = HeadingRule::Kind::turning;
    rule.rate_deg_s = *rate;
  }
  f.set("heading_deg", rule.degrees, -360, 360);
  if (const auto word = f.text("heading")) {
    if (*word == "along")
      rule.kind = HeadingRule::Kind::along_track;
    else if (*word != "fixed")
      f.complain("heading", "expected \"fixed\" or \"along\"; a turning nose is told by yaw_rate_deg_s");
  }
  return rule;
}

PathLeg read_leg(TomlFields& f) {
  using Kind = PathLeg::Kind;
  PathLeg leg;
  if (!f.has("kind")) f.complain("kind", "is missing: hover, climb, line, square or circle");
  choose<Kind>(f, "kind",
               {{"hover", Kind::hover},
                {"climb", Kind::climb},
                {"line", Kind::line},
                {"square", Kind::square},
                {"circle", Kind::circle}},
               leg.kind);
  f.set("duration_s", leg.duration, 0, 86400);
  f.set("speed_m_s", leg.speed, 0, 50);
  f.set("to_height_m", leg.to_height, 0, 20000);
  f.set("course_deg", leg.course_deg, -360, 360);
  f.set("side_duration_s", leg.side_duration, 0.1, 3600);
  f.set("radius_m", leg.radius, 0.5, 10000);
  f.set("pause_every_m", leg.pause_every, 0, 10000);
  f.set("pause_s", leg.pause, 0, 3600);
  f.set("back_and_forth", leg.back_and_forth);
  leg.heading = read_heading(f);
  const bool climbs = leg.kind == Kind::climb;
  if (climbs && leg.speed < 0.01) f.complain("speed_m_s", "a climb needs a speed of at least 0.01 m/s");
  if (!climbs && leg.duration <= 0) f.complain("duration_s", "the leg needs a duration above 0 s");
  f.leftover();
  return leg;
}

void read_triple(TomlFields& f, std::string_view key, Eigen::Vector3d& into) {
  if (const auto values = f.numbers(key, 3)) into = {(*values)[0], (*values)[1], (*values)[2]};
}

void read_rates(TomlFields& f, SensorModel& s) {
  f.set("rate_hz", s.output_rate, 0.1, 100);
  f.set("attitude_rate_hz", s.attitude_rate, 0.1, 100);
  f.set("velocity_rate_hz", s.velocity_rate, 0.1, 100);
  f.set("position_rate_hz", s.position_rate, 0.1, 100);
  f.set("barometer_rate_hz", s.barometer_rate, 0.1, 100);
  f.set("accelerometer_rate_hz", s.accelerometer_rate, 0.1, 100);
  f.set("rotor_rate_hz", s.rotor_rate, 0.1, 100);
  f.set("landed_state", s.landed_state);
  f.set("receiver_dropouts_per_hour", s.receiver.per_hour, 0, 3600);
  f.set("receiver_dropout_s", s.receiver.mean_length, 0.01, 3600);
  f.set("log_dropouts_per_hour", s.log.per_hour, 0, 3600);
  f.set("log_dropout_s", s.log.mean_length, 0.01, 3600);
}

void read_attitude_errors(TomlFields& f, SensorModel& s) {
  f.set("tilt_sd_deg", s.tilt_sd_deg, 0, 20);
  f.set("tilt_correlation_s", s.tilt_correlation, 0, 100);
  f.set("tilt_wander_deg", s.tilt_wander_deg, 0, 20);
  f.set("tilt_wander_s", s.tilt_wander_time, 0.01, 3600);
  f.set("heading_error_deg", s.heading_error_deg, -180, 180);
  f.set("heading_wander_deg", s.heading_wander_deg, 0, 90);
  f.set("heading_wander_s", s.heading_wander_time, 0.01, 3600);
  f.set("trim_roll_deg", s.trim_roll_deg, -30, 30);
  f.set("trim_pitch_deg", s.trim_pitch_deg, -30, 30);
}

void read_sensors(TomlFields f, SensorModel& s) {
  read_rates(f, s);
  read_attitude_errors(f, s);
  f.set("velocity_sd_m_s", s.velocity_sd, 0, 10);
  f.set("velocity_wander_m_s", s.velocity_wander, 0, 10);
  f.set("velocity_wander_s", s.velocity_wander_time, 0.01, 3600);
  read_triple(f, "velocity_bias_m_s", s.velocity_bias);
  f.set("latency_s", s.latency, 0, 5);
  f.set("position_sd_m", s.position_sd, 0, 50);
  f.set("height_sd_m", s.height_sd, 0, 50);
  f.set("height_wander_m", s.height_wander, 0, 100);
  f.set("height_wander_s", s.height_wander_time, 0.01, 36000);
  f.set("barometer_sd_m", s.barometer_sd, 0, 50);
  f.set("barometer_drift_m_per_hour", s.barometer_drift_per_hour, -1000, 1000);
  f.set("barometer_walk_m_per_root_hour", s.barometer_walk, 0, 1000);
  f.set("accelerometer_sd_m_s2", s.accelerometer_sd, 0, 50);
  read_triple(f, "accelerometer_bias_m_s2", s.accelerometer_bias);
  f.set("gyro_sd_deg_s", s.gyro_sd_deg_s, 0, 100);
  f.set("controller_flies_on_measured", s.controller_flies_on_measured);
  f.leftover();
}

void read_rotor(TomlFields& f, RotorModel& r) {
  constexpr double degree = std::numbers::pi / 180;
  f.set("rotor_diameter_m", r.diameter, 0.02, 5);
  if (const auto blades = f.number("blades", 1, 16)) r.blades = static_cast<int>(*blades);
  f.set("chord_m", r.chord, 1e-3, 1);
  if (const auto pitch = f.number("pitch_deg", 1, 45)) r.pitch = *pitch * degree;
  if (const auto twist = f.number("twist_deg", -60, 60)) r.twist = *twist * degree;
  f.set("lift_slope_per_rad", r.lift_slope, 1, 7);
  f.set("profile_drag", r.profile_drag, 0, 0.5);
  f.set("induced_factor", r.induced_factor, 1, 2);
  f.set("flapping_share", r.flapping_share, 0, 1);
  f.set("rotor_inertia_kg_m2", r.inertia, 0, 1);
}

void read_rigid_body(TomlFields f, RigidVehicle& v) {
  constexpr double rpm = std::numbers::pi / 30;
  f.set("name", v.name);
  f.set("mass_kg", v.mass, 0.02, 200);
  read_triple(f, "inertia_kg_m2", v.inertia);
  if ((v.inertia.array() <= 0).any()) f.complain("inertia_kg_m2", "expected three numbers above 0");
  if (const auto n = f.number("rotors", 4, most_rotors)) v.rotors = static_cast<int>(*n);
  if (v.rotors % 2 != 0) f.complain("rotors", "expected 4, 6 or 8: as many turn one way as the other");
  f.set("arm_m", v.arm, 0.02, 5);
  f.set("rotor_height_m", v.rotor_height, -2, 2);
  read_rotor(f, v.rotor);
  f.set("motor_lag_s", v.motor_lag, 0.005, 1);
  if (const auto low = f.number("min_rotor_rpm", 1, 1e5)) v.least_speed = *low * rpm;
  if (const auto high = f.number("max_rotor_rpm", 1, 1e5)) v.most_speed = *high * rpm;
  if (v.least_speed >= v.most_speed) f.complain("max_rotor_rpm", "must be above min_rotor_rpm");
  read_triple(f, "body_area_m2", v.body_area);
  if ((v.body_area.array() < 0).any()) f.complain("body_area_m2", "expected three numbers from 0 upward");
  f.set("wash_area_m2", v.wash_area, 0, 10);
  f.leftover();
}

void read_simulator(TomlFields& root, Scenario& scenario) {
  using Model = Scenario::Model;
  auto f = root.table("simulator");
  choose<Model>(f, "model", {{"point_mass", Model::point_mass}, {"rigid_body", Model::rigid_body}}, scenario.model);
  f.leftover();
  const bool rigid = scenario.model == Model::rigid_body;
  if (root.has("rigid_body") && !rigid)
    root.complain("rigid_body", "is flown by [simulator] model = \"rigid_body\" only");
  read_rigid_body(root.table("rigid_body"), scenario.rigid);
  if (!rigid) return;
  for (const auto key : {"vehicle", "drag", "noise", "provenance"})
    if (root.has(key)) root.complain(key, "has no meaning for a rigid body, whose drag follows from [rigid_body]");
}

void read_site(TomlFields f, Site& site) {
  f.set("lat_deg", site.point.lat_deg, -90, 90);
  f.set("lon_deg", site.point.lon_deg, -180, 360);
  f.set("height_msl_m", site.height.m, -500, 9000);
  if (const auto start = f.text("start_utc")) {
    if (const auto utc = parse_iso8601(*start))
      site.start = *utc;
    else
      f.complain("start_utc", "expected a time such as 2026-06-01T06:00:00Z");
  }
  f.leftover();
}

/// [vehicle] with [drag] and so on as in a vehicle file, or vehicle = "path to one", or nothing.
Result<Vehicle> read_scenario_vehicle(TomlFields& root, const std::filesystem::path& file) {
  if (const auto* node = root.find("vehicle"); node && node->is_string())
    return read_vehicle(file.parent_path() / node->value_or(std::string()));
  bool described = false;
  for (const auto key : {"vehicle", "drag", "noise", "provenance"}) described = root.has(key) || described;
  return described ? vehicle_from_tables(root) : published_vehicle();
}

}  // namespace

Result<Scenario> parse_scenario(std::string_view text, const std::filesystem::path& file) {
  const std::string file_name = file.string();
  const auto table = parse_toml(text, file_name);
  if (!table) return fail(table.error());
  std::optional<Problem> problem;
  TomlFields root(*table, "", file_name, problem);
  Scenario scenario;
  scenario.name = file.stem().string();
  root.set("name", scenario.name);
  read_simulator(root, scenario);
  auto vehicle = read_scenario_vehicle(root, file);
  if (!vehicle) return fail(vehicle.error());
  if (problem) return fail(*problem);
  scenario.vehicle = *vehicle;
  read_site(root.table("site"), scenario.site);
  read_wind(root.table("wind"), scenario.wind);
  read_sensors(root.table("sensors"), scenario.sensors);
  root.set("start_height_m", scenario.start_height, 0, 20000);
  root.set("from_ground", scenario.from_ground);
  for (auto& leg : root.tables("path")) scenario.path.push_back(read_leg(leg));
  if (const auto seed = root.number("seed", 0, 9e15)) scenario.seed = static_cast<std::uint64_t>(*seed);
  root.leftover();
  if (scenario.path.empty()) root.complain("path", "the scenario flies nothing: give at least one [[path]]");
  if (problem) return fail(*problem);
  return scenario;
}

Result<Scenario> read_scenario(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return fail(Kind::unreadable, "the scenario cannot be opened", {file.string(), {}, {}, {}},
                "give an existing file; examples/scenarios has some to start from");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_scenario(text, file);
}

}  // namespace quadsonde::ingest
