#pragma once
// The wind profile as a picture: speed and direction against height, height up.
#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "export/report/words.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// A wind known from elsewhere at a height in the profile's datum [m].
struct ReferenceLevel {
  double height = 0;
  Eigen::Vector2d v_NA_N = Eigen::Vector2d::Zero();
};

/// A report of a station: a mark at its height with what it leaves open.
struct ReferenceMark {
  std::string name;                                     ///< "METAR LFBO"
  double height = 0;                                    ///< in the profile's datum [m]
  double speed = 0, low = 0, high = 0;                  ///< [m/s]; range reported, or half a step of rounding around it
  std::optional<double> from_deg;                       ///< empty: variable or calm
  double from_half_deg = 0;                             ///< half a step of rounding
  std::optional<std::pair<double, double>> sector_deg;  ///< over which it varied: from, clockwise to
  std::optional<double> gust;                           ///< [m/s]
};

struct ProfilePicture {
  FlightTitle title;
  std::string drag;                       ///< one line on the drag used
  std::vector<ReferenceLevel> reference;  ///< from the ground up; may be empty
  std::string reference_name = "true wind";
  std::string id = "profile";  ///< makes names inside the picture unique on a page
  std::vector<ReferenceMark> marks = {};
};

/// SVG text, 900 by 650, complete in itself. Bands are 95 % intervals of the bin means; hollow marks are doubtful,
/// crosses bad. Cannot fail; a profile without a wind gives empty axes that say so.
std::string profile_svg(const profiles::WindProfile& profile, const ProfilePicture& picture);

}  // namespace quadsonde::product
