#pragma once
// Heights are points, not lengths: each datum is a type, and only a geoid or a take-off point converts.
#include <compare>

namespace quadsonde::ingest {

/// Height above the WGS84 ellipsoid [m].
struct EllipsoidHeight {
  double m = 0;
  friend auto operator<=>(const EllipsoidHeight&, const EllipsoidHeight&) = default;
};
/// Height above mean sea level, that is, above the geoid [m].
struct MslHeight {
  double m = 0;
  friend auto operator<=>(const MslHeight&, const MslHeight&) = default;
};
/// Height above the take-off point [m]; no terrain model.
struct GroundHeight {
  double m = 0;
  friend auto operator<=>(const GroundHeight&, const GroundHeight&) = default;
};

/// Differences of one datum are lengths [m].
inline double operator-(EllipsoidHeight a, EllipsoidHeight b) { return a.m - b.m; }
inline double operator-(MslHeight a, MslHeight b) { return a.m - b.m; }
inline double operator-(GroundHeight a, GroundHeight b) { return a.m - b.m; }

/// Height above take-off, given the take-off point's MSL height.
inline GroundHeight above_takeoff(MslHeight h, MslHeight takeoff) { return {h.m - takeoff.m}; }
inline MslHeight above_sea(GroundHeight h, MslHeight takeoff) { return {h.m + takeoff.m}; }
/// @param undulation  geoid height above the ellipsoid [m]
inline MslHeight above_geoid(EllipsoidHeight h, double undulation) { return {h.m - undulation}; }

}  // namespace quadsonde::ingest
