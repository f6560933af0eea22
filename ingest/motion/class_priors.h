#pragma once
// What may be assumed of a multirotor nobody calibrated, by its mass and rotors: the table class_priors.toml.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/motion/vehicle.h"

namespace quadsonde::ingest {

/// A drag that somebody measured, and where that is told.
struct ClassSource {
  std::string what;
  std::optional<double> drag_per_s, mass_kg, rotor_diameter_m;
  bool used = true;  ///< false: looked at, and `what` says why it does not count
};

struct VehicleClass {
  std::string name, what;
  Eigen::Vector2d mass_kg{0, 0}, rotor_diameter_m{0, 0};  ///< from, to
  double relative_sd = 0;                                 ///< of ln c
  std::vector<std::string> known_as;                      ///< beginnings of names in logs
  std::vector<ClassSource> sources;
  Vehicle prior;  ///< method "prior", id "class:NAME"
};

/// All of the table, from the lightest to the heaviest; the generic class is not among them.
const std::vector<VehicleClass>& vehicle_classes();
/// The table's own text, for people.
std::string_view class_priors_text();
/// Fails with Kind::usage for a table that is none: the reason why a test reads the shipped one.
Result<std::vector<VehicleClass>> parse_vehicle_classes(std::string_view toml, const std::string& file_name);

/// The class whose mass and rotors [m] come nearest, by the ratio to its nearest bound; a mass decides before rotors.
/// Null where neither is known, or where the nearest class is more than a factor of 2 away.
const VehicleClass* class_of(std::optional<double> mass_kg, std::optional<double> rotor_diameter_m);
/// The class that a log's name for its vehicle tells; null if it tells none.
const VehicleClass* class_known_as(std::string_view vehicle_name);
const VehicleClass* class_named(std::string_view name);

}  // namespace quadsonde::ingest
