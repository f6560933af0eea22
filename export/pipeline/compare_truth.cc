#include "export/pipeline/compare_truth.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/version.h"
#include "profiles/legs.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using Members = std::map<long, std::vector<std::size_t>>;  ///< bin number -> points

constexpr double interval95 = 1.96;

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

class Scorer {
 public:
  /// @return whether both components lie in their 95 % intervals
  bool add(const WindEstimate& ours, const Eigen::Vector2d& reference) {
    const Eigen::Vector2d e = ours.v_NA_N - reference;
    const double speed = ours.v_NA_N.norm() - reference.norm();
    ++s_.n;
    s_.bias_north += e.x(), s_.bias_east += e.y(), s_.bias_speed += speed;
    s_.rmse_north += e.x() * e.x(), s_.rmse_east += e.y() * e.y(), s_.rmse_speed += speed * speed;
    add_direction(ours, reference);
    return ours.has_covariance ? add_interval(e, ours.covariance) : true;
  }

  Scores scores() const {
    Scores s = s_;
    if (s.n == 0) return s;
    const auto n = static_cast<double>(s.n);
    s.rmsve = std::sqrt((s.rmse_north + s.rmse_east) / n);
    for (double* sum : {&s.bias_north, &s.bias_east, &s.bias_speed}) *sum /= n;
    for (double* sum : {&s.rmse_north, &s.rmse_east, &s.rmse_speed}) *sum = std::sqrt(*sum / n);
    if (s.n_direction) {
      s.bias_direction = direction_sum_ / static_cast<double>(s.n_direction);
      s.rms_direction = std::sqrt(direction_squares_ / static_cast<double>(s.n_direction));
    }
    if (intervals_) s.inside95 = static_cast<double>(inside_) / static_cast<double>(2 * intervals_);
    if (intervals_) s.normalised_error = normalised_ / static_cast<double>(2 * intervals_);
    return s;
  }

 private:
  void add_direction(const WindEstimate& ours, const Eigen::Vector2d& reference) {
    if (!estimator::to_report(ours).from_deg || reference.norm() < 0.5) return;
    const auto& w = ours.v_NA_N;
    const double cross = reference.x() * w.y() - reference.y() * w.x();
    const double error = std::atan2(cross, reference.dot(w)) * 180 / std::numbers::pi;
    ++s_.n_direction;
    direction_sum_ += error, direction_squares_ += error * error;
  }

  bool add_interval(const Eigen::Vector2d& e, const Eigen::Matrix2d& covariance) {
    const bool north = std::abs(e.x()) <= interval95 * std::sqrt(covariance(0, 0));
    const bool east = std::abs(e.y()) <= interval95 * std::sqrt(covariance(1, 1));
    ++intervals_;
    inside_ += static_cast<std::size_t>(north) + static_cast<std::size_t>(east);
    if (covariance.determinant() > 0) normalised_ += e.dot(covariance.inverse() * e);
    return north && east;
  }

  Scores s_;
  double direction_sum_ = 0, direction_squares_ = 0, normalised_ = 0;
  std::size_t intervals_ = 0, inside_ = 0;
};

Scores score_samples(const estimator::WindSeries& series, const ingest::Truth& truth, double skip_s) {
  Scorer scorer;
  for (const auto& p : series.points) {
    if (ingest::to_seconds(p.time - series.points.front().time) < skip_s) continue;
    const auto* wind = std::get_if<WindEstimate>(&p.wind);
    const auto reference = truth_at(truth, p.time);
    if (wind && reference) scorer.add(*wind, *reference);
  }
  return scorer.scores();
}

/// The points of every bin of a leg, found as make_profile finds them.
Members members_of(const estimator::WindSeries& series, const profiles::WindProfile& profile, profiles::LegName leg) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : series.points) {
    const bool agl = profile.datum == profiles::Datum::agl;
    const auto height = agl ? (p.height_agl ? std::optional(p.height_agl->m) : std::nullopt)
                            : (p.height_msl ? std::optional(p.height_msl->m) : std::nullopt);
    heights.push_back(height);
  }
  const auto parts = profiles::find_parts(series.points, heights, profile.bin_m / 2);
  Members members;
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    if (!heights[i] || !std::holds_alternative<WindEstimate>(series.points[i].wind)) continue;
    const bool fits = leg == profiles::LegName::all ||
                      parts[i] == (leg == profiles::LegName::up ? profiles::Part::up : profiles::Part::down);
    if (fits) members[static_cast<long>(std::floor(*heights[i] / profile.bin_m))].push_back(i);
  }
  return members;
}

std::optional<Eigen::Vector2d> mean_truth(const estimator::WindSeries& series, const std::vector<std::size_t>& members,
                                          const ingest::Truth& truth) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto i : members) {
    const auto reference = truth_at(truth, series.points[i].time);
    if (!reference) return std::nullopt;
    sum += *reference;
  }
  if (members.empty()) return std::nullopt;
  return sum / static_cast<double>(members.size());
}

ScoredLeg score_leg(const estimator::WindSeries& series, const profiles::WindProfile& profile, const profiles::Leg& leg,
                    const ingest::Truth& truth) {
  ScoredLeg scored{leg.name, {}, {}};
  Scorer scorer;
  const auto members = members_of(series, profile, leg.name);
  for (const auto& bin : leg.bins) {
    const auto* wind = std::get_if<WindEstimate>(&bin.wind);
    const auto found = members.find(std::lround(bin.bottom / profile.bin_m));
    if (!wind || found == members.end()) continue;
    const auto reference = mean_truth(series, found->second, truth);
    if (!reference) continue;
    const bool inside = scorer.add(*wind, *reference);
    scored.bins.push_back({bin.bottom, bin.top, found->second.size(), wind->v_NA_N, *reference, inside});
  }
  scored.scores = scorer.scores();
  return scored;
}

std::vector<ReferenceLevel> truth_levels(const estimator::WindSeries& series, const profiles::WindProfile& profile,
                                         const ingest::Truth& truth) {
  std::vector<ReferenceLevel> levels;
  for (const auto& [bin, members] : members_of(series, profile, profiles::LegName::all))
    if (const auto mean = mean_truth(series, members, truth))
      levels.push_back({(static_cast<double>(bin) + 0.5) * profile.bin_m, *mean});
  return levels;
}

Json scores_json(const Scores& s) {
  Json object = {{"n", s.n}};
  if (!s.n) return object;
  object["bias_east_m_s"] = json_number(s.bias_east, 4);
  object["bias_north_m_s"] = json_number(s.bias_north, 4);
  object["bias_speed_m_s"] = json_number(s.bias_speed, 4);
  object["rmse_east_m_s"] = json_number(s.rmse_east, 4);
  object["rmse_north_m_s"] = json_number(s.rmse_north, 4);
  object["rmse_speed_m_s"] = json_number(s.rmse_speed, 4);
  object["rmsve_m_s"] = json_number(s.rmsve, 4);
  object["n_direction"] = s.n_direction;
  object["bias_direction_deg"] = json_number(s.bias_direction, 2);
  object["rms_direction_deg"] = json_number(s.rms_direction, 2);
  object["inside95"] = json_number(s.inside95, 4);
  object["normalised_error"] = json_number(s.normalised_error, 4);
  return object;
}

}  // namespace

TruthComparison compare_with_truth(const estimator::WindSeries& series, const estimator::WindSeries* classic,
                                   const profiles::WindProfile* profile, const ingest::Truth& truth) {
  TruthComparison comparison;
  comparison.samples = score_samples(series, truth, 0);
  // It starts at zero wind, so its first minute would be scored for that.
  if (classic) comparison.classic = score_samples(*classic, truth, 60);
  if (profile) {
    for (const auto& leg : profile->legs) comparison.legs.push_back(score_leg(series, *profile, leg, truth));
    comparison.levels = truth_levels(series, *profile, truth);
  }
  return comparison;
}

std::vector<std::string> comparison_sentences(const TruthComparison& comparison) {
  std::vector<std::string> all;
  const auto& s = comparison.samples;
  if (s.n == 0) return {"The reference has no instant in common with the flight: nothing could be compared."};
  const auto share = [](const Scores& scores) {
    return scores.inside95 ? fmt::format(", {:.0f} % of the 95 % intervals hold it", 100 * *scores.inside95)
                           : std::string();
  };
  all.push_back(fmt::format("Every instant ({}): vector error {:.2f} m/s rms, speed {:+.2f} m/s on average{}.", s.n,
                            s.rmsve, s.bias_speed, share(s)));
  for (const auto& leg : comparison.legs) {
    if (!leg.scores.n) continue;
    const char* name = leg.name == profiles::LegName::up     ? "Ascent"
                       : leg.name == profiles::LegName::down ? "Descent"
                                                             : "Whole flight";
    auto text = fmt::format("{}, {} bins: vector error {:.2f} m/s rms, speed {:+.2f} m/s on average", name,
                            leg.scores.n, leg.scores.rmsve, leg.scores.bias_speed);
    if (leg.scores.rms_direction) text += fmt::format(", direction {:.1f} degrees rms", *leg.scores.rms_direction);
    all.push_back(text + share(leg.scores) + ".");
  }
  if (comparison.classic && comparison.classic->n)
    all.push_back(
        fmt::format("The published four-state filter on the same flight, after 60 s: vector error {:.2f} m/s rms.",
                    comparison.classic->rmsve));
  return all;
}

std::string comparison_json(const TruthComparison& comparison, const std::string& file, int flight) {
  Json object = {{"schema", "quadsonde.compare/1"}, {"version", std::string(version())}};
  object["source"] = {{"file", file}, {"flight", flight}};
  Json reference = {{"file", comparison.file}, {"kind", "truth"}, {"samples", scores_json(comparison.samples)}};
  if (comparison.classic) reference["classic_after_60_s"] = scores_json(*comparison.classic);
  Json legs = Json::array();
  for (const auto& leg : comparison.legs) {
    Json layers = Json::array();
    for (const auto& b : leg.bins)
      layers.push_back({{"bin_bottom_m", json_number(b.bottom, 2)},
                        {"bin_top_m", json_number(b.top, 2)},
                        {"samples", b.samples},
                        {"wind_east_m_s", json_number(b.ours.y(), 4)},
                        {"wind_north_m_s", json_number(b.ours.x(), 4)},
                        {"reference_east_m_s", json_number(b.reference.y(), 4)},
                        {"reference_north_m_s", json_number(b.reference.x(), 4)},
                        {"inside95", b.inside95}});
    legs.push_back(
        {{"leg", std::string(profiles::name(leg.name))}, {"scores", scores_json(leg.scores)}, {"layers", layers}});
  }
  reference["legs"] = std::move(legs);
  object["references"] = Json::array({reference});
  return json_text(object);
}

}  // namespace quadsonde::product
