#pragma once
#include <optional>
#include <string>

#include "estimator/smoother/wind_series.h"
#include "ingest/flight/problem.h"
#include "profiles/profile.h"

namespace quadsonde::profiles {

struct ProfileSettings {
  double bin_m = 10;
  Datum datum = Datum::agl;
  Method method = Method::bins;
  std::string leg_times;      ///< empty: legs are found in the height's course
  double height_psd = 0.02;   ///< method optimal: random walk of the wind with height [m2/s2 per metre]
  std::optional<double> hub_height;  ///< for which the wind is told beside 10, 50 and 100 m [m above take-off]
};

template <class Visitor>
void describe(ProfileSettings& s, Visitor&& visit) {
  visit("bin_m", s.bin_m, 1.0, 1000.0, "Height of a bin; edges are its multiples in the chosen datum.");
  visit("leg_times", s.leg_times, "LIST",
        "Legs named by the log's time_s, as in \"up 10-130, down 150-270\"; what is not named is neither.");
  visit("height_psd", s.height_psd, 0.0001, 1.0,
        "Method optimal: how much the wind may vary with height, variance per metre (m2/s2/m).");
  visit("hub_height_m", s.hub_height, 1.0, 1000.0,
        "Height above take-off, a turbine's hub for one, at which the wind is told beside 10, 50 and 100 m.");
}

/// Bins one flight, or with method optimal estimates the profile itself (profiles/optimal.h): up, down and all legs, or
/// only `all` for a flight without a climb of one bin.
/// datum agl falls back to msl, with a Problem, when the height above take-off is not known.
/// Fails with Kind::missing when the flight has no height at all.
/// Source: estimator/MODEL.md, bins.
ingest::Result<WindProfile> make_profile(const estimator::WindSeries& series, const ProfileSettings& settings = {});

}  // namespace quadsonde::profiles
