#pragma once
// Scores of a flight against reports of others: METAR, tables of stations. Everything is matched in UTC and in height
// above ground: a surface wind here beside a surface wind there.
#include <optional>
#include <vector>

#include "ingest/reference/reference.h"
#include "profiles/compare/scores.h"
#include "profiles/compare/settings.h"
#include "profiles/profile.h"

namespace quadsonde::profiles {

/// A report beside our mean wind at the height nearest to its own.
struct MatchedReport {
  ingest::ReferenceWind report;
  estimator::WindEstimate wind;  ///< ours: mean vector; its covariance holds what turbulence adds to so short a mean
  ingest::GroundHeight height;   ///< ours, mean
  ingest::UtcTime utc;           ///< ours, mean
  std::size_t samples = 0;
  double gap_s = 0;  ///< from the report's ten minutes to the flight: negative before it, 0 where they meet
  std::optional<double> distance_m;   ///< empty: the report names no place, or the flight has none
  double representativeness_m_s = 0;  ///< 1-sigma per component of place and time
  Pair pair;
};

/// Reports of one layer of heights.
struct ScoredLayer {
  double bottom = 0, top = 0;  ///< above ground [m]
  Scores scores;
};

struct ReportScores {
  Scores scores;
  std::vector<ScoredLayer> layers;          ///< 10 m each, only those with a report
  std::vector<MatchedReport> pairs;         ///< in the order of time
  bool outside_window = false;              ///< none lay within the window, so the nearest were taken
  std::optional<ingest::Problem> no_score;  ///< why nothing was scored; where.file is left to the caller
  std::size_t records = 0;
  std::optional<double> nearest_gap_s, nearest_distance_m;  ///< over all records with a wind
};

/// A report is the mean over the ten minutes before its time (WMO-No. 8; some stations of the US take two) at its
/// height above ground, 10 m where it names none. Taken are the reports within the window of the settings; if there is
/// none, those nearest in time, up to 3 h and 50 km away. Ours is the mean vector of all samples within 5 m of the
/// report's height (of the nearest height flown, where none are), within the window around the ten minutes.
/// What is to be expected of the error: our covariance, what turbulence adds to our short mean, rounding or range of
/// the report, and representativeness: sd^2 = 1.8e-3 r^(2/3) per component with r^2 = distance^2 + (speed * time)^2,
/// half of the structure function of both components that E. Lindborg, J. Fluid Mech. 388 (1999) 259, found along
/// flights (about 0.9 m/s over 10 km); where the distance is not known it holds the time alone.
ReportScores score_against_reports(const estimator::WindSeries& series, const ingest::Reference& reference,
                                   const CompareSettings& settings = {});
/// The same with the bin of a profile (of the leg `all`, else the first) whose mean height is nearest.
ReportScores score_against_reports(const WindProfile& profile, const ingest::Reference& reference,
                                   const CompareSettings& settings = {});

}  // namespace quadsonde::profiles
