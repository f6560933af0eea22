#pragma once
// Scores of an answer against the wind that was really there, at the vehicle.
#include <optional>
#include <vector>

#include "ingest/flight/truth.h"
#include "profiles/compare/scores.h"
#include "profiles/compare/settings.h"
#include "profiles/profile.h"

namespace quadsonde::profiles {

/// One bin beside the truth's mean over the same time, and the scores of every instant in it.
struct ScoredBin {
  double bottom = 0, top = 0;  ///< in the profile's datum [m]
  std::size_t samples = 0;     ///< instants of the truth's mean
  Eigen::Vector2d ours = Eigen::Vector2d::Zero(), reference = Eigen::Vector2d::Zero();  ///< N, E [m/s]
  bool inside95 = true;                                                                 ///< both components
  Scores scores;  ///< of its instants; of the bin alone where only a profile was given
};
struct ScoredLeg {
  LegName name = LegName::all;
  Scores scores;  ///< of its bins
  std::vector<ScoredBin> bins;
};

struct TruthScores {
  Scores samples;                 ///< every instant with a wind; empty where only a profile was given
  std::optional<Scores> classic;  ///< the published filter, after its first 60 s
  std::vector<ScoredLeg> legs;
  bool by_height = false;  ///< matched by height, not by time

  /// The scores that stand for the whole: every instant, else the bins of the leg that stands for the flight.
  const Scores& whole() const;
};

/// At the series' own times, the truth linear between its samples (never across more than 2 s). Without an instant in
/// common the scores are empty (n = 0).
TruthScores score_against_truth(const estimator::WindSeries& series, const estimator::WindSeries* classic,
                                const WindProfile* profile, const ingest::Truth& truth,
                                const CompareSettings& settings = {});

/// A profile alone has no log time: each bin is scored against the mean of the truth in its heights, legs found in the
/// truth's own course of height; what it holds below 0.5 m is left out as standing on the ground. Bins above sea level
/// are brought above take-off by the two heights that they carry.
TruthScores score_against_truth(const WindProfile& profile, const ingest::Truth& truth,
                                const CompareSettings& settings = {});

/// Take-off in the datum of the bins [m]: 0, or its height above sea level by the two heights that bins carry; empty
/// where they do not tell.
std::optional<double> takeoff_in_datum(const WindProfile& profile);

}  // namespace quadsonde::profiles
