#pragma once
// Several flights at one site to one profile, and how well they agree with what they claim.
#include <optional>
#include <vector>

#include "profiles/profile.h"

namespace quadsonde::profiles {

/// Do the flights scatter as their uncertainties say? chi2 = sum over flights and bins of d' C^-1 d about the merged
/// wind; C has noise, trim, calibration and turbulence sampling. Real weather between flights adds to it.
struct SpreadTest {
  double chi2 = 0;
  int degrees_of_freedom = 0;
  double p_value = 1;
};

struct MergedProfile {
  WindProfile profile;       ///< one leg `all`
  SpreadTest spread;
  double hours = 0;          ///< between the first and the last flight's middle
  double farthest_m = 0;     ///< between two flights' places
};

struct MergeSettings {
  double farthest_km = 5;    ///< flights further apart are not one site
};

/// Why profiles cannot stand side by side: other bins or datums, or places too far apart; empty where they can.
std::optional<ingest::Problem> why_not_one_site(const std::vector<const WindProfile*>& profiles,
                                                const MergeSettings& settings = {});

/// The legs `all` of profiles with the same bins, weighted by the inverse covariances; bad bins have no part in it.
/// What the flights have in common, the calibration, stays undivided.
/// Bins in which the flights contradict each other (p < 0.001) are doubtful and their covariance is widened to the
/// scatter. Kind::usage for fewer than two profiles, other bin heights or datums, or two sites.
ingest::Result<MergedProfile> merge_profiles(const std::vector<const WindProfile*>& profiles,
                                             const MergeSettings& settings = {});

}  // namespace quadsonde::profiles
