#pragma once
// Observations for the Model Evaluation Tools: the 11 columns that ascii2nc reads as met_point.
#include <string>

#include "export/uasdc/observations.h"

namespace quadsonde::product {

/// One line per value, blanks between columns, NA for what is missing: ADPUPA, the station (WIGOS identifier or name
/// or the place), valid time, latitude, longitude, elevation of the site, name of the value, pressure where it was
/// measured, height above the sea, quality (0 good, 1 doubtful, 3 bad), the value.
/// Values: UGRD, VGRD [m/s], WIND [m/s], WDIR [deg], TMP [K], DPT [K], RH [%], MIXR [kg/kg].
/// Source: MET User's Guide 11, "Re-Formatting of Point Observations", ascii2nc.
std::string met_point(const Observations& observations, const NetcdfMetadata& metadata);

}  // namespace quadsonde::product
