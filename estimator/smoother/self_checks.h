#pragma once
// What the smoothed estimate of a flight says about itself without any truth. Source: design notes, section 9.
#include "estimator/smoother/passes.h"

namespace quadsonde::estimator {

/// Every check as a number with its flag and its sentence; those that this flight cannot show are not judged.
/// @param series  smoothed; one point per step
/// @param pass    the forward pass behind it, with its whitened innovations
SelfCheck heading_crosstalk(const WindSeries& series, const std::vector<Step>& steps, double sigma_u, double time_u);
SelfCheck velocity_crosstalk(const WindSeries& series, const std::vector<Step>& steps, double excitation, double time_u);
SelfCheck split_halves(const WindSeries& series, double sigma_u, double time_u);
SelfCheck innovation_size(const ForwardPass& pass);
SelfCheck innovation_whiteness(const ForwardPass& pass);

/// Velocity of every fifth window of 20 s is kept from filter and smoother, and foretold in the window's middle.
/// @param settings   of the final forward pass
/// @param consider   covariance of the consider parameters
SelfCheck hold_out(std::vector<Step> steps, PassSettings settings, const ConsiderCovariance& consider);

/// What the body accelerometer reads along forward and right is drag alone, without attitude and without thrust: means
/// over 5 s against the drag of the attitude's wind, each about its mean (the sensor's bias), in m/s of airspeed.
SelfCheck accelerometer_path(const ingest::Flight& flight, const ingest::DragLaw<double>& law, const WindSeries& series,
                             const std::vector<Step>& steps);

}  // namespace quadsonde::estimator
