#include "export/report/time_plot.h"

#include <algorithm>
#include <cmath>

namespace quadsonde::product {
namespace {

constexpr std::size_t most_points = 1200;
constexpr double band_opacity = 0.17;

Panel panel_of(const TimeAxis& time, const Axis& y) { return {time.axis, y}; }

void draw_part(Markup& svg, const TimeAxis& time, const Axis& y, const std::vector<TimeValue>& part, const Pen& pen) {
  std::vector<std::pair<double, double>> line, outline;
  for (const auto& v : part) {
    line.emplace_back(time.place(v.seconds), y.place(v.value));
    outline.emplace_back(line.back().first, y.place(v.value + v.half));
  }
  for (auto it = part.rbegin(); it != part.rend(); ++it)
    outline.emplace_back(time.place(it->seconds), y.place(std::max(y.low, it->value - it->half)));
  if (pen.band) draw_area(svg, outline, pen.stroke, band_opacity);
  draw_line(svg, line, pen.stroke, pen.width, pen.dashes);
}

}  // namespace

TimeCurve time_curve(std::size_t count, const std::function<std::optional<TimeValue>(std::size_t)>& read) {
  TimeCurve curve;
  const std::size_t stride = std::max<std::size_t>(1, count / most_points);
  bool open = false;
  for (std::size_t i = 0; i < count; i += stride) {
    const auto value = read(i);
    if (value && !open) curve.emplace_back();
    if (value) curve.back().push_back(*value);
    open = value.has_value();
  }
  return curve;
}

TimeAxis::TimeAxis(double last) : unit(last > 600 ? 60 : 1) {
  const double end = std::max(last, 1.0) / unit;
  axis = round_axis(0, end, time_plot_left, time_plot_right, 10);
  axis.high = end;
}

std::optional<std::pair<double, double>> value_range(const std::vector<const TimeCurve*>& curves, double band_limit) {
  std::optional<std::pair<double, double>> range;
  for (const auto* curve : curves)
    for (const auto& part : *curve)
      for (const auto& v : part) {
        const double half = std::min(v.half, band_limit);
        if (!range) range.emplace(v.value, v.value);
        range->first = std::min(range->first, v.value - half);
        range->second = std::max(range->second, v.value + half);
      }
  return range;
}

void draw_time_frame(Markup& svg, const TimeAxis& time, const Axis& y, std::string_view title,
                     const std::function<std::string(double)>& y_label, bool time_labels) {
  const Panel p = panel_of(time, y);
  for (const double tick : p.x.ticks()) {
    if (tick > p.x.high) continue;
    const double x = p.x.place(tick);
    svg.empty("line", {{"x1", x}, {"x2", x}, {"y1", p.top()}, {"y2", p.bottom()}, {"stroke", colour::rule}});
    if (time_labels) draw_text(svg, x, p.bottom() + 16, p.x.label(tick), 11, colour::grey, "middle");
  }
  for (const double tick : y.ticks()) {
    const double at = y.place(tick);
    svg.empty("line", {{"x1", p.left()}, {"x2", p.right()}, {"y1", at}, {"y2", at}, {"stroke", colour::rule}});
    draw_text(svg, p.left() - 8, at + 4, y_label(tick), 11, colour::grey, "end");
  }
  svg.empty("rect", {{"x", p.left()},
                     {"y", p.top()},
                     {"width", p.right() - p.left()},
                     {"height", p.bottom() - p.top()},
                     {"fill", "none"},
                     {"stroke", "#9aa3ad"}});
  draw_text(svg, p.left(), p.top() - 7, title, 12);
  if (time_labels)
    draw_text(svg, (p.left() + p.right()) / 2, p.bottom() + 36, time.title(), 12, colour::black, "middle");
}

void define_time_clip(Markup& svg, const Axis& y, const std::string& clip) {
  define_clip(svg, {{0, 1, time_plot_left, time_plot_right, 1}, y}, clip);
}

void draw_time_curve(Markup& svg, const TimeAxis& time, const Axis& y, const TimeCurve& curve, const Pen& pen,
                     const std::string& clip, double leap) {
  const auto group = svg.element("g", {{"clip-path", clip_to(clip)}});
  for (const auto& whole : curve) {
    std::vector<TimeValue> part;
    for (const auto& v : whole) {
      // A curve that leaves the paper on one side and comes back on the other is two curves.
      if (!part.empty() && std::abs(v.value - part.back().value) > leap) {
        draw_part(svg, time, y, part, pen);
        part.clear();
      }
      part.push_back(v);
    }
    draw_part(svg, time, y, part, pen);
  }
}

void draw_pen_legend(Markup& svg, double x, double y, const std::vector<std::pair<std::string, Pen>>& entries) {
  constexpr double sample = 30;
  for (const auto& [text, pen] : entries) {
    if (pen.band)
      svg.empty("rect", {{"x", x},
                         {"y", y - 10},
                         {"width", sample},
                         {"height", 12},
                         {"fill", pen.stroke},
                         {"fill-opacity", band_opacity}});
    draw_line(svg, {{x, y - 4}, {x + sample, y - 4}}, pen.stroke, pen.width + 0.3, pen.dashes);
    draw_text(svg, x + sample + 7, y, text, 12);
    x += sample + 28 + 6.9 * static_cast<double>(text.size());
  }
}

}  // namespace quadsonde::product
