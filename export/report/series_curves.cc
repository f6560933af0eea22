#include "export/report/series_curves.h"

#include <fmt/format.h>

#include <algorithm>

namespace quadsonde::product {

using estimator::WindEstimate;
using estimator::WindSeries;

TimeCurve curve_of(const WindSeries& series, ingest::LogTime start, const ReadWind& read) {
  return time_curve(series.points.size(), [&](std::size_t i) -> std::optional<TimeValue> {
    const auto& point = series.points[i];
    const auto* wind = std::get_if<WindEstimate>(&point.wind);
    if (!wind) return std::nullopt;
    auto value = read(point, *wind);
    if (value) value->seconds = ingest::to_seconds(point.time - start);
    return value;
  });
}

TimeCurve curve_of(const std::vector<ReferencePoint>& reference, ingest::LogTime start, ingest::LogTime end,
                   const std::function<std::optional<double>(const Eigen::Vector2d&)>& read) {
  const auto before = [](const ReferencePoint& a, ingest::LogTime t) { return a.time < t; };
  const auto first = std::lower_bound(reference.begin(), reference.end(), start, before);
  const auto last = std::lower_bound(first, reference.end(), end, before);
  return time_curve(static_cast<std::size_t>(last - first), [&](std::size_t i) -> std::optional<TimeValue> {
    const auto& point = first[static_cast<std::ptrdiff_t>(i)];
    const auto value = read(point.v_NA_N);
    if (!value) return std::nullopt;
    return TimeValue{ingest::to_seconds(point.time - start), *value, 0};
  });
}

std::pair<ingest::LogTime, ingest::LogTime> span_of(const WindSeries& series) {
  if (series.points.empty()) return {};
  return {series.points.front().time, series.points.back().time};
}

std::pair<std::string, Pen> legend_of_ours(const WindSeries& series) {
  if (series.mode != estimator::Mode::classic)
    return {fmt::format("wind ({}) with 95 % interval", estimator::name(series.mode)), pens::ours};
  auto pen = pens::ours;
  pen.band = false;
  return {"wind (classic filter)", pen};
}

Markup::Scope open_time_picture(Markup& svg, double height, std::string_view heading, const FlightTitle& title) {
  constexpr double width = 900;
  auto root = open_picture(svg, width, height);
  svg.leaf("title", fmt::format("{} of {}", heading, title_text(title)));
  svg.empty("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
  draw_text(svg, 24, 34, heading, 19, colour::black, "start", true);
  draw_text(svg, 24 + 12.1 * static_cast<double>(heading.size()), 34, shortened(title_text(title), 60), 14,
            colour::grey);
  return root;
}

}  // namespace quadsonde::product
