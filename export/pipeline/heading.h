#pragma once
// Headings that do not count from true north, or are off by what the user knows.
#include <string>

#include "export/magnetic/magnetic_north.h"
#include "export/pipeline/settings.h"
#include "ingest/flight/flight.h"

namespace quadsonde::product {

struct HeadingFacts {
  double added_deg = 0;  ///< to every heading
  double sd_deg = 0;     ///< of what was added, or of what is missing: joins the setting heading_sd_deg
  std::string words;     ///< for people; empty where nothing was done
};

/// The root mean square of the declination between 55 S and 65 N (World Magnetic Model 2025 at 2026.0): what a magnetic
/// heading may be off where no declination can be had.
inline constexpr double unknown_declination_deg = 15;

/// Adds the declination to headings that count from magnetic north, and the user's offset to all. What PX4 and
/// ArduPilot log is true already: there no declination is added, whatever the settings say, and that is told.
/// @param magnetic_by_map  the map of a table says that its headings are magnetic
HeadingFacts correct_heading(ingest::Flight& flight, const std::string& format, bool magnetic_by_map,
                             const InputSettings& settings, const MagneticNorth& north, const std::string& file);

}  // namespace quadsonde::product
