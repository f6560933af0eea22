#include "export/report/autopilot_wind.h"

#include <fmt/format.h>

#include <cmath>

#include "export/report/words.h"

namespace quadsonde::product {
namespace {

/// Without a covariance: neither the autopilots' nor a mean's is known.
estimator::WindEstimate plain(const Eigen::Vector2d& v_NA_N) { return {v_NA_N, Eigen::Matrix2d::Zero(), false}; }

Json json_wind(const Eigen::Vector2d& v_NA_N) {
  const auto report = estimator::to_report(plain(v_NA_N));
  return {{"wind_east_m_s", json_number(v_NA_N.y(), 3)},
          {"wind_north_m_s", json_number(v_NA_N.x(), 3)},
          {"wind_speed_m_s", json_number(report.speed_m_s, 3)},
          {"wind_from_deg", json_number(report.from_deg, 1)}};
}

}  // namespace

std::optional<AutopilotComparison> beside_autopilot(const ingest::Flight& flight, const estimator::WindSeries& ours) {
  constexpr double oldest_s = 2;
  const auto& told = flight.autopilot_wind;
  AutopilotComparison c;
  c.source = told.source;
  double squares = 0;
  for (const auto& point : ours.points) {
    const auto* wind = std::get_if<estimator::WindEstimate>(&point.wind);
    const auto at = ingest::last_at_or_before(told, point.time);
    if (!wind || at < 0) continue;
    const auto k = static_cast<std::size_t>(at);
    if (ingest::to_seconds(point.time - told.time[k]) > oldest_s) continue;
    ++c.instants;
    c.theirs += told.value[k].v_NA_N;
    c.ours += wind->v_NA_N;
    squares += (told.value[k].v_NA_N - wind->v_NA_N).squaredNorm();
  }
  if (c.instants == 0) return std::nullopt;
  const auto n = static_cast<double>(c.instants);
  c.theirs /= n, c.ours /= n;
  c.difference_rms = std::sqrt(squares / n);
  return c;
}

std::optional<Eigen::Vector2d> mean_autopilot_wind(const ingest::Flight& flight) {
  const auto& told = flight.autopilot_wind.value;
  if (told.empty()) return std::nullopt;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& wind : told) sum += wind.v_NA_N;
  return sum / static_cast<double>(told.size());
}

std::string autopilot_sentence(const AutopilotComparison& c) {
  return fmt::format(
      "The autopilot's own wind: {} on average; ours at the same instants: {}; they differ by {:.1f} m/s (rms of the "
      "vector). It is kept beside and never fed into ours.",
      wind_words(plain(c.theirs)), wind_words(plain(c.ours)), c.difference_rms);
}

Json json_autopilot(const std::optional<AutopilotComparison>& comparison) {
  if (!comparison) return nullptr;
  return {{"source", comparison->source},
          {"instants", comparison->instants},
          {"autopilot", json_wind(comparison->theirs)},
          {"quadsonde", json_wind(comparison->ours)},
          {"difference_rms_m_s", json_number(comparison->difference_rms, 3)}};
}

}  // namespace quadsonde::product
