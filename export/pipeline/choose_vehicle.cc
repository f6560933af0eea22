// Whose drag the wind rests on: a file, or a class of vehicles.
#include <fmt/format.h>

#include "export/pipeline/analyse.h"
#include "export/sha256.h"
#include "ingest/motion/class_priors.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;

std::string mass_and_rotors(const DragSettings& settings) {
  std::string text;
  if (settings.mass_kg) text = fmt::format("a mass of {:g} kg", *settings.mass_kg);
  if (settings.rotor_diameter_m)
    text += fmt::format("{}rotors of {:g} m", text.empty() ? "" : " and ", *settings.rotor_diameter_m);
  return text;
}

constexpr const char* calibrate_hint = "calibrate the vehicle: `quadsonde calibrate LOG... -o vehicle.toml`";

/// The class that mass, rotors or the log's own name for its vehicle tell, said; else the generic one.
ingest::Vehicle class_by_itself(const DragSettings& settings, const ingest::VehicleIdentity* logged,
                                std::vector<Problem>& notes) {
  const auto told = mass_and_rotors(settings);
  const auto* kind = ingest::class_of(settings.mass_kg, settings.rotor_diameter_m);
  std::string by = told;
  if (told.empty() && logged) {
    kind = ingest::class_known_as(logged->name);
    by = fmt::format("the log's name for it, {}", logged->name);
  }
  if (kind) {
    notes.push_back({Kind::doubtful,
                     fmt::format("the drag is that of the class {} ({}), told by {}: class prior, not calibrated",
                                 kind->name, kind->what, by),
                     {},
                     calibrate_hint});
    return kind->prior;
  }
  if (!told.empty())
    notes.push_back({Kind::doubtful,
                     fmt::format("no class of vehicles is near {}: the generic class stands in", told),
                     {},
                     calibrate_hint});
  return ingest::class_prior();
}

/// A class asked for by name although mass or rotors tell another.
void doubt_class(const DragSettings& settings, std::vector<Problem>& notes) {
  const auto name = settings.vehicle.substr(6);
  if (name == "generic") return;
  const auto* asked = ingest::class_named(name);
  const auto* told = ingest::class_of(settings.mass_kg, settings.rotor_diameter_m);
  notes.push_back({Kind::doubtful,
                   fmt::format("the drag is that of the class {}: class prior, not calibrated", name),
                   {},
                   calibrate_hint});
  if (asked && told && asked != told)
    notes.push_back({Kind::doubtful,
                     fmt::format("{} is that of the class {}, not of {}, which was asked for",
                                 mass_and_rotors(settings), told->name, name),
                     {},
                     "leave --vehicle out to have the class chosen"});
}

/// What --mass-kg did to the drag of a vehicle file: told with its name, which every answer carries.
void tell_scaling(const ingest::Vehicle& file, ingest::Vehicle& flown, std::vector<Problem>& notes) {
  if (*flown.mass_kg == *file.mass_kg) return;
  flown.name = fmt::format("{}, scaled from {:g} to {:g} kg", file.name.empty() ? file.id : file.name, *file.mass_kg,
                           *flown.mass_kg);
  const double ratio = *flown.mass_kg / *file.mass_kg;
  if (ratio < 2 && ratio > 0.5) return;
  notes.push_back({Kind::doubtful,
                   fmt::format("--mass-kg {:g} is {:.2g} times the mass that was calibrated; the scaling by its root "
                               "holds for a payload, hardly so far",
                               *flown.mass_kg, ratio),
                   {},
                   "calibrate the vehicle as it flies"});
}

}  // namespace

ingest::Result<VehicleInUse> choose_vehicle(const DragSettings& settings, const std::filesystem::path& log,
                                            const ingest::VehicleIdentity* logged) {
  VehicleInUse use;
  const auto beside = log.parent_path() / "vehicle.toml";
  std::error_code error;
  ingest::Result<ingest::Vehicle> vehicle = ingest::class_prior();
  if (settings.vehicle.starts_with("class:")) {
    vehicle = ingest::class_prior(settings.vehicle.substr(6));
    use.from = settings.vehicle;
  } else if (settings.vehicle != "auto") {
    vehicle = ingest::read_vehicle(settings.vehicle);
    use.from = settings.vehicle;
    use.sha256 = sha256_of_file(settings.vehicle).value_or("");
  } else if (std::filesystem::exists(beside, error)) {
    vehicle = ingest::read_vehicle(beside);
    use.from = beside.string();
    use.sha256 = sha256_of_file(beside).value_or("");
  } else {
    use.from = "class prior";
    vehicle = class_by_itself(settings, logged, use.notes);
  }
  if (!vehicle) return fail(vehicle.error());
  if (settings.vehicle.starts_with("class:")) doubt_class(settings, use.notes);
  // The estimator scales to the flight's air density; here only the mass.
  auto flown = ingest::flown_at(*vehicle, settings.mass_kg, vehicle->air_density_kg_m3);
  if (!flown) return fail(flown.error());
  if (flown->is_prior() && settings.rotor_diameter_m) flown->rotor_diameter_m = settings.rotor_diameter_m;
  if (settings.mass_kg && vehicle->mass_kg) tell_scaling(*vehicle, *flown, use.notes);
  use.vehicle = std::move(*flown);
  return use;
}

}  // namespace quadsonde::product
