#include "export/report/series_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "export/report/plot.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using estimator::WindSeries;

constexpr double width = 900, height = 560, left = 68, right = 868;
constexpr std::size_t most_points = 1200;

struct Instant {
  double minutes = 0;
  std::optional<double> height;
  double speed = 0, speed_sd = 0;
  std::optional<double> from, from_sd;
  Eigen::Vector2d toward = Eigen::Vector2d::Zero();
};
using Run = std::vector<Instant>;

std::optional<double> any_height(const estimator::WindPoint& p) {
  if (p.height_agl) return p.height_agl->m;
  if (p.height_msl) return p.height_msl->m;
  return std::nullopt;
}

/// Every stride-th point with a wind, broken where there is none.
std::vector<Run> runs_of(const WindSeries& series, ingest::LogTime start) {
  std::vector<Run> runs;
  const std::size_t stride = std::max<std::size_t>(1, series.points.size() / most_points);
  bool open = false;
  for (std::size_t i = 0; i < series.points.size(); i += stride) {
    const auto& point = series.points[i];
    const auto* wind = std::get_if<WindEstimate>(&point.wind);
    if (wind) {
      if (!open) runs.emplace_back();
      const auto report = estimator::to_report(*wind);
      runs.back().push_back({ingest::to_seconds(point.time - start) / 60, any_height(point), report.speed_m_s,
                             wind->has_covariance ? estimator::speed_sd(*wind) : 0, report.from_deg,
                             wind->has_covariance ? estimator::direction_sd_deg(*wind) : std::nullopt, wind->v_NA_N});
    }
    open = wind != nullptr;
  }
  return runs;
}

template <class Visit>
void each(const std::vector<Run>& runs, Visit&& visit) {
  for (const auto& run : runs)
    for (const auto& instant : run) visit(instant);
}

struct Reading {
  double value = 0, half = 0;
};
using Read = std::function<std::optional<Reading>(const Instant&)>;

void draw_curve(Markup& svg, const Panel& panel, const std::vector<Run>& runs, const Read& read, const char* stroke,
                bool band, const char* dashes = "") {
  const auto flush = [&](std::vector<std::pair<Instant, Reading>>& part) {
    std::vector<std::pair<double, double>> line, outline;
    for (const auto& [instant, r] : part) {
      line.emplace_back(panel.x.place(instant.minutes), panel.y.place(r.value));
      outline.emplace_back(line.back().first, panel.y.place(r.value + r.half));
    }
    for (auto it = part.rbegin(); it != part.rend(); ++it)
      outline.emplace_back(panel.x.place(it->first.minutes),
                           panel.y.place(std::max(panel.y.low, it->second.value - it->second.half)));
    if (band) draw_area(svg, outline, stroke, 0.17);
    draw_line(svg, line, stroke, dashes[0] ? 1.3 : 1.6, dashes);
    part.clear();
  };
  for (const auto& run : runs) {
    std::vector<std::pair<Instant, Reading>> part;
    for (const auto& instant : run) {
      const auto reading = read(instant);
      // A curve that leaves the paper on one side and comes back on the other is two curves.
      const bool jumps = reading && !part.empty() && std::abs(reading->value - part.back().second.value) > 180;
      if (!reading || jumps) flush(part);
      if (reading) part.emplace_back(instant, *reading);
    }
    flush(part);
  }
}

std::optional<Reading> speed_of(const Instant& i) { return Reading{i.speed, 1.96 * i.speed_sd}; }

Read direction_around(double around) {
  return [around](const Instant& i) -> std::optional<Reading> {
    if (!i.from) return std::nullopt;
    return Reading{unwrapped(*i.from, around), 1.96 * i.from_sd.value_or(0)};
  };
}

std::optional<Reading> height_of(const Instant& i) {
  if (!i.height) return std::nullopt;
  return Reading{*i.height, 0};
}

/// Lowest and highest value, with bands up to a limit.
Axis value_axis(const std::vector<Run>& runs, const Read& read, double from, double to, double band_limit,
                bool angles) {
  double low = 1e9, high = -1e9;
  each(runs, [&](const Instant& i) {
    if (const auto r = read(i)) {
      const double half = std::min(r->half, band_limit);
      low = std::min(low, r->value - half), high = std::max(high, r->value + half);
    }
  });
  if (low > high) low = 0, high = 1;
  if (!angles) return round_axis(std::min(0.0, std::max(low, 0.0)), std::max(high, 1.0), from, to, 4);
  return angle_axis(std::min(low, high - 40), high, from, to, 4);
}

double mean_direction(const std::vector<Run>& runs) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  each(runs, [&](const Instant& i) { sum += i.toward; });
  return sum.norm() > 0 ? std::atan2(-sum.y(), -sum.x()) * 180 / std::numbers::pi : 180;
}

void draw_frame_of(Markup& svg, const Panel& p, std::string_view y_title,
                   const std::function<std::string(double)>& y_label, bool x_labels) {
  for (const double tick : p.x.ticks()) {
    if (tick > p.x.high) continue;
    const double x = p.x.place(tick);
    svg.empty("line", {{"x1", x}, {"x2", x}, {"y1", p.top()}, {"y2", p.bottom()}, {"stroke", colour::rule}});
    if (x_labels) draw_text(svg, x, p.bottom() + 16, p.x.label(tick), 11, colour::grey, "middle");
  }
  for (const double tick : p.y.ticks()) {
    const double y = p.y.place(tick);
    svg.empty("line", {{"x1", p.left()}, {"x2", p.right()}, {"y1", y}, {"y2", y}, {"stroke", colour::rule}});
    draw_text(svg, p.left() - 8, y + 4, y_label(tick), 11, colour::grey, "end");
  }
  svg.empty("rect", {{"x", p.left()},
                     {"y", p.top()},
                     {"width", p.right() - p.left()},
                     {"height", p.bottom() - p.top()},
                     {"fill", "none"},
                     {"stroke", "#9aa3ad"}});
  draw_text(svg, p.left(), p.top() - 7, y_title, 12);
}

struct Curves {
  std::vector<Run> ours, classic;
  double around = 180;
};

void draw_panels(Markup& svg, const Curves& curves, const std::string& id, bool agl) {
  double last = 0.1;
  each(curves.ours, [&](const Instant& i) { last = std::max(last, i.minutes); });
  auto minutes = round_axis(0, last, left, right, 10);
  minutes.high = last;
  const auto direction = direction_around(curves.around);
  const Panel heights{minutes, value_axis(curves.ours, height_of, 172, 86, 0, false)};
  const Panel speeds{minutes, value_axis(curves.ours, speed_of, 338, 204, 3, false)};
  const Panel directions{minutes, value_axis(curves.ours, direction, 504, 370, 25, true)};
  draw_frame_of(
      svg, heights, agl ? "height above take-off (m)" : "height (m)", [&](double t) { return heights.y.label(t); },
      false);
  draw_frame_of(
      svg, speeds, "wind speed (m/s)", [&](double t) { return speeds.y.label(t); }, false);
  draw_frame_of(svg, directions, "wind from (degrees, true north)", direction_label, true);
  draw_text(svg, (left + right) / 2, 540, "minutes after the start", 12, colour::black, "middle");
  const auto clipped = [&](const Panel& panel, const char* name, auto&& draw) {
    define_clip(svg, panel, id + name);
    const auto group = svg.element("g", {{"clip-path", clip_to(id + name)}});
    draw();
  };
  clipped(heights, "-height", [&] { draw_curve(svg, heights, curves.ours, height_of, colour::grey, false); });
  clipped(speeds, "-speed", [&] {
    draw_curve(svg, speeds, curves.classic, speed_of, colour::vermilion, false, "5 3");
    draw_curve(svg, speeds, curves.ours, speed_of, colour::blue, true);
  });
  clipped(directions, "-from", [&] {
    draw_curve(svg, directions, curves.classic, direction, colour::vermilion, false, "5 3");
    draw_curve(svg, directions, curves.ours, direction, colour::blue, true);
  });
}

void draw_legend(Markup& svg, bool classic, estimator::Mode mode) {
  const double y = 60;
  svg.empty(
      "rect",
      {{"x", left}, {"y", y - 10}, {"width", 30}, {"height", 12}, {"fill", colour::blue}, {"fill-opacity", 0.17}});
  draw_line(svg, {{left, y - 4}, {left + 30, y - 4}}, colour::blue, 2);
  draw_text(svg, left + 37, y, fmt::format("wind ({}) with 95 % interval", estimator::name(mode)), 12);
  if (!classic) return;
  draw_line(svg, {{left + 290, y - 4}, {left + 320, y - 4}}, colour::vermilion, 1.5, "5 3");
  draw_text(svg, left + 327, y, "classic filter", 12);
}

}  // namespace

std::string series_svg(const WindSeries& series, const SeriesPicture& picture) {
  Markup svg;
  {
    const auto root = svg.element("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                                          {"viewBox", fmt::format("0 0 {} {}", width, height)},
                                          {"width", width},
                                          {"height", height},
                                          {"role", "img"},
                                          {"font-family", font_family}});
    svg.leaf("title", "Wind along the flight of " + title_text(picture.title));
    svg.empty("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
    draw_text(svg, 24, 34, "Wind along the flight", 19, colour::black, "start", true);
    draw_text(svg, 256, 34, shortened(title_text(picture.title), 60), 14, colour::grey);
    const auto start = series.points.empty() ? ingest::LogTime{} : series.points.front().time;
    Curves curves{runs_of(series, start), picture.classic ? runs_of(*picture.classic, start) : std::vector<Run>{}, 180};
    curves.around = mean_direction(curves.ours);
    const bool agl =
        std::any_of(series.points.begin(), series.points.end(), [](const auto& p) { return p.height_agl.has_value(); });
    draw_legend(svg, !curves.classic.empty(), series.mode);
    draw_panels(svg, curves, picture.id, agl);
  }
  return svg.str();
}

}  // namespace quadsonde::product
