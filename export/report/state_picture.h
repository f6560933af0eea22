#pragma once
// The state of the filters along the flight as a picture: airspeed and wind, north and east, against time.
#include <string>
#include <vector>

#include "export/report/series_picture.h"

namespace quadsonde::product {

struct StatePicture {
  FlightTitle title;
  const estimator::WindSeries* classic = nullptr;  ///< the published filter on the same flight, drawn beside ours
  const ingest::Stream<Eigen::Vector3d>* velocity = nullptr;  ///< v_NB_N as measured [m/s]
  std::vector<ReferencePoint> reference = {};                 ///< in order of time
  std::string reference_name = "true wind";
  std::string id = "state";  ///< makes names inside the picture unique on a page
};

/// SVG text, 900 by 800, complete in itself: the vehicle's velocity relative to the air with its measured velocity over
/// ground, then the wind, each north and east; bands are 95 % intervals. Cannot fail.
std::string state_svg(const estimator::WindSeries& series, const StatePicture& picture);

}  // namespace quadsonde::product
