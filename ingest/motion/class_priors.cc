#include "ingest/motion/class_priors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "ingest/motion/class_priors_text.h"
#include "ingest/motion/toml_fields.h"

namespace quadsonde::ingest {
namespace {

Eigen::Vector2d read_range(TomlFields& fields, std::string_view key) {
  const auto range = fields.numbers(key, 2);
  if (!range || !((*range)[0] > 0 && (*range)[1] > (*range)[0])) {
    fields.complain(key, "expected two numbers above zero, the smaller one first", fields.find(key));
    return {1, 1};
  }
  return {(*range)[0], (*range)[1]};
}

ClassSource read_source(TomlFields& fields) {
  ClassSource source;
  fields.set("what", source.what);
  source.drag_per_s = fields.number("drag_per_s", 1e-3, 10);
  source.mass_kg = fields.number("mass_kg", 1e-3, 1e3);
  source.rotor_diameter_m = fields.number("rotor_diameter_m", 1e-3, 10);
  fields.set("used", source.used);
  if (source.what.empty()) fields.complain("what", "is missing: a source names where its number stands");
  fields.leftover();
  return source;
}

std::vector<std::string> read_names(TomlFields& fields) {
  std::vector<std::string> names;
  const auto* node = fields.find("known_as");
  if (!node) return names;
  const auto* array = node->as_array();
  if (!array) fields.complain("known_as", "expected names in brackets", node);
  if (!array) return names;
  for (const auto& element : *array)
    if (const auto name = element.value<std::string>()) names.push_back(*name);
  return names;
}

/// The generic prior, with the drag of this class.
Vehicle prior_of(const VehicleClass& kind, double linear, double sd_quadratic) {
  Vehicle v = class_prior();
  v.id = "class:" + kind.name;
  v.name = kind.what;
  v.drag.linear = linear;
  v.covariance(p_linear, p_linear) = std::pow(kind.relative_sd * linear, 2);
  v.covariance(p_quadratic, p_quadratic) = sd_quadratic * sd_quadratic;
  return v;
}

VehicleClass read_class(TomlFields& fields) {
  VehicleClass kind;
  fields.set("name", kind.name);
  fields.set("what", kind.what);
  kind.mass_kg = read_range(fields, "mass_kg");
  kind.rotor_diameter_m = read_range(fields, "rotor_diameter_m");
  const auto linear = fields.number("linear_per_s", 1e-3, 10);
  const auto relative_sd = fields.number("relative_sd", 0.3, 1);
  const auto sd_quadratic = fields.number("sd_quadratic_per_m", 0, 1);
  if (kind.name.empty() || !linear || !relative_sd || !sd_quadratic)
    fields.complain("name", "a class has a name, linear_per_s, relative_sd and sd_quadratic_per_m");
  kind.relative_sd = relative_sd.value_or(0.5);
  kind.known_as = read_names(fields);
  for (auto& source : fields.tables("source")) kind.sources.push_back(read_source(source));
  fields.leftover();
  kind.prior = prior_of(kind, linear.value_or(1), sd_quadratic.value_or(0));
  return kind;
}

/// |ln| of the ratio to the nearest bound; 0 inside.
double distance(double value, const Eigen::Vector2d& range) {
  return std::max({0.0, std::log(range.x() / value), std::log(value / range.y())});
}

bool begins_with(std::string_view text, std::string_view beginning) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return text.size() >= beginning.size() && std::equal(beginning.begin(), beginning.end(), text.begin(), same);
}

}  // namespace

std::string_view class_priors_text() { return shipped_class_priors; }

Result<std::vector<VehicleClass>> parse_vehicle_classes(std::string_view toml, const std::string& file_name) {
  const auto table = parse_toml(toml, file_name);
  if (!table) return fail(table.error());
  std::optional<Problem> problem;
  TomlFields root(*table, "", file_name, problem);
  std::vector<VehicleClass> classes;
  for (auto& fields : root.tables("class")) classes.push_back(read_class(fields));
  root.leftover();
  if (problem) return fail(*problem);
  return classes;
}

const std::vector<VehicleClass>& vehicle_classes() {
  // The shipped table is sound, as a test shows; were it not, the generic class would be all there is.
  static const std::vector<VehicleClass> classes =
      parse_vehicle_classes(shipped_class_priors, "class_priors.toml").value_or(std::vector<VehicleClass>{});
  return classes;
}

const VehicleClass* class_of(std::optional<double> mass_kg, std::optional<double> rotor_diameter_m) {
  constexpr double least = 1e-6, farthest = 0.6931471805599453;
  const VehicleClass* best = nullptr;
  double nearest = 1e9;
  for (const auto& kind : vehicle_classes()) {
    // Both bounds belong to two classes; the rotors, of little weight, decide there.
    const double by_mass = mass_kg && *mass_kg > least ? distance(*mass_kg, kind.mass_kg) : 0;
    const double by_rotors =
        rotor_diameter_m && *rotor_diameter_m > least ? distance(*rotor_diameter_m, kind.rotor_diameter_m) : 0;
    const double far = mass_kg ? by_mass + 1e-3 * by_rotors : by_rotors;
    if ((mass_kg ? by_mass : by_rotors) <= farthest && far < nearest) best = &kind, nearest = far;
  }
  return mass_kg || rotor_diameter_m ? best : nullptr;
}

const VehicleClass* class_known_as(std::string_view vehicle_name) {
  if (begins_with(vehicle_name, "DJI ")) vehicle_name.remove_prefix(4);
  for (const auto& kind : vehicle_classes())
    for (const auto& name : kind.known_as)
      if (begins_with(vehicle_name, name)) return &kind;
  return nullptr;
}

const VehicleClass* class_named(std::string_view name) {
  for (const auto& kind : vehicle_classes())
    if (kind.name == name) return &kind;
  return nullptr;
}

Result<Vehicle> class_prior(std::string_view name) {
  if (name == "generic") return class_prior();
  if (const auto* kind = class_named(name)) return kind->prior;
  std::string known = "generic";
  for (const auto& kind : vehicle_classes()) known += ", " + kind.name;
  return fail(Kind::usage, fmt::format("no class of vehicles is called '{}'", name), {}, "known classes: " + known);
}

}  // namespace quadsonde::ingest
