#include "export/report/state_picture.h"

#include <algorithm>
#include <cmath>

#include "export/report/series_curves.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using estimator::WindPoint;
using estimator::WindSeries;

constexpr double picture_height = 800;
constexpr double first_top = 92, panel_height = 142, panel_distance = 174;

/// Component i (0 north, 1 east) of the wind, with its band.
ReadWind wind_component(int i) {
  return [i](const WindPoint&, const WindEstimate& wind) -> std::optional<TimeValue> {
    return TimeValue{0, wind.v_NA_N(i), wind.has_covariance ? 1.96 * std::sqrt(wind.covariance(i, i)) : 0};
  };
}

ReadWind airspeed_component(int i) {
  return [i](const WindPoint& point, const WindEstimate&) -> std::optional<TimeValue> {
    if (!point.v_AB_N) return std::nullopt;
    return TimeValue{0, (*point.v_AB_N)(i), 0};
  };
}

TimeCurve measured_component(const ingest::Stream<Eigen::Vector3d>* velocity, ingest::LogTime start,
                             ingest::LogTime end, int i) {
  if (!velocity) return {};
  const auto first = std::lower_bound(velocity->time.begin(), velocity->time.end(), start) - velocity->time.begin();
  const auto last = std::upper_bound(velocity->time.begin(), velocity->time.end(), end) - velocity->time.begin();
  return time_curve(static_cast<std::size_t>(last - first), [&](std::size_t k) -> std::optional<TimeValue> {
    const auto at = static_cast<std::size_t>(first) + k;
    return TimeValue{ingest::to_seconds(velocity->time[at] - start), velocity->value[at](i), 0};
  });
}

/// The curves of one panel, in the order in which they are drawn.
using Drawn = std::vector<std::pair<TimeCurve, Pen>>;

void draw_panel(Markup& svg, const TimeAxis& time, int number, std::string_view title, const Drawn& drawn,
                const std::string& id) {
  std::vector<const TimeCurve*> curves;
  for (const auto& [curve, pen] : drawn) curves.push_back(&curve);
  const auto range = value_range(curves, 1.5).value_or(std::pair(-1.0, 1.0));
  const double spare = std::max(0.0, 0.5 - (range.second - range.first) / 2);
  const double top = first_top + panel_distance * number;
  const auto y = round_axis(range.first - spare, range.second + spare, top + panel_height, top, 4);
  const auto clip = id + "-" + std::to_string(number);
  draw_time_frame(
      svg, time, y, title, [&](double t) { return y.label(t); }, number == 3);
  define_time_clip(svg, y, clip);
  for (const auto& [curve, pen] : drawn) draw_time_curve(svg, time, y, curve, pen, clip);
}

}  // namespace

std::string state_svg(const WindSeries& series, const StatePicture& picture) {
  Markup svg;
  {
    const auto root = open_time_picture(svg, picture_height, "State along the flight", picture.title);
    const auto [start, end] = span_of(series);
    const TimeAxis time(ingest::to_seconds(end - start));
    auto legend = std::vector{legend_of_ours(series)};
    const auto ours = legend.front().second;
    if (series.mode != estimator::Mode::classic) legend.front().first = "ours (" + std::string(name(series.mode)) + ")";
    if (picture.classic) legend.emplace_back("classic filter", pens::classic);
    if (picture.velocity) legend.emplace_back("measured over ground", pens::measured);
    if (!picture.reference.empty()) legend.emplace_back(picture.reference_name, pens::reference);
    draw_pen_legend(svg, time_plot_left, 60, legend);
    for (int i = 0; i < 2; ++i) {
      Drawn air{{measured_component(picture.velocity, start, end, i), pens::measured}};
      Drawn wind;
      if (picture.classic) air.emplace_back(curve_of(*picture.classic, start, airspeed_component(i)), pens::classic);
      if (picture.classic) wind.emplace_back(curve_of(*picture.classic, start, wind_component(i)), pens::classic);
      air.emplace_back(curve_of(series, start, airspeed_component(i)), ours);
      wind.emplace_back(curve_of(series, start, wind_component(i)), ours);
      wind.emplace_back(curve_of(picture.reference, start, end, [i](const Eigen::Vector2d& w) { return w(i); }),
                        pens::reference);
      draw_panel(svg, time, i, i ? "airspeed east (m/s)" : "airspeed north (m/s)", air, picture.id);
      draw_panel(svg, time, 2 + i, i ? "wind toward east (m/s)" : "wind toward north (m/s)", wind, picture.id);
    }
  }
  return svg.str();
}

}  // namespace quadsonde::product
