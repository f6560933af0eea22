#include "export/report/barb.h"

#include <fmt/format.h>

#include <cmath>

namespace quadsonde::product {
namespace {

constexpr double staff = barb_staff, feather = 10, spacing = 4;

int half_feathers_of(double speed) { return static_cast<int>(std::lround(std::min(speed, 200.0) / 2.5)); }

std::string barb_path(const std::vector<BarbStroke>& strokes) {
  std::string path;
  for (const auto& stroke : strokes) {
    char command = 'M';
    for (const auto& p : stroke.points) {
      path += fmt::format("{}{} {}", command, coordinate(p.x), coordinate(p.y));
      command = 'L';
    }
    if (stroke.filled) path += 'Z';
  }
  return path;
}

}  // namespace

std::vector<BarbStroke> barb_strokes(double speed, bool southern) {
  int half_feathers = half_feathers_of(speed);
  if (!half_feathers) return {};
  const double side = southern ? -1 : 1;
  std::vector<BarbStroke> strokes{{{{0, 0}, {0, -staff}}}};
  double at = -staff;
  const bool only_half = half_feathers == 1;
  for (; half_feathers >= 10; half_feathers -= 10, at += 2 * spacing)
    strokes.push_back({{{0, at}, {side * feather, at + spacing / 2}, {0, at + 1.5 * spacing}}, true});
  for (; half_feathers >= 2; half_feathers -= 2, at += spacing)
    strokes.push_back({{{0, at}, {side * feather, at - spacing}}});
  // A lone half feather stands in from the end, or it would be read as a bent staff.
  if (only_half) at += spacing;
  if (half_feathers == 1) strokes.push_back({{{0, at}, {side * feather / 2, at - spacing / 2}}});
  return strokes;
}

void draw_barb(Markup& svg, double x, double y, double speed, double from_deg, bool southern,
               const std::string& colour) {
  const int half_feathers = half_feathers_of(speed);
  svg.empty("circle", {{"cx", x},
                       {"cy", y},
                       {"r", half_feathers ? 1.8 : 4.0},
                       {"fill", half_feathers ? colour : "none"},
                       {"stroke", colour}});
  if (!half_feathers) return;
  svg.empty("path", {{"d", barb_path(barb_strokes(speed, southern))},
                     {"transform",
                      fmt::format("translate({} {}) rotate({})", coordinate(x), coordinate(y), coordinate(from_deg))},
                     {"fill", colour},
                     {"stroke", colour},
                     {"stroke-width", 1.3},
                     {"stroke-linejoin", "round"}});
}

}  // namespace quadsonde::product
