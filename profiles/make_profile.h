#pragma once
#include "estimator/smoother/wind_series.h"
#include "ingest/flight/problem.h"
#include "profiles/profile.h"

namespace quadsonde::profiles {

struct ProfileSettings {
  double bin_m = 10;
  Datum datum = Datum::agl;
};

template <class Visitor>
void describe(ProfileSettings& s, Visitor&& visit) {
  visit("bin_m", s.bin_m, 1.0, 1000.0, "Height of a bin; edges are its multiples in the chosen datum.");
}

/// Bins one flight: up, down and all legs, or only `all` for a flight without a climb of one bin.
/// datum agl falls back to msl, with a Problem, when the height above take-off is not known.
/// Fails with Kind::missing when the flight has no height at all.
/// Source: estimator/MODEL.md, bins.
ingest::Result<WindProfile> make_profile(const estimator::WindSeries& series, const ProfileSettings& settings = {});

}  // namespace quadsonde::profiles
