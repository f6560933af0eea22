#pragma once
// The wind along the flight as a picture: speed and direction against time.
#include <string>
#include <vector>

#include "export/report/words.h"

namespace quadsonde::product {

/// A wind known from elsewhere at an instant of the log's clock.
struct ReferencePoint {
  ingest::LogTime time;
  Eigen::Vector2d v_NA_N = Eigen::Vector2d::Zero();
};

struct SeriesPicture {
  FlightTitle title;
  const estimator::WindSeries* classic = nullptr;  ///< the published filter on the same flight, drawn beside ours
  std::string id = "series";                       ///< makes names inside the picture unique on a page
  std::vector<ReferencePoint> reference = {};      ///< in order of time; drawn where the flight is
  std::string reference_name = "true wind";
};

/// SVG text, 900 by 560, complete in itself: height, speed, direction; bands are 95 % intervals of each instant.
/// Long series are thinned to what a picture can show, each drawn point being one that was estimated. Cannot fail.
std::string series_svg(const estimator::WindSeries& series, const SeriesPicture& picture);

}  // namespace quadsonde::product
