#pragma once
// Scores of an answer against the wind that was really there.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "export/report/profile_picture.h"
#include "ingest/flight/truth.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// Errors are ours minus the reference's [m/s], [deg].
struct Scores {
  std::size_t n = 0;
  double bias_east = 0, bias_north = 0, bias_speed = 0;
  double rmse_east = 0, rmse_north = 0, rmse_speed = 0;
  double rmsve = 0;             ///< root mean square vector error
  std::size_t n_direction = 0;  ///< pairs with a direction on both sides
  std::optional<double> bias_direction, rms_direction;
  std::optional<double> inside95;          ///< share of component intervals that hold the reference
  std::optional<double> normalised_error;  ///< mean of e' C^-1 e / 2: 1 when the covariance is right
};

/// One bin beside the reference's mean over the same time.
struct ScoredBin {
  double bottom = 0, top = 0;
  std::size_t samples = 0;
  Eigen::Vector2d ours = Eigen::Vector2d::Zero(), reference = Eigen::Vector2d::Zero();  ///< N, E
  bool inside95 = true;                                                                 ///< both components
};
struct ScoredLeg {
  profiles::LegName name;
  Scores scores;
  std::vector<ScoredBin> bins;
};

struct TruthComparison {
  std::string file;               ///< of the reference
  Scores samples;                 ///< every instant with a wind
  std::optional<Scores> classic;  ///< the published filter, after its first 60 s
  std::vector<ScoredLeg> legs;
  std::vector<ReferenceLevel> levels;  ///< mean of the truth in every bin of the whole flight, for pictures
};

/// Compares at the series' own times, the truth linear between its samples. Without a pair of times in common the
/// scores are empty (n = 0).
TruthComparison compare_with_truth(const estimator::WindSeries& series, const estimator::WindSeries* classic,
                                   const profiles::WindProfile* profile, const ingest::Truth& truth);

/// Sentences for people: what the errors are and whether the intervals hold.
std::vector<std::string> comparison_sentences(const TruthComparison& comparison);
/// Object of schema quadsonde.compare/1, as text.
std::string comparison_json(const TruthComparison& comparison, const std::string& file, int flight);

}  // namespace quadsonde::product
