#include "ingest/motion/vehicle.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "ingest/motion/toml_fields.h"
#include "ingest/motion/vehicle_tables.h"

namespace quadsonde::ingest {
namespace {

constexpr double prior_ln_c_sd = 0.35;
constexpr double prior_kappa_sd = 0.004;
constexpr double prior_alpha = 0.03, prior_alpha_sd = 0.05, prior_g2_sd = 0.03;
constexpr double prior_latency_s = 0.05, prior_latency_sd_s = 0.08;
constexpr double prior_trim_sd_deg = 3;

void read_identity(TomlFields fields, Vehicle& vehicle) {
  fields.set("id", vehicle.id);
  fields.set("name", vehicle.name);
  vehicle.mass_kg = fields.number("mass_kg", 1e-3, 1e4);
  vehicle.rotor_diameter_m = fields.number("rotor_diameter_m", 1e-3, 20);
  if (const auto rotors = fields.number("rotors", 1, 64)) vehicle.rotors = static_cast<int>(*rotors);
  fields.leftover();
}

/// No combination of the parameters has a negative variance, rounding aside.
bool nonnegative(const DragCovariance& C) {
  DragCovariance correlation;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) {
      const double scale = std::sqrt(C(i, i) * C(j, j));
      if (scale == 0 && C(i, j) != 0) return false;
      correlation(i, j) = scale > 0 ? C(i, j) / scale : 0;
    }
  return Eigen::SelfAdjointEigenSolver<DragCovariance>(correlation).eigenvalues().minCoeff() > -1e-9;
}

void read_covariance(TomlFields& fields, DragCovariance& covariance) {
  const auto* node = fields.find("covariance");
  if (!node) return;
  const auto* rows = node->as_array();
  DragCovariance read;
  bool sound = rows && rows->size() == 7;
  for (int i = 0; sound && i < 7; ++i) {
    const auto* row = rows->get(static_cast<std::size_t>(i))->as_array();
    sound = row && row->size() == 7;
    for (int j = 0; sound && j < 7; ++j) {
      const auto value = row->get(static_cast<std::size_t>(j))->value<double>();
      sound = value.has_value() && std::isfinite(*value);
      if (sound) read(i, j) = *value;
    }
  }
  const bool symmetric = sound && (read - read.transpose()).norm() <= 1e-9 * (1e-12 + read.norm());
  if (!symmetric || (read.diagonal().array() < 0).any() || !nonnegative(read)) {
    fields.complain("covariance",
                    "expected a symmetric, positive semidefinite 7 by 7 matrix of the seven drag parameters, in their order",
                    node);
    return;
  }
  covariance = read;
}

void read_drag(TomlFields fields, Vehicle& v) {
  if (!fields.has("linear_per_s")) fields.complain("linear_per_s", "is missing: without it there is no drag law");
  // A file without a covariance is one written by hand: the sds of the prior stand in for what it does not tell.
  v.covariance = class_prior().covariance;
  fields.set("linear_per_s", v.drag.linear, 1e-4, 100);
  fields.set("quadratic_per_m", v.drag.quadratic, -1, 10);
  const bool climb_known = fields.has("climb_linear_s_per_m") || fields.has("climb_quadratic_s2_per_m2");
  fields.set("climb_linear_s_per_m", v.drag.climb_linear, -2, 2);
  fields.set("climb_quadratic_s2_per_m2", v.drag.climb_quadratic, -2, 2);
  if (!climb_known) v.drag.climb_linear = prior_alpha;
  fields.set("latency_s", v.latency_s, -2, 5);
  fields.set("trim_roll_deg", v.trim_roll_deg, -30, 30);
  fields.set("trim_pitch_deg", v.trim_pitch_deg, -30, 30);
  read_covariance(fields, v.covariance);
  fields.set("between_flights_rel_sd", v.between_flights_rel_sd, 0, 2);
  fields.set("air_density_kg_m3", v.air_density_kg_m3, 0.1, 3);
  fields.set("density_exponent", v.density_exponent, 0, 2);
  if (const auto range = fields.numbers("airspeed_range_m_s", 2)) v.airspeed_range_m_s = {(*range)[0], (*range)[1]};
  fields.leftover();
}

void read_provenance(TomlFields fields, Vehicle& v) {
  fields.set("method", v.method);
  v.excitation_m_s = fields.number("excitation_m_s", 0, 1e3);
  v.residual_rms_m_s2 = fields.number("residual_rms_m_s2", 0, 1e3);
  v.leave_one_out_m_s = fields.number("leave_one_out_m_s", 0, 1e3);
  for (auto& log : fields.tables("logs")) {
    VehicleLog entry;
    log.set("name", entry.name);
    log.set("sha256", entry.sha256);
    v.logs.push_back(entry);
  }
  if (const auto created = fields.text("created_utc")) {
    v.created = parse_iso8601(*created);
    if (!v.created) fields.complain("created_utc", "expected a time such as 2026-11-23T12:00:00Z");
  }
  fields.set("version", v.version);
  fields.leftover();
}

std::string number_line(std::string_view key, const std::optional<double>& value) {
  return value ? fmt::format("{} = {}\n", key, *value) : "";
}

std::string with_point(double value) {
  std::string text = fmt::format("{}", value);
  // 2 would be an integer in TOML; the key is a float.
  return text.find_first_of(".einf") == std::string::npos ? text + ".0" : text;
}

std::string drag_section(const Vehicle& v) {
  std::string text = "\n[drag]\n";
  text += fmt::format("linear_per_s = {}\nquadratic_per_m = {}\n", with_point(v.drag.linear), with_point(v.drag.quadratic));
  text += fmt::format("climb_linear_s_per_m = {}\nclimb_quadratic_s2_per_m2 = {}\n", with_point(v.drag.climb_linear),
                      with_point(v.drag.climb_quadratic));
  text += fmt::format("latency_s = {}\ntrim_roll_deg = {}\ntrim_pitch_deg = {}\n", with_point(v.latency_s),
                      with_point(v.trim_roll_deg), with_point(v.trim_pitch_deg));
  text += "covariance = [\n";
  for (int i = 0; i < 7; ++i) {
    text += "  [";
    for (int j = 0; j < 7; ++j) text += (j ? ", " : "") + with_point(v.covariance(i, j));
    text += "],\n";
  }
  text += "]\n";
  text += fmt::format("between_flights_rel_sd = {}\nair_density_kg_m3 = {}\ndensity_exponent = {}\n",
                      with_point(v.between_flights_rel_sd), with_point(v.air_density_kg_m3), with_point(v.density_exponent));
  return text + fmt::format("airspeed_range_m_s = [{}, {}]\n", with_point(v.airspeed_range_m_s.x()),
                            with_point(v.airspeed_range_m_s.y()));
}

std::string provenance_section(const Vehicle& v) {
  std::string text = fmt::format("\n[provenance]\nmethod = {}\n", toml_quoted(v.method));
  text += number_line("excitation_m_s", v.excitation_m_s) + number_line("residual_rms_m_s2", v.residual_rms_m_s2) +
          number_line("leave_one_out_m_s", v.leave_one_out_m_s);
  if (!v.logs.empty()) {
    text += "logs = [\n";
    for (const auto& log : v.logs)
      text += fmt::format("  {{ name = {}, sha256 = {} }},\n", toml_quoted(log.name), toml_quoted(log.sha256));
    text += "]\n";
  }
  if (v.created) text += fmt::format("created_utc = {}\n", toml_quoted(to_iso8601(*v.created, 0)));
  return text + fmt::format("version = {}\n", toml_quoted(v.version));
}

}  // namespace

void set_climb_prior(Vehicle& v) {
  v.drag.climb_linear = prior_alpha;
  v.drag.climb_quadratic = 0;
  for (const auto p : {p_climb_linear, p_climb_quadratic}) v.covariance.row(p).setZero(), v.covariance.col(p).setZero();
  v.covariance(p_climb_linear, p_climb_linear) = prior_alpha_sd * prior_alpha_sd;
  v.covariance(p_climb_quadratic, p_climb_quadratic) = prior_g2_sd * prior_g2_sd;
}

Vehicle class_prior() {
  Vehicle v;
  v.id = "class:generic";
  v.name = "a multirotor nobody has calibrated";
  v.drag.linear = 0.20;
  // Linearised at the median: the interval of the wind stays symmetric where that of the drag is lognormal.
  v.covariance(p_linear, p_linear) = std::pow(prior_ln_c_sd * v.drag.linear, 2);
  v.covariance(p_quadratic, p_quadratic) = prior_kappa_sd * prior_kappa_sd;
  v.latency_s = prior_latency_s;
  v.covariance(p_latency, p_latency) = prior_latency_sd_s * prior_latency_sd_s;
  for (const auto p : {p_trim_roll, p_trim_pitch}) v.covariance(p, p) = prior_trim_sd_deg * prior_trim_sd_deg;
  set_climb_prior(v);
  v.between_flights_rel_sd = 0;  // the class's spread holds it
  v.airspeed_range_m_s = {0, 8};  // beyond 8 m/s the recorded vehicles needed a quadratic term of their own
  return v;
}

Vehicle vehicle_from_tables(TomlFields& root) {
  Vehicle vehicle;
  vehicle.method = "given";
  read_identity(root.table("vehicle"), vehicle);
  read_drag(root.table("drag"), vehicle);
  auto noise = root.table("noise");
  noise.set("tilt_sd_deg", vehicle.tilt_sd_deg, 0.001, 20);
  noise.set("tilt_correlation_s", vehicle.tilt_correlation_s, 0, 60);
  noise.leftover();
  read_provenance(root.table("provenance"), vehicle);
  return vehicle;
}

Result<Vehicle> parse_vehicle(std::string_view text, const std::string& file_name) {
  const auto table = parse_toml(text, file_name);
  if (!table) return fail(table.error());
  std::optional<Problem> problem;
  TomlFields root(*table, "", file_name, problem);
  const Vehicle vehicle = vehicle_from_tables(root);
  root.leftover();
  if (problem) return fail(*problem);
  return vehicle;
}

Result<Vehicle> read_vehicle(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return fail(Kind::unreadable, "the vehicle file cannot be opened", {file.string(), {}, {}, {}},
                "give an existing file, or leave --vehicle out to use the class prior");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_vehicle(text, file.string());
}

std::string to_toml(const Vehicle& v) {
  std::string text = fmt::format("[vehicle]\nid = {}\nname = {}\n", toml_quoted(v.id), toml_quoted(v.name));
  text += number_line("mass_kg", v.mass_kg) + number_line("rotor_diameter_m", v.rotor_diameter_m);
  if (v.rotors) text += fmt::format("rotors = {}\n", v.rotors);
  text += drag_section(v);
  text += fmt::format("\n[noise]\ntilt_sd_deg = {}\ntilt_correlation_s = {}\n", with_point(v.tilt_sd_deg),
                      with_point(v.tilt_correlation_s));
  return text + provenance_section(v);
}

Result<Vehicle> flown_at(const Vehicle& vehicle, std::optional<double> mass_kg, double density) {
  if (mass_kg && !vehicle.mass_kg && !vehicle.is_prior())
    return fail(Kind::usage, "the vehicle file has no mass_kg, so its drag cannot be scaled to another mass", {},
                "add mass_kg to [vehicle], or leave --mass-kg out");
  Vehicle flown = vehicle;
  const double mass_ratio = mass_kg && vehicle.mass_kg ? *mass_kg / *vehicle.mass_kg : 1;
  const double density_ratio = density / vehicle.air_density_kg_m3;
  flown.drag = scaled(vehicle.drag, density_ratio, mass_ratio, vehicle.density_exponent);
  const DragLaw<double> unit = scaled(DragLaw<double>{1, 1, 0, 0}, density_ratio, mass_ratio, vehicle.density_exponent);
  Eigen::Matrix<double, 7, 1> factor = Eigen::Matrix<double, 7, 1>::Ones();
  factor(p_linear) = unit.linear;
  factor(p_quadratic) = unit.quadratic;
  flown.covariance = factor.asDiagonal() * vehicle.covariance * factor.asDiagonal();
  flown.air_density_kg_m3 = density;
  if (mass_kg) flown.mass_kg = mass_kg;
  return flown;
}

double standard_air_density(double height) {
  const double temperature = 288.15 - 0.0065 * std::clamp(height, -500.0, 11000.0);
  return sea_level_air_density * std::pow(temperature / 288.15, 4.2558797);
}

double air_density(double pressure, double temperature, double humidity) {
  // Saturation vapour pressure over water: Magnus form of WMO-No. 8, annex 4.B.
  const double celsius = temperature - 273.15;
  const double vapour = humidity / 100 * 611.2 * std::exp(17.62 * celsius / (243.12 + celsius));
  return (pressure - vapour) / (287.058 * temperature) + vapour / (461.495 * temperature);
}

}  // namespace quadsonde::ingest
