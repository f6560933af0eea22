#pragma once
// Vertical wind from rotor speeds: how much thrust they would give in still air, against the thrust that was there.
// Source: estimator/MODEL.md section 17; design notes, section 2, "Vertical wind itself".
#include "estimator/smoother/steps.h"
#include "estimator/smoother/wind_series.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::estimator {

/// Gives every point with a wind its vertical wind where the flight's rotor speeds tell of it, and says in the answer
/// why not where they do not. The thrust's dependence on the speeds is calibrated on this very flight, so the mean of
/// the vertical wind over the flight is taken to be zero, and its sd counts.
/// @param series  smoothed; one point per step
VerticalWind estimate_vertical_wind(const ingest::Flight& flight, const ingest::Vehicle& vehicle, double air_density,
                                    const std::vector<Step>& steps, WindSeries& series);

}  // namespace quadsonde::estimator
