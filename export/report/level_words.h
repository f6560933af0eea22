#pragma once
// What people ask of a profile next, as sentences: levels, shear, laws, jet, stability.
#include <string>
#include <vector>

#include "profiles/profile.h"

namespace quadsonde::product {

/// One sentence each, only for what the profile can tell; intervals are 95 %.
std::vector<std::string> level_sentences(const profiles::WindProfile& profile);
/// What the vehicle did, leg by leg: "ascent from 2 to 118 m in 116 s (1.00 m/s)".
std::vector<std::string> leg_sentences(const profiles::WindProfile& profile);

/// The profile's notes, a sentence or two each: what the flight is no profile of, and what would be one.
std::vector<std::string> note_sentences(const profiles::WindProfile& profile);

}  // namespace quadsonde::product
