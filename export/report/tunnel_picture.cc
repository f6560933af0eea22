#include "export/report/tunnel_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "export/report/plot.h"

namespace quadsonde::product {
namespace {

using estimator::TunnelCalibration;
using estimator::TunnelRunFit;

constexpr double degree = std::numbers::pi / 180;
constexpr double interval95 = 1.96;
constexpr double width = 900;
constexpr std::size_t most_points = 240;

double tilt_deg(double tangent) { return std::atan(tangent) / degree; }
double compass(double radians) { return std::fmod(radians / degree + 720, 360); }

/// The two sinusoids of a run at a heading [rad], in degrees.
std::pair<double, double> fitted(const TunnelRunFit& run, double psi) {
  const double angle = run.fitted_from_deg * degree - psi;
  return {tilt_deg(-run.amplitude * std::cos(angle) + run.trim_pitch),
          tilt_deg(run.amplitude * std::sin(angle) + run.trim_roll)};
}

void draw_dot(Markup& svg, double x, double y, double radius, const char* fill, double opacity) {
  svg.empty("circle", {{"cx", x}, {"cy", y}, {"r", radius}, {"fill", fill}, {"fill-opacity", opacity}});
}

void begin_picture(Markup& svg, double height, const std::string& title, const std::string& aside) {
  svg.leaf("title", title);
  svg.empty("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
  draw_text(svg, 24, 34, title, 19, colour::black, "start", true);
  draw_text(svg, 24, 54, aside, 12, colour::grey);
}

std::string vehicle_line(const TunnelCalibration& c) {
  const auto& v = c.vehicle;
  return fmt::format("{}, {:.4g} kg, air density {:.3f} kg/m3", shortened(v.name.empty() ? v.id : v.name, 60),
                     v.mass_kg.value_or(0), v.air_density_kg_m3);
}

std::string quarter_label(double degrees) {
  const char* const names[] = {"N", "E", "S", "W", "N"};
  return std::fmod(degrees, 90) == 0 ? names[std::clamp(static_cast<int>(degrees / 90), 0, 4)]
                                     : fmt::format("{:.0f}", degrees);
}

/// One scale for all runs, so that they can be compared.
Axis tilt_axis(const TunnelCalibration& c, double from, double to) {
  double low = 0, high = 0;
  for (const auto& run : c.runs) {
    for (const double sign : {-1.0, 1.0})
      for (const double trim : {run.trim_pitch, run.trim_roll}) {
        const double edge = tilt_deg(sign * run.amplitude + trim) + sign * 2.5 * tilt_deg(run.noise);
        low = std::min(low, edge), high = std::max(high, edge);
      }
  }
  return round_axis(low, high, from, to, 4);
}

void draw_tilts(Markup& svg, const Panel& panel, const TunnelRunFit& run, const std::string& clip) {
  define_clip(svg, panel, clip);
  const auto group = svg.element("g", {{"clip-path", clip_to(clip)}});
  const std::size_t stride = std::max<std::size_t>(1, (run.samples.size() + most_points - 1) / most_points);
  for (std::size_t i = 0; i < run.samples.size(); i += stride) {
    const auto& s = run.samples[i];
    const double x = panel.x.place(compass(s.heading));
    draw_dot(svg, x, panel.y.place(tilt_deg(s.pitch)), 1.6, colour::blue, 0.45);
    draw_dot(svg, x, panel.y.place(tilt_deg(s.roll)), 1.6, colour::vermilion, 0.45);
  }
  std::vector<std::pair<double, double>> pitch, roll;
  for (int d = 0; d <= 360; d += 3) {
    const auto [p, r] = fitted(run, d * degree);
    pitch.emplace_back(panel.x.place(d), panel.y.place(p));
    roll.emplace_back(panel.x.place(d), panel.y.place(r));
  }
  draw_line(svg, pitch, colour::blue, 1.8);
  draw_line(svg, roll, colour::vermilion, 1.8, "6 3");
}

std::string run_line(const TunnelRunFit& run) {
  if (!run.drag) return fmt::format("{:.2f} m/s: the trim", run.wind_speed);
  return fmt::format("{:.2f} m/s from {:.0f}°: swing {:.2f}°", run.wind_speed, run.wind_from_deg,
                     tilt_deg(run.amplitude));
}

void draw_tilt_legend(Markup& svg) {
  draw_dot(svg, 590, 30, 3, colour::blue, 0.6);
  draw_line(svg, {{600, 30}, {630, 30}}, colour::blue, 1.8);
  draw_text(svg, 638, 34, "pitch and its sinusoid", 12);
  draw_dot(svg, 590, 50, 3, colour::vermilion, 0.6);
  draw_line(svg, {{600, 50}, {630, 50}}, colour::vermilion, 1.8, "6 3");
  draw_text(svg, 638, 54, "roll and its sinusoid", 12);
}

/// Speeds at which the law is drawn, and its value and sd there.
struct LawPoint {
  double speed, c, sd;
};

std::vector<LawPoint> law_points(const TunnelCalibration& calibration, double to) {
  std::vector<LawPoint> points;
  for (int i = 0; i <= 80; ++i) {
    const double speed = to * i / 80;
    const auto c = estimator::drag_at(calibration.vehicle, speed);
    points.push_back({speed, c.value, c.sd});
  }
  return points;
}

/// c, or c |a|: the two panels differ in nothing else.
using Scale = double (*)(double c, double speed);
double coefficient(double c, double) { return c; }
double force(double c, double speed) { return c * speed; }

void draw_law(Markup& svg, const Panel& panel, const TunnelCalibration& calibration, Scale scale,
              const std::string& clip) {
  define_clip(svg, panel, clip);
  const auto group = svg.element("g", {{"clip-path", clip_to(clip)}});
  std::vector<std::pair<double, double>> line, outline, back;
  for (const auto& p : law_points(calibration, panel.x.high)) {
    const double x = panel.x.place(p.speed), half = interval95 * p.sd;
    line.emplace_back(x, panel.y.place(scale(p.c, p.speed)));
    outline.emplace_back(x, panel.y.place(scale(p.c + half, p.speed)));
    back.emplace_back(x, panel.y.place(scale(p.c - half, p.speed)));
  }
  outline.insert(outline.end(), back.rbegin(), back.rend());
  draw_area(svg, outline, colour::blue, 0.17);
  draw_line(svg, line, colour::blue, 2);
  for (const auto& run : calibration.runs) {
    if (!run.drag) continue;
    const double U = run.wind_speed, half = interval95 * *run.drag_sd;
    const double x = panel.x.place(U);
    draw_line(svg, {{x, panel.y.place(scale(*run.drag - half, U))}, {x, panel.y.place(scale(*run.drag + half, U))}},
              colour::vermilion, 1.4);
    draw_dot(svg, x, panel.y.place(scale(*run.drag, U)), 4, colour::vermilion, 1);
  }
}

/// Ends of the runs' intervals in one panel's scale.
std::pair<double, double> reach(const TunnelCalibration& calibration, Scale scale) {
  double low = 1e9, high = 0;
  for (const auto& run : calibration.runs)
    if (run.drag) {
      low = std::min(low, scale(*run.drag - interval95 * *run.drag_sd, run.wind_speed));
      high = std::max(high, scale(*run.drag + interval95 * *run.drag_sd, run.wind_speed));
    }
  return {std::max(0.0, low), high};
}

std::string law_line(const TunnelCalibration& c) {
  const auto& d = c.vehicle.drag;
  if (!c.quadratic) return fmt::format("c = {:.4f} 1/s at every airspeed", d.linear);
  return fmt::format("c = {:.4f} 1/s + {:.4f} 1/m |a|", d.linear, d.quadratic);
}

}  // namespace

std::string tunnel_tilt_svg(const TunnelCalibration& calibration) {
  constexpr int columns = 3;
  constexpr double first_left = 62, panel_width = 232, gap = 46, first_top = 100, panel_height = 170, row_height = 256;
  const auto rows = static_cast<int>((calibration.runs.size() + columns - 1) / columns);
  const double height = first_top + rows * row_height;
  Markup svg;
  {
    const auto root = open_picture(svg, width, height);
    begin_picture(svg, height, "Tilt against heading, run by run", vehicle_line(calibration));
    draw_tilt_legend(svg);
    for (std::size_t i = 0; i < calibration.runs.size(); ++i) {
      const auto column = static_cast<double>(i % columns), row = static_cast<double>(i / columns);
      const double left = first_left + column * (panel_width + gap), top = first_top + row * row_height;
      Panel panel{angle_axis(0, 360, left, left + panel_width, 4), tilt_axis(calibration, top + panel_height, top)};
      draw_frame(svg, panel, "heading", column == 0 ? "tilt (degrees)" : "", true, quarter_label);
      draw_text(svg, left, top - 20, shortened(calibration.runs[i].name, 34), 12, colour::black, "start", true);
      draw_text(svg, left, top - 6, run_line(calibration.runs[i]), 11, colour::grey);
      draw_tilts(svg, panel, calibration.runs[i], fmt::format("run-{}", i));
    }
  }
  return svg.str();
}

std::string tunnel_drag_svg(const TunnelCalibration& calibration) {
  constexpr double height = 480, top = 110, bottom = 410;
  Markup svg;
  {
    const auto root = open_picture(svg, width, height);
    begin_picture(svg, height, "Drag against airspeed", vehicle_line(calibration));
    draw_line(svg, {{24, 76}, {54, 76}}, colour::blue, 2);
    draw_text(svg, 62, 80, law_line(calibration) + ", with 95 % interval", 12);
    draw_dot(svg, 470, 76, 4, colour::vermilion, 1);
    draw_text(svg, 482, 80, "each run by itself, with the 95 % of its stated wind", 12);
    double fastest = 1;
    for (const auto& run : calibration.runs) fastest = std::max(fastest, run.wind_speed);
    const auto speeds = [&](double from, double to) { return round_axis(0, 1.1 * fastest, from, to, 5); };
    const auto [c_low, c_high] = reach(calibration, coefficient);
    const double c_margin = 0.35 * (c_high - c_low);
    const Panel forces{speeds(76, 426), round_axis(0, 1.1 * reach(calibration, force).second, bottom, top, 5)};
    const Panel coefficients{speeds(520, 870),
                             round_axis(std::max(0.0, c_low - c_margin), c_high + c_margin, bottom, top, 5)};
    const auto speed_label = [&](double tick) { return forces.x.label(tick); };
    draw_frame(svg, forces, "airspeed (m/s)", "drag per mass (m/s²)", true, speed_label);
    draw_frame(svg, coefficients, "airspeed (m/s)", "drag coefficient c (1/s)", true, speed_label);
    draw_law(svg, forces, calibration, force, "force");
    draw_law(svg, coefficients, calibration, coefficient, "coefficient");
  }
  return svg.str();
}

}  // namespace quadsonde::product
