#include "export/report/plot.h"

#include <fmt/format.h>

#include <cmath>

namespace quadsonde::product {
namespace {

std::string point_list(const std::vector<std::pair<double, double>>& points) {
  std::string text;
  for (const auto& [x, y] : points) text += (text.empty() ? "" : " ") + coordinate(x) + "," + coordinate(y);
  return text;
}

}  // namespace

Markup::Scope open_picture(Markup& svg, double width, double height) {
  return svg.element("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                             {"viewBox", fmt::format("0 0 {} {}", width, height)},
                             {"width", width},
                             {"height", height},
                             {"role", "img"},
                             {"font-family", font_family}});
}

void draw_text(Markup& svg, double x, double y, std::string_view text, double size, const char* fill,
               const char* anchor, bool bold) {
  svg.leaf("text", text,
           {{"x", x},
            {"y", y},
            {"font-size", size},
            {"fill", fill},
            {"text-anchor", anchor},
            {"font-weight", bold ? "bold" : "normal"}});
}

void draw_frame(Markup& svg, const Panel& p, std::string_view x_title, std::string_view y_title, bool y_labels,
                const std::function<std::string(double)>& x_label) {
  for (const double tick : p.x.ticks()) {
    const double x = p.x.place(tick);
    svg.empty("line", {{"x1", x}, {"x2", x}, {"y1", p.top()}, {"y2", p.bottom()}, {"stroke", colour::rule}});
    draw_text(svg, x, p.bottom() + 16, x_label(tick), 11, colour::grey, "middle");
  }
  for (const double tick : p.y.ticks()) {
    const double y = p.y.place(tick);
    svg.empty("line", {{"x1", p.left()}, {"x2", p.right()}, {"y1", y}, {"y2", y}, {"stroke", colour::rule}});
    if (y_labels) draw_text(svg, p.left() - 8, y + 4, p.y.label(tick), 11, colour::grey, "end");
  }
  svg.empty("rect", {{"x", p.left()},
                     {"y", p.top()},
                     {"width", p.right() - p.left()},
                     {"height", p.bottom() - p.top()},
                     {"fill", "none"},
                     {"stroke", "#9aa3ad"}});
  draw_text(svg, (p.left() + p.right()) / 2, p.bottom() + 36, x_title, 12, colour::black, "middle");
  if (y_title.empty()) return;
  const double x = p.left() - 44, y = (p.top() + p.bottom()) / 2;
  svg.leaf("text", y_title,
           {{"transform", fmt::format("translate({} {}) rotate(-90)", coordinate(x), coordinate(y))},
            {"font-size", 12},
            {"fill", colour::black},
            {"text-anchor", "middle"}});
}

void define_clip(Markup& svg, const Panel& p, const std::string& id) {
  const auto clip = svg.element("clipPath", {{"id", id}});
  svg.empty(
      "rect",
      {{"x", p.left()}, {"y", p.top() - 1}, {"width", p.right() - p.left()}, {"height", p.bottom() - p.top() + 2}});
}

std::string clip_to(const std::string& id) { return "url(#" + id + ")"; }

void draw_line(Markup& svg, const std::vector<std::pair<double, double>>& points, const char* stroke, double width,
               const char* dashes) {
  if (points.size() < 2) return;
  svg.empty("polyline", {{"points", point_list(points)},
                         {"fill", "none"},
                         {"stroke", stroke},
                         {"stroke-width", width},
                         {"stroke-linejoin", "round"},
                         {"stroke-dasharray", *dashes ? dashes : "none"}});
}

void draw_area(Markup& svg, const std::vector<std::pair<double, double>>& outline, const char* fill, double opacity) {
  if (outline.size() < 3) return;
  svg.empty("polygon", {{"points", point_list(outline)}, {"fill", fill}, {"fill-opacity", opacity}});
}

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  std::size_t end = most > 3 ? most - 3 : 0;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return std::string(text.substr(0, end)) + "...";
}

std::string direction_label(double degrees) {
  double turned = std::fmod(std::fmod(degrees, 360) + 360, 360);
  if (turned < 0.5) turned = 360;
  const auto whole = std::lround(turned);
  const char* letters = whole == 360 ? " N" : whole == 90 ? " E" : whole == 180 ? " S" : whole == 270 ? " W" : "";
  return fmt::format("{}°{}", whole, letters);
}

double unwrapped(double degrees, double around) { return around + std::remainder(degrees - around, 360.0); }

}  // namespace quadsonde::product
