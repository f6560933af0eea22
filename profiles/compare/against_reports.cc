#include "profiles/compare/against_reports.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "ingest/flight/local_frame.h"
#include "profiles/bin_statistics.h"

namespace quadsonde::profiles {
namespace {

using estimator::WindEstimate;
using ingest::GroundHeight;
using ingest::Kind;
using ingest::Problem;
using ingest::ReferenceWind;
using ingest::UtcTime;

constexpr double mean_s = 600;  ///< of a report
constexpr double standard_height = 10;
constexpr double level_half_m = 5;  ///< samples so near to a height belong to it
constexpr double layer_m = 10;
constexpr double structure_per_component = 1.8e-3;  ///< [m^(4/3) s^-2]

/// Our wind at one height over one span of time.
struct Mean {
  WindEstimate wind;
  GroundHeight height;
  UtcTime utc;
  std::size_t samples = 0;
};
struct Span {
  UtcTime from, to;
};

/// Any two instants: centuries apart, their difference would not fit into nanoseconds.
double seconds_between(UtcTime a, UtcTime b) { return (static_cast<double>(b.ns) - static_cast<double>(a.ns)) * 1e-9; }
double height_of(const ReferenceWind& report) { return report.height ? report.height->m : standard_height; }

/// What a flight can be asked for: over which time it has winds at heights above ground, where, and its mean wind
/// nearest to a height within a span of time.
class Winds {
 public:
  virtual ~Winds() = default;
  virtual std::optional<Mean> near(double height, Span span) const = 0;

  bool has_wind = false, has_height = false, has_utc = false;
  std::optional<Span> flown;
  std::optional<ingest::GeoPoint> place;

 protected:
  /// @return whether the wind at this place and time can be matched
  bool note(bool wind, const std::optional<GroundHeight>& height, const std::optional<UtcTime>& utc,
            const std::optional<ingest::GeoPoint>& at) {
    if (!wind) return false;
    has_wind = true;
    has_height |= height.has_value();
    has_utc |= utc.has_value();
    if (at && !place) place = at;
    if (!height || !utc) return false;
    flown = flown ? Span{std::min(flown->from, *utc), std::max(flown->to, *utc)} : Span{*utc, *utc};
    return true;
  }
};

class SeriesWinds : public Winds {
 public:
  explicit SeriesWinds(const estimator::WindSeries& series) : series_(series) {
    for (std::size_t i = 0; i < series.points.size(); ++i) {
      const auto& p = series.points[i];
      if (note(std::holds_alternative<WindEstimate>(p.wind), p.height_agl, p.utc, p.place)) usable_.push_back(i);
    }
  }

  std::optional<Mean> near(double height, Span span) const override {
    std::optional<double> nearest;
    std::vector<std::size_t> in_time;
    for (const auto i : usable_) {
      const auto& p = series_.points[i];
      if (*p.utc < span.from || span.to < *p.utc) continue;
      in_time.push_back(i);
      if (!nearest || std::abs(p.height_agl->m - height) < std::abs(*nearest - height)) nearest = p.height_agl->m;
    }
    if (!nearest) return std::nullopt;
    const double centre = std::abs(*nearest - height) <= level_half_m ? height : *nearest;
    std::erase_if(in_time,
                  [&](std::size_t i) { return std::abs(series_.points[i].height_agl->m - centre) > level_half_m; });
    return mean_of(in_time);
  }

 private:
  Mean mean_of(const std::vector<std::size_t>& members) const {
    Mean mean;
    const auto bin = bin_mean(series_, members);
    mean.samples = members.size();
    const auto first = *series_.points[members.front()].utc;
    double height = 0, time = 0;
    for (const auto i : members) {
      height += series_.points[i].height_agl->m;
      time += seconds_between(first, *series_.points[i].utc);
    }
    mean.height.m = height / static_cast<double>(members.size());
    mean.utc = first + ingest::seconds(time / static_cast<double>(members.size()));
    mean.wind.v_NA_N = bin.wind;
    mean.wind.has_covariance = series_.mode != estimator::Mode::classic;
    mean.wind.covariance = bin.noise;
    if (series_.trace)
      mean.wind.covariance +=
          bin.trim_part() + bin.per_parameter * series_.trace->consider * bin.per_parameter.transpose();
    const double time_u = series_.trace ? series_.trace->turbulence_time : 10;
    mean.wind.covariance += sampling_variance(turbulence(members), time_u, bin.seconds) * Eigen::Matrix2d::Identity();
    return mean;
  }

  /// That of the flight; where it is not told, the scatter of these samples.
  double turbulence(const std::vector<std::size_t>& members) const {
    if (series_.diagnostics.sigma_u > 0) return series_.diagnostics.sigma_u;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double squares = 0;
    for (const auto i : members) {
      const auto& w = std::get<WindEstimate>(series_.points[i].wind).v_NA_N;
      sum += w, squares += w.squaredNorm();
    }
    const auto n = static_cast<double>(members.size());
    return std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm()) / 2);
  }

  const estimator::WindSeries& series_;
  std::vector<std::size_t> usable_;
};

class ProfileWinds : public Winds {
 public:
  explicit ProfileWinds(const WindProfile& profile) {
    const Leg* leg = profile.legs.empty() ? nullptr : &profile.legs.front();
    for (const auto& l : profile.legs)
      if (l.name == LegName::all) leg = &l;
    if (!leg) return;
    for (const auto& bin : leg->bins)
      if (note(std::holds_alternative<WindEstimate>(bin.wind), bin.height_agl, bin.utc, bin.place))
        usable_.push_back(&bin);
  }

  std::optional<Mean> near(double height, Span span) const override {
    const Bin* nearest = nullptr;
    for (const auto* bin : usable_) {
      if (*bin->utc < span.from || span.to < *bin->utc) continue;
      if (!nearest || std::abs(bin->height_agl->m - height) < std::abs(nearest->height_agl->m - height)) nearest = bin;
    }
    if (!nearest) return std::nullopt;
    Mean mean{std::get<WindEstimate>(nearest->wind), *nearest->height_agl, *nearest->utc, nearest->samples};
    const double sampling = nearest->sd_sampling.value_or(0);
    mean.wind.covariance += sampling * sampling * Eigen::Matrix2d::Identity();
    return mean;
  }

 private:
  std::vector<const Bin*> usable_;
};

/// From the report's ten minutes to the flight [s]: negative where the report is earlier, 0 where they meet.
double gap(UtcTime report, Span flight) {
  const double early = seconds_between(report, flight.from), late = seconds_between(flight.to, report) - mean_s;
  return early > 0 ? -early : std::max(0.0, late);
}

/// What place and time add per component.
double representativeness(const std::optional<double>& distance, double time_s, double speed) {
  const double r = std::hypot(distance.value_or(0), speed * time_s);
  return std::sqrt(structure_per_component * std::pow(r, 2.0 / 3));
}

/// Covariance of a report's vector by its rounding or range.
Eigen::Matrix2d rounding(const ReferenceWind& report, const std::optional<Eigen::Vector2d>& vector) {
  const double along = report.speed_sd * report.speed_sd;
  if (!vector || vector->norm() <= 0) return along * Eigen::Matrix2d::Identity();
  const double sd_across = vector->norm() * report.from_sd_deg * std::numbers::pi / 180;
  const Eigen::Vector2d t = vector->normalized(), s(-t.y(), t.x());
  return along * t * t.transpose() + sd_across * sd_across * s * s.transpose();
}

/// N and E; nothing for a wind without a direction, zero for a calm.
std::optional<Eigen::Vector2d> vector_of(const ReferenceWind& report) {
  if (report.calm) return Eigen::Vector2d::Zero();
  if (!report.from_deg) return std::nullopt;
  const double toward = (*report.from_deg + 180) * std::numbers::pi / 180;
  return Eigen::Vector2d(std::cos(toward), std::sin(toward)) * *report.speed();
}

struct Candidate {
  const ReferenceWind* report = nullptr;
  double gap_s = 0;
  std::optional<double> distance_m;
  bool far() const { return distance_m && *distance_m > longest_distance_m; }
  bool late() const { return std::abs(gap_s) > longest_gap_s; }
};

std::optional<MatchedReport> match(const Winds& winds, const Candidate& c, bool outside_window,
                                   const CompareSettings& settings) {
  const auto& report = *c.report;
  const auto window = ingest::seconds(settings.match_window_s);
  const auto period = ingest::seconds(mean_s);
  const Span span = outside_window ? *winds.flown : Span{report.utc + (-period - window), report.utc + window};
  const auto ours = winds.near(height_of(report), span);
  if (!ours) return std::nullopt;
  MatchedReport m{report, ours->wind, ours->height, ours->utc, ours->samples, c.gap_s, c.distance_m, 0, {}};
  const double speed = ours->wind.v_NA_N.norm();
  const double apart = seconds_between(report.utc, ours->utc) + mean_s / 2;
  m.representativeness_m_s = settings.representativeness_m_s.value_or(
      representativeness(c.distance_m, apart, std::max(speed, *report.speed())));
  m.pair = {ours->wind.v_NA_N, *report.speed_min, *report.speed_max, vector_of(report), std::nullopt};
  if (ours->wind.has_covariance)
    m.pair.covariance = ours->wind.covariance + rounding(report, m.pair.reference) +
                        m.representativeness_m_s * m.representativeness_m_s * Eigen::Matrix2d::Identity();
  return m;
}

std::string gap_words(double gap_s) {
  const double minutes = std::abs(gap_s) / 60;
  const auto length = minutes < 120    ? fmt::format("{:.0f} min", minutes)
                      : minutes < 2880 ? fmt::format("{:.1f} h", minutes / 60)
                                       : fmt::format("{:.0f} days", minutes / 1440);
  return length + (gap_s < 0 ? " before" : " after");
}

/// Why nothing of a reference can be scored for this flight, or nothing.
std::optional<Problem> obstacle(const Winds& winds, const std::vector<Candidate>& candidates) {
  const auto say = [](Kind kind, std::string what, std::string hint) {
    return Problem{kind, std::move(what), {}, std::move(hint)};
  };
  if (!winds.has_wind)
    return say(Kind::no_answer, "there is no wind to compare with it", "see the reasons in its rows");
  if (!winds.has_utc)
    return say(Kind::missing, "the flight's clock was never set to UTC, so reports in UTC cannot be matched with it",
               "make it again with --start-utc T, or log the time of the GNSS receiver");
  if (!winds.has_height)
    return say(Kind::missing,
               "the flight's height above ground is not known, so reports of a station cannot be matched",
               "make it again with --takeoff-msl M");
  if (!winds.flown) return say(Kind::missing, "no wind of the flight has both a height above ground and UTC", "");
  if (candidates.empty()) return say(Kind::missing, "the reference holds no report of a wind", "give one with winds");
  const auto nearest = std::min_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return std::pair(a.far(), std::abs(a.gap_s)) < std::pair(b.far(), std::abs(b.gap_s));
  });
  const auto at = ingest::to_iso8601(nearest->report->utc, 0);
  if (nearest->far())
    return say(Kind::no_answer,
               fmt::format("its place is {:.0f} km from the flight: nothing is scored beyond 50 km",
                           *nearest->distance_m / 1000),
               "give a station nearer to the flight");
  if (nearest->late())
    return say(
        Kind::no_answer,
        fmt::format("the report nearest in time, {}, is {} the flight ({} to {}{}): nothing is scored beyond 3 h", at,
                    gap_words(nearest->gap_s), ingest::to_iso8601(winds.flown->from, 0),
                    ingest::to_iso8601(winds.flown->to, 0),
                    nearest->distance_m ? fmt::format(", {:.1f} km away", *nearest->distance_m / 1000) : ""),
        "give reports of that day and hour");
  return std::nullopt;
}

std::vector<Candidate> candidates_of(const Winds& winds, const ingest::Reference& reference) {
  std::vector<Candidate> all;
  for (const auto& report : reference.records) {
    if (!report.speed_min || !report.speed_max) continue;
    Candidate c{&report, winds.flown ? gap(report.utc, *winds.flown) : 0, std::nullopt};
    if (winds.place && report.place) c.distance_m = ingest::distance_m(*winds.place, *report.place);
    all.push_back(c);
  }
  return all;
}

ReportScores score(const Winds& winds, const ingest::Reference& reference, const CompareSettings& settings) {
  ReportScores result;
  result.records = reference.records.size();
  auto candidates = candidates_of(winds, reference);
  for (const auto& c : candidates) {
    if (!winds.flown) break;
    if (!result.nearest_gap_s || std::abs(c.gap_s) < std::abs(*result.nearest_gap_s)) result.nearest_gap_s = c.gap_s;
    if (c.distance_m && (!result.nearest_distance_m || *c.distance_m < *result.nearest_distance_m))
      result.nearest_distance_m = c.distance_m;
  }
  result.no_score = obstacle(winds, candidates);
  if (result.no_score) return result;

  std::erase_if(candidates, [](const Candidate& c) { return c.far() || c.late(); });
  double least = longest_gap_s;
  for (const auto& c : candidates) least = std::min(least, std::abs(c.gap_s));
  result.outside_window = least > settings.match_window_s;
  const double limit = result.outside_window ? least : settings.match_window_s;
  Scorer scorer(settings.direction_above_m_s);
  std::map<long, Scorer> layers;
  for (const auto& c : candidates) {
    if (std::abs(c.gap_s) > limit) continue;
    const auto matched = match(winds, c, result.outside_window, settings);
    if (!matched) continue;
    scorer.add(matched->pair);
    const auto layer = static_cast<long>(std::floor(height_of(*c.report) / layer_m));
    layers.try_emplace(layer, settings.direction_above_m_s).first->second.add(matched->pair);
    result.pairs.push_back(*matched);
  }
  result.scores = scorer.scores();
  for (const auto& [layer, scores] : layers) {
    const double bottom = static_cast<double>(layer) * layer_m;
    result.layers.push_back({bottom, bottom + layer_m, scores.scores()});
  }
  if (result.pairs.empty())
    result.no_score = Problem{Kind::no_answer,
                              "no instant of the flight with a wind falls into the time of a report",
                              {},
                              "widen it with --match-window-s"};
  return result;
}

}  // namespace

ReportScores score_against_reports(const estimator::WindSeries& series, const ingest::Reference& reference,
                                   const CompareSettings& settings) {
  return score(SeriesWinds(series), reference, settings);
}

ReportScores score_against_reports(const WindProfile& profile, const ingest::Reference& reference,
                                   const CompareSettings& settings) {
  return score(ProfileWinds(profile), reference, settings);
}

}  // namespace quadsonde::profiles
