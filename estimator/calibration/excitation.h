#pragma once
// How much a flight's own motion can tell of its drag.
#include <vector>

#include "estimator/smoother/steps.h"

namespace quadsonde::estimator {

/// X = rms of v minus its projection on span{1, exp(i psi)}, v as N + iE [m/s]: what neither a constant wind nor a trim
/// could have caused. Over the sound steps. 0 for less than three of them.
/// Source: design notes, section 5, "Identifiability report".
double excitation_index(const std::vector<Step>& steps);

inline constexpr double enough_excitation = 1.5;  ///< from here on a flight may calibrate [m/s]
inline constexpr double some_excitation = 0.5;    ///< from here on what it says is shown, but not used

}  // namespace quadsonde::estimator
