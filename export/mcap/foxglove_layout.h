#pragma once
#include <string>

#include "profiles/profile.h"

namespace quadsonde::product {

/// A layout that Foxglove (and Lichtblick, its open fork) imports for a log of write_flight: map, wind over time, and
/// the profile's speed and direction over height, all legs in one plot.
/// @param profile  null: without the profile's plots
/// @return JSON with a newline at its end
std::string foxglove_layout(const profiles::WindProfile* profile);

}  // namespace quadsonde::product
