#pragma once
// Where a product's numbers come from: what every product repeats so that it can be traced and repeated.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::product {

/// A setting under the name that flags and settings files use; monostate: left out, so chosen by the flight.
using SettingValue = std::variant<std::monostate, bool, double, std::string>;
struct NamedSetting {
  std::string name;
  SettingValue value;
};

struct ProductSource {
  std::string file;    ///< name without folders: a product says nothing about the machine it was made on
  std::string sha256;  ///< of the file
  int flight = 1;      ///< which airborne part of the file, from 1
  ingest::Vehicle vehicle;
  std::vector<NamedSetting> settings;
  std::vector<ingest::Problem> problems;  ///< all that were met on the way, of every stage
  /// How heights above the sea were made where the log has none of its own: by which geoid, from which stream.
  std::string made_heights{};
  /// The file that the vehicle was read from: its name without folders, and what it held. Empty for a class prior.
  std::string vehicle_file{}, vehicle_sha256{};
};

}  // namespace quadsonde::product
