#include "export/report/series_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "export/report/series_curves.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using estimator::WindPoint;
using estimator::WindSeries;

constexpr double picture_height = 560;
/// A reference has no uncertainty of its own here; below this its direction means nothing [m/s].
constexpr double calm = 0.5;

struct Curves {
  TimeCurve height;
  TimeCurve speed, from;
  TimeCurve classic_speed, classic_from;
  TimeCurve true_speed, true_from;
};

std::optional<TimeValue> height_of(const WindPoint& p, const WindEstimate&) {
  if (p.height_agl) return TimeValue{0, p.height_agl->m, 0};
  if (p.height_msl) return TimeValue{0, p.height_msl->m, 0};
  return std::nullopt;
}

std::optional<TimeValue> speed_of(const WindPoint&, const WindEstimate& wind) {
  return TimeValue{0, estimator::to_report(wind).speed_m_s, wind.has_covariance ? 1.96 * estimator::speed_sd(wind) : 0};
}

ReadWind direction_around(double around) {
  return [around](const WindPoint&, const WindEstimate& wind) -> std::optional<TimeValue> {
    const auto from = estimator::to_report(wind).from_deg;
    if (!from) return std::nullopt;
    const auto sd = wind.has_covariance ? estimator::direction_sd_deg(wind) : std::nullopt;
    return TimeValue{0, unwrapped(*from, around), 1.96 * sd.value_or(0)};
  };
}

double from_degrees(const Eigen::Vector2d& toward) {
  return std::atan2(-toward.y(), -toward.x()) * 180 / std::numbers::pi;
}

double mean_direction(const WindSeries& series) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& point : series.points)
    if (const auto* wind = std::get_if<WindEstimate>(&point.wind)) sum += wind->v_NA_N;
  return sum.norm() > 0 ? from_degrees(sum) : 180;
}

Curves curves_of(const WindSeries& series, const SeriesPicture& picture) {
  const auto [start, end] = span_of(series);
  const double around = mean_direction(series);
  Curves c{curve_of(series, start, height_of),
           curve_of(series, start, speed_of),
           curve_of(series, start, direction_around(around)),
           {},
           {},
           {},
           {}};
  if (picture.classic) {
    c.classic_speed = curve_of(*picture.classic, start, speed_of);
    c.classic_from = curve_of(*picture.classic, start, direction_around(around));
  }
  c.true_speed = curve_of(picture.reference, start, end, [](const Eigen::Vector2d& w) { return w.norm(); });
  c.true_from = curve_of(picture.reference, start, end, [around](const Eigen::Vector2d& w) -> std::optional<double> {
    if (w.norm() < calm) return std::nullopt;
    return unwrapped(from_degrees(w), around);
  });
  return c;
}

Axis speed_axis(const Curves& c, double from, double to) {
  const auto ours = value_range({&c.speed, &c.classic_speed, &c.true_speed}, 3);
  return round_axis(0, ours ? std::max(ours->second, 1.0) : 1, from, to, 4);
}

Axis height_axis(const Curves& c, bool agl, double from, double to) {
  const auto range = value_range({&c.height}, 0).value_or(std::pair(0.0, 1.0));
  // Above take-off the ground is worth its place; above the sea it may be far below.
  const double low = agl ? (range.first > -2 ? 0 : range.first) : std::min(range.first, range.second - 4);
  return round_axis(low, std::max(range.second, low + 1), from, to, 4);
}

/// Around what is shown, ours first: a filter that turns about a calm must not press the rest together.
Axis direction_axis(const Curves& c, double from, double to) {
  auto range = value_range({&c.from, &c.true_from}, 25);
  if (!range) range = value_range({&c.classic_from}, 25).value_or(std::pair(160.0, 200.0));
  const double spare = std::max(0.0, 20 - (range->second - range->first) / 2);
  return angle_axis(range->first - spare, range->second + spare, from, to, 4);
}

void draw_panels(Markup& svg, const Curves& c, double last, const SeriesPicture& picture, const Pen& ours, bool agl) {
  const TimeAxis time(last);
  const auto heights = height_axis(c, agl, 172, 86), speeds = speed_axis(c, 338, 204);
  const auto directions = direction_axis(c, 504, 370);
  const auto number = [](const Axis& axis) { return [&axis](double t) { return axis.label(t); }; };
  draw_time_frame(svg, time, heights, agl ? "height above take-off (m)" : "height above mean sea level (m)",
                  number(heights), false);
  draw_time_frame(svg, time, speeds, "wind speed (m/s)", number(speeds), false);
  draw_time_frame(svg, time, directions, "wind from (degrees, true north)", direction_label, true);
  const auto clip = [&](const char* name) { return picture.id + name; };
  define_time_clip(svg, heights, clip("-height"));
  define_time_clip(svg, speeds, clip("-speed"));
  define_time_clip(svg, directions, clip("-from"));
  draw_time_curve(svg, time, heights, c.height, {colour::grey, 1.6, "", false}, clip("-height"));
  draw_time_curve(svg, time, speeds, c.classic_speed, pens::classic, clip("-speed"));
  draw_time_curve(svg, time, speeds, c.speed, ours, clip("-speed"));
  draw_time_curve(svg, time, speeds, c.true_speed, pens::reference, clip("-speed"));
  draw_time_curve(svg, time, directions, c.classic_from, pens::classic, clip("-from"), 180);
  draw_time_curve(svg, time, directions, c.from, ours, clip("-from"), 180);
  draw_time_curve(svg, time, directions, c.true_from, pens::reference, clip("-from"), 180);
}

}  // namespace

std::string series_svg(const WindSeries& series, const SeriesPicture& picture) {
  Markup svg;
  {
    const auto root = open_time_picture(svg, picture_height, "Wind along the flight", picture.title);
    const auto [start, end] = span_of(series);
    const auto curves = curves_of(series, picture);
    const bool agl =
        std::any_of(series.points.begin(), series.points.end(), [](const auto& p) { return p.height_agl.has_value(); });
    auto legend = std::vector{legend_of_ours(series)};
    if (!curves.classic_speed.empty()) legend.emplace_back("classic filter", pens::classic);
    if (!curves.true_speed.empty()) legend.emplace_back(picture.reference_name, pens::reference);
    draw_pen_legend(svg, time_plot_left, 60, legend);
    draw_panels(svg, curves, ingest::to_seconds(end - start), picture, legend.front().second, agl);
  }
  return svg.str();
}

}  // namespace quadsonde::product
