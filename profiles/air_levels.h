#pragma once
// Pressure, temperature and humidity of the air in each bin, where a sensor made for it was logged.
#include <optional>

#include "profiles/profile.h"

namespace quadsonde::profiles {

/// Height above the surface of 1013.25 hPa at which the standard atmosphere has this pressure [m], up to 11 km; empty
/// for other pressures. Source: ISO 2533; CF calls it barometric_altitude.
std::optional<double> barometric_altitude(double pressure_pa);
/// Of a bin's pressure; empty where none was logged.
std::optional<double> barometric_altitude(const Bin& bin);

/// Fills each bin with the means over the samples of air and barometer that were taken in its heights, whatever the
/// leg. The autopilot's barometer gives the pressure where no other sensor does; temperature and humidity come from
/// sensors of the air only. Bins without a sample stay empty.
/// @param series  of the same flight, with heights in the profile's datum
void fill_air(WindProfile& profile, const estimator::WindSeries& series, const ingest::Flight& flight);

}  // namespace quadsonde::profiles
