#pragma once
// One page about one flight: the answer first, then what it rests on. Complete in itself, nothing is loaded.
#include <string>
#include <vector>

#include "export/csv/source.h"
#include "export/report/autopilot_wind.h"
#include "export/report/profile_picture.h"
#include "export/report/section_picture.h"
#include "export/report/series_picture.h"

namespace quadsonde::product {

struct Report {
  FlightTitle title;
  const estimator::WindSeries* series = nullptr;  ///< needed
  const estimator::WindSeries* classic = nullptr;
  const profiles::WindProfile* profile = nullptr;  ///< none: the page shows the wind along the flight only
  const profiles::Section* section = nullptr;      ///< its wind over time and height, where there is more than one leg each
  ProductSource source;
  std::vector<ReferenceLevel> reference;
  std::vector<ReferenceMark> marks;                           ///< reports of stations
  std::vector<ReferencePoint> along;                          ///< the reference over the time of the flight
  const ingest::Stream<Eigen::Vector3d>* velocity = nullptr;  ///< v_NB_N as measured [m/s]
  std::optional<AutopilotComparison> autopilot;
  std::vector<std::string> comparison;  ///< sentences on how the answer compares with a reference
};

/// HTML text. Cannot fail.
std::string report_html(const Report& report);

}  // namespace quadsonde::product
