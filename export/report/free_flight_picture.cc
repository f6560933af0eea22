#include "export/report/free_flight_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimator/calibration/tunnel.h"
#include "export/report/plot.h"

namespace quadsonde::product {
namespace {

using estimator::FreeFlightCalibration;

constexpr double interval95 = 1.96;
constexpr double width = 900, height = 480;

/// A value with its 95 % at an airspeed.
struct Dot {
  double airspeed = 0, c = 0, half = 0;
  const char* colour = colour::black;
};

std::vector<Dot> dots_of(const FreeFlightCalibration& c) {
  std::vector<Dot> dots;
  if (c.referee) dots.push_back({c.referee->airspeed, c.referee->drag, interval95 * c.referee->drag_sd, colour::green});
  std::size_t converged = 0;
  for (const auto& a : c.assumed) converged += a.converged;
  // They share one airspeed: side by side they can be told apart.
  std::size_t k = 0;
  for (const auto& a : c.assumed) {
    if (!a.converged) continue;
    const double aside = 0.12 * (static_cast<double>(k++) - 0.5 * static_cast<double>(converged - 1));
    dots.push_back({c.airspeed + aside, a.drag, interval95 * a.drag_rel_sd * a.drag, colour::vermilion});
  }
  k = 0;
  for (const auto& run : c.runs)
    if (run.drag && run.drag_sd)
      dots.push_back(
          {c.airspeed + 0.5 + 0.12 * static_cast<double>(k++), *run.drag, interval95 * *run.drag_sd, colour::black});
  return dots;
}

void draw_dot(Markup& svg, const Panel& panel, const Dot& dot) {
  const double x = panel.x.place(dot.airspeed);
  draw_line(svg, {{x, panel.y.place(dot.c - dot.half)}, {x, panel.y.place(dot.c + dot.half)}}, dot.colour, 1.4);
  svg.empty("circle", {{"cx", x}, {"cy", panel.y.place(dot.c)}, {"r", 3.5}, {"fill", dot.colour}});
}

void draw_law(Markup& svg, const Panel& panel, const ingest::Vehicle& vehicle, double from, double to,
              const char* stroke, const char* dashes) {
  std::vector<std::pair<double, double>> line, outline, back;
  for (int i = 0; i <= 60; ++i) {
    const double airspeed = from + (to - from) * i / 60, x = panel.x.place(airspeed);
    const auto at = estimator::drag_at(vehicle, airspeed);
    line.emplace_back(x, panel.y.place(at.value));
    outline.emplace_back(x, panel.y.place(at.value + interval95 * at.sd));
    back.emplace_back(x, panel.y.place(at.value - interval95 * at.sd));
  }
  outline.insert(outline.end(), back.rbegin(), back.rend());
  draw_area(svg, outline, stroke, 0.15);
  draw_line(svg, line, stroke, 2, dashes);
}

std::string aside(const FreeFlightCalibration& c) {
  std::size_t used = 0;
  for (const auto& run : c.runs) used += run.used;
  return fmt::format("{} of {} free {} used, X {:.2f} m/s", used, c.runs.size(),
                     c.runs.size() == 1 ? "flight" : "flights", c.excitation);
}

void draw_legend(Markup& svg, const FreeFlightCalibration& c, const ingest::Vehicle& prior) {
  const auto entry = [&](double x, double y, const char* stroke, const char* dashes, const std::string& text) {
    draw_line(svg, {{x, y - 4}, {x + 30, y - 4}}, stroke, 2, dashes);
    draw_text(svg, x + 38, y, text, 12);
  };
  const auto dot = [&](double x, double y, const char* fill, const std::string& text) {
    svg.empty("circle", {{"cx", x + 15}, {"cy", y - 4}, {"r", 3.5}, {"fill", fill}});
    draw_text(svg, x + 38, y, text, 12);
  };
  if (!c.refused) entry(24, 78, colour::blue, "", "calibrated, where it was flown, with 95 %");
  entry(24, 96, colour::grey, "6 3", fmt::format("known before: {}", shortened(prior.id, 40)));
  dot(450, 78, colour::vermilion, "one assumption on the noise each, with its formal 95 %");
  dot(450, 96, colour::green, "least squares without a drag law");
  if (std::any_of(c.runs.begin(), c.runs.end(), [](const auto& run) { return run.drag.has_value(); }))
    dot(690, 96, colour::black, "each flight by itself");
}

}  // namespace

std::string free_flight_drag_svg(const FreeFlightCalibration& calibration, const ingest::Vehicle& prior) {
  const auto& v = calibration.vehicle;
  const auto dots = dots_of(calibration);
  double fastest = std::max({1.0, v.airspeed_range_m_s.y(), prior.airspeed_range_m_s.y()});
  double highest = 0;
  for (const auto& dot : dots) {
    fastest = std::max(fastest, dot.airspeed);
    highest = std::max(highest, std::min(dot.c + dot.half, 2 * dot.c));
  }
  const auto before = estimator::drag_at(prior, 0.5 * prior.airspeed_range_m_s.y());
  highest = std::max(highest, before.value + interval95 * before.sd);
  Markup svg;
  {
    const auto root = open_picture(svg, width, height);
    const std::string title =
        calibration.refused ? "Drag against airspeed: refused, for information only" : "Drag against airspeed";
    svg.leaf("title", title);
    svg.empty("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
    draw_text(svg, 24, 34, title, 19, colour::black, "start", true);
    draw_text(svg, 24, 54, aside(calibration), 12, colour::grey);
    draw_legend(svg, calibration, prior);
    const Panel panel{round_axis(0, 1.05 * fastest, 76, 870, 8), round_axis(0, 1.05 * highest, 410, 120, 5)};
    draw_frame(svg, panel, "airspeed (m/s)", "drag coefficient c (1/s)", true,
               [&](double tick) { return panel.x.label(tick); });
    define_clip(svg, panel, "drag");
    const auto group = svg.element("g", {{"clip-path", clip_to("drag")}});
    draw_law(svg, panel, prior, 0, panel.x.high, colour::grey, "6 3");
    if (!calibration.refused)
      draw_law(svg, panel, v, v.airspeed_range_m_s.x(), v.airspeed_range_m_s.y(), colour::blue, "");
    for (const auto& dot : dots) draw_dot(svg, panel, dot);
  }
  return svg.str();
}

}  // namespace quadsonde::product
