#pragma once
// Where magnetic north lies: the World Magnetic Models 2015, 2020 and 2025 by GeographicLib.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"

namespace quadsonde::product {

/// What must be added to a magnetic heading to have the true one.
struct Declination {
  double deg = 0;     ///< positive: magnetic north lies east of true north
  double sd_deg = 0;  ///< of the model against a real field, of its age and of a date that is not known
  std::string model;  ///< for people: "World Magnetic Model 2025, valid 2025 to 2030"
  bool outside_validity = false;
  bool date_known = true;
};

/// Each set holds for five years; a date before the first or after the last takes the nearest, and the sd grows.
/// Error: the models' own statement, sqrt(0.26^2 + (5625 nT / horizontal field)^2) deg (The US/UK World Magnetic Model
/// for 2020-2025, technical report, table 12): 0.4 deg in middle latitudes, many degrees near the magnetic poles.
/// May be used by several threads. Copies share the sets.
class MagneticNorth {
 public:
  /// The sets from the folder that QUADSONDE_MAGNETIC names, from where quadsonde was installed, from where it was
  /// built or from where `geographiclib-get-magnetic` puts them. Cannot fail: see empty().
  static MagneticNorth open();
  /// From this folder and no other.
  static MagneticNorth open(const std::filesystem::path& folder);

  bool empty() const { return models_.empty(); }
  /// @param height  above the ellipsoid or the sea [m]: a kilometre changes nothing here
  /// @param time    empty: the date is not known, and what fifteen years may change joins the sd
  /// Empty without a set, for a point that is none, and where the horizontal field is below 2000 nT (no compass works).
  std::optional<Declination> declination(ingest::GeoPoint point, double height,
                                         std::optional<ingest::UtcTime> time) const;

 private:
  struct Model;
  std::vector<std::shared_ptr<const Model>> models_;  ///< by epoch
};

}  // namespace quadsonde::product
