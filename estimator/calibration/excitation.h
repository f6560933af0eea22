#pragma once
// How much a flight's own motion can tell of its drag.
#include <vector>

#include "estimator/filter/excitation.h"
#include "estimator/smoother/steps.h"

namespace quadsonde::estimator {

/// X = rms of v minus its projection on span{1, exp(i psi)}, v as N + iE [m/s]: what neither a constant wind nor a trim
/// could have caused. Over the sound steps. 0 for less than three of them.
/// Source: design notes, section 5, "Identifiability report".
double excitation_index(const std::vector<Step>& steps);

}  // namespace quadsonde::estimator
