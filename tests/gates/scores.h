#pragma once
// How well an estimate meets the wind that was really there: the definitions of ESTIMATION.md section 10.
#include <optional>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "ingest/flight/truth.h"

namespace quadsonde::gates {

struct Score {
  double rmse = 0;        ///< all samples, both components [m/s]
  double rmse_10s = 0;    ///< means over 10 s [m/s]
  double rmse_bin = 0;    ///< means over 10 m of each leg [m/s]
  double mean_error = 0;  ///< flight mean, length of the vector [m/s]
  double lag = 0;         ///< positive: late along the flight [m]
  double direction = 0;   ///< rms of the direction of 10 s means [deg]
  double coverage = 0;    ///< share of components within 1.96 sd
  double bin_coverage = 0;
  double mean_sd = 0;     ///< [m/s]
};

/// @param from_s  seconds at the flight's beginning that are not judged
Score score(const estimator::WindSeries& series, const ingest::Truth& truth, double from_s);

/// 95 % coverage of the bin means of a profile's legs up and down, and their error.
struct BinScore {
  double rmse = 0, coverage = 0;
  int bins = 0;
};

}  // namespace quadsonde::gates
