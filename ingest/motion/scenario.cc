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

void read_wind(TomlFields f, WindField& wind) {
  using Model = WindField::Model;
  choose<Model>(f, "model", {{"constant", Model::constant}, {"power_law", Model::power_law}, {"log_law", Model::log_law},
                             {"jet", Model::jet}, {"table", Model::table}}, wind.model);
  wind.toward = read_vector(f);
  f.set("reference_height_m", wind.reference_height, 0.1, 1000);
  f.set("power_exponent", wind.power_exponent, -1, 2);
  f.set("roughness_m", wind.roughness, 1e-6, 5);
  f.set("veer_deg_per_m", wind.veer_deg_per_m, -10, 10);
  f.set("turbulence_sd_m_s", wind.sigma_u, 0, 10);
  f.set("turbulence_time_s", wind.time_u, 0.01, 1000);
  f.set("vertical_sd_m_s", wind.sigma_w, 0, 10);
  f.set("vertical_time_s", wind.time_w, 0.01, 1000);
  for (auto& level : f.tables("level")) {
    WindField::Level l;
    level.set("height_m", l.height, -100, 20000);
    l.toward = read_vector(level);
    level.leftover();
    if (!wind.levels.empty() && l.height <= wind.levels.back().height)
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
  choose<Kind>(f, "kind", {{"hover", Kind::hover}, {"climb", Kind::climb}, {"line", Kind::line}, {"square", Kind::square},
                           {"circle", Kind::circle}}, leg.kind);
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

void read_sensors(TomlFields f, SensorModel& s) {
  f.set("rate_hz", s.output_rate, 0.1, 100);
  f.set("attitude_rate_hz", s.attitude_rate, 0.1, 100);
  f.set("tilt_sd_deg", s.tilt_sd_deg, 0, 20);
  f.set("tilt_correlation_s", s.tilt_correlation, 0, 100);
  f.set("heading_error_deg", s.heading_error_deg, -180, 180);
  f.set("trim_roll_deg", s.trim_roll_deg, -30, 30);
  f.set("trim_pitch_deg", s.trim_pitch_deg, -30, 30);
  f.set("velocity_sd_m_s", s.velocity_sd, 0, 10);
  f.set("height_sd_m", s.height_sd, 0, 50);
  f.set("position_sd_m", s.position_sd, 0, 50);
  f.set("latency_s", s.latency, 0, 5);
  f.set("controller_flies_on_measured", s.controller_flies_on_measured);
  f.leftover();
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
