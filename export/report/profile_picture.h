#pragma once
// The wind profile as a picture: speed and direction against height, height up.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "export/report/words.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// A wind known from elsewhere at a height in the profile's datum [m].
struct ReferenceLevel {
  double height = 0;
  Eigen::Vector2d v_NA_N = Eigen::Vector2d::Zero();
};

struct ProfilePicture {
  FlightTitle title;
  std::string drag;                       ///< one line on the drag used
  std::vector<ReferenceLevel> reference;  ///< from the ground up; may be empty
  std::string reference_name = "true wind";
  std::string id = "profile";  ///< makes names inside the picture unique on a page
};

/// SVG text, 900 by 650, complete in itself. Bands are 95 % intervals of the bin means; hollow marks are doubtful,
/// crosses bad. Cannot fail; a profile without a wind gives empty axes that say so.
std::string profile_svg(const profiles::WindProfile& profile, const ProfilePicture& picture);

}  // namespace quadsonde::product
