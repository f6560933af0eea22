#include "profiles/compare/against_truth.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "profiles/legs.h"

namespace quadsonde::profiles {
namespace {

using estimator::WindEstimate;
using Members = std::map<long, std::vector<std::size_t>>;  ///< bin number -> points

/// The truth at an instant; empty outside of it, or where its neighbours are more than 2 s apart.
std::optional<Eigen::Vector2d> truth_at(const ingest::Truth& truth, ingest::LogTime t) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), t, [](const auto& a, ingest::LogTime b) { return a.time < b; });
  if (after == truth.end()) return std::nullopt;
  if (after->time == t) return after->v_NA_N.head<2>();
  if (after == truth.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double span = ingest::to_seconds(after->time - before->time);
  if (span > 2) return std::nullopt;
  const double part = ingest::to_seconds(t - before->time) / span;
  return before->v_NA_N.head<2>() + part * (after->v_NA_N - before->v_NA_N).head<2>();
}

Pair pair_with(const WindEstimate& wind, const Eigen::Vector2d& reference) {
  return pair_of(wind.v_NA_N, reference, wind.has_covariance ? std::optional(wind.covariance) : std::nullopt);
}

Scores score_samples(const estimator::WindSeries& series, const ingest::Truth& truth, double skip_s,
                     const CompareSettings& settings) {
  Scorer scorer(settings.direction_above_m_s);
  for (const auto& p : series.points) {
    if (ingest::to_seconds(p.time - series.points.front().time) < skip_s) continue;
    const auto* wind = std::get_if<WindEstimate>(&p.wind);
    const auto reference = truth_at(truth, p.time);
    if (wind && reference) scorer.add(pair_with(*wind, *reference));
  }
  return scorer.scores();
}

/// Numbers of the points of every bin of a leg, found as make_profile finds them.
Members members_of(const std::vector<estimator::WindPoint>& points, const std::vector<std::optional<double>>& heights,
                   double bin_m, LegName leg, const std::function<bool(std::size_t)>& counts) {
  const auto parts = find_parts(points, heights, bin_m);
  Members members;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!heights[i] || !counts(i)) continue;
    const bool fits = leg == LegName::all || parts[i] == (leg == LegName::up ? Part::up : Part::down);
    if (fits) members[static_cast<long>(std::floor(*heights[i] / bin_m))].push_back(i);
  }
  return members;
}

Members members_of(const estimator::WindSeries& series, const WindProfile& profile, LegName leg) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : series.points) {
    const bool agl = profile.datum == Datum::agl;
    const auto height = agl ? (p.height_agl ? std::optional(p.height_agl->m) : std::nullopt)
                            : (p.height_msl ? std::optional(p.height_msl->m) : std::nullopt);
    heights.push_back(height);
  }
  return members_of(series.points, heights, profile.bin_m, leg,
                    [&](std::size_t i) { return std::holds_alternative<WindEstimate>(series.points[i].wind); });
}

/// The truth's mean over the instants of a bin and the scores of each; empty where one of them has no truth.
struct BinTruth {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Scores scores;
};
std::optional<BinTruth> truth_of(const estimator::WindSeries& series, const std::vector<std::size_t>& members,
                                 const ingest::Truth& truth, const CompareSettings& settings) {
  BinTruth bin;
  Scorer scorer(settings.direction_above_m_s);
  for (const auto i : members) {
    const auto reference = truth_at(truth, series.points[i].time);
    if (!reference) return std::nullopt;
    bin.mean += *reference;
    scorer.add(pair_with(std::get<WindEstimate>(series.points[i].wind), *reference));
  }
  if (members.empty()) return std::nullopt;
  bin.mean /= static_cast<double>(members.size());
  bin.scores = scorer.scores();
  return bin;
}

ScoredLeg score_leg(const estimator::WindSeries& series, const WindProfile& profile, const Leg& leg,
                    const ingest::Truth& truth, const CompareSettings& settings) {
  ScoredLeg scored{leg.name, {}, {}};
  Scorer scorer(settings.direction_above_m_s);
  const auto members = members_of(series, profile, leg.name);
  for (const auto& bin : leg.bins) {
    const auto* wind = std::get_if<WindEstimate>(&bin.wind);
    const auto found = members.find(std::lround(bin.bottom / profile.bin_m));
    if (!wind || found == members.end()) continue;
    auto reference = truth_of(series, found->second, truth, settings);
    if (!reference) continue;
    const bool inside = scorer.add(pair_with(*wind, reference->mean));
    scored.bins.push_back({bin.bottom, bin.top, found->second.size(), wind->v_NA_N, reference->mean, inside,
                           std::move(reference->scores)});
  }
  scored.scores = scorer.scores();
  return scored;
}

/// The truth's samples as points with times and heights, so that its legs can be found.
struct TruthCourse {
  std::vector<estimator::WindPoint> points;
  std::vector<std::optional<double>> heights;  ///< in the profile's datum
};
TruthCourse course_of(const ingest::Truth& truth, double datum_above_takeoff) {
  constexpr double standing = 0.5, highest = 1e5;
  TruthCourse course;
  for (const auto& t : truth) {
    estimator::WindPoint point;
    point.time = t.time;
    course.points.push_back(point);
    const bool flying = t.height.m >= standing && t.height.m <= highest;
    course.heights.push_back(flying ? std::optional(t.height.m + datum_above_takeoff) : std::nullopt);
  }
  add_climb_rates(course.points, course.heights);
  return course;
}

ScoredLeg score_leg(const WindProfile& profile, const Leg& leg, const ingest::Truth& truth, const TruthCourse& course,
                    const CompareSettings& settings) {
  ScoredLeg scored{leg.name, {}, {}};
  Scorer scorer(settings.direction_above_m_s);
  const auto members =
      members_of(course.points, course.heights, profile.bin_m, leg.name, [](std::size_t) { return true; });
  for (const auto& bin : leg.bins) {
    const auto* wind = std::get_if<WindEstimate>(&bin.wind);
    const auto found = members.find(std::lround(bin.bottom / profile.bin_m));
    if (!wind || found == members.end()) continue;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const auto i : found->second) mean += truth[i].v_NA_N.head<2>();
    mean /= static_cast<double>(found->second.size());
    const auto pair = pair_with(*wind, mean);
    const bool inside = scorer.add(pair);
    Scorer alone(settings.direction_above_m_s);
    alone.add(pair);
    scored.bins.push_back({bin.bottom, bin.top, found->second.size(), wind->v_NA_N, mean, inside, alone.scores()});
  }
  scored.scores = scorer.scores();
  return scored;
}

}  // namespace

std::optional<double> takeoff_in_datum(const WindProfile& profile) {
  if (profile.datum == Datum::agl) return 0;
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins)
      if (bin.height_agl && bin.height_msl) return bin.height_msl->m - bin.height_agl->m;
  return std::nullopt;
}

const Scores& TruthScores::whole() const {
  if (!by_height || legs.empty()) return samples;
  for (const auto& leg : legs)
    if (leg.name == LegName::all) return leg.scores;
  return legs.front().scores;
}

TruthScores score_against_truth(const estimator::WindSeries& series, const estimator::WindSeries* classic,
                                const WindProfile* profile, const ingest::Truth& truth,
                                const CompareSettings& settings) {
  TruthScores scores;
  scores.samples = score_samples(series, truth, 0, settings);
  // It starts at zero wind, so its first minute would be scored for that.
  if (classic) scores.classic = score_samples(*classic, truth, 60, settings);
  if (profile)
    for (const auto& leg : profile->legs) scores.legs.push_back(score_leg(series, *profile, leg, truth, settings));
  return scores;
}

TruthScores score_against_truth(const WindProfile& profile, const ingest::Truth& truth,
                                const CompareSettings& settings) {
  TruthScores scores;
  scores.by_height = true;
  const auto takeoff = takeoff_in_datum(profile);
  if (!takeoff || !(profile.bin_m > 0)) return scores;
  const auto course = course_of(truth, *takeoff);
  for (const auto& leg : profile.legs) scores.legs.push_back(score_leg(profile, leg, truth, course, settings));
  return scores;
}

}  // namespace quadsonde::profiles
