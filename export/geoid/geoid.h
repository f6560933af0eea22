#pragma once
// The geoid EGM96: what lies between heights of satellites and heights above the sea.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "ingest/flight/flight.h"

namespace quadsonde::product {

/// Heights of the geoid EGM96 above the WGS84 ellipsoid. Two grids: 0.25 degrees, a file that the build makes of
/// proj-data's egm96_15.gtx, and every fourth node of it inside this library for where that file is not. Against the
/// cubic of the fine grid the coarse one is off by 0.42 m rms, 1.8 m at the 99th percentile and 9.4 m at most (200,000
/// points all over the globe). May be used by several threads. Copies share the grid.
class Geoid {
 public:
  /// The fine grid egm96-15.pgm from the folder that QUADSONDE_GEOIDS names, from where quadsonde was installed or
  /// from where it was built; else the coarse one. Cannot fail.
  static Geoid open();
  /// The fine grid from this folder and no other; the coarse one where it is not, or is damaged.
  static Geoid open(const std::filesystem::path& folder);

  /// Height of the geoid above the ellipsoid [m]; empty where the point is none (not finite, latitude beyond a pole).
  std::optional<double> undulation(ingest::GeoPoint point) const;
  bool is_fine() const { return fine_ != nullptr; }
  /// "EGM96", as geoids are named in CF.
  static std::string name() { return "EGM96"; }
  /// Which grid it is, for people: every product that used it says so.
  std::string provenance() const;

 private:
  struct Fine;
  std::shared_ptr<const Fine> fine_;
};

/// Gives a flight that knows heights above the ellipsoid and places, but no height above the sea, the latter.
/// @return whether it did; the stream's source then names the geoid
bool add_msl_heights(ingest::Flight& flight, const Geoid& geoid);

}  // namespace quadsonde::product
