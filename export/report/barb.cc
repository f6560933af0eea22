#include "export/report/barb.h"

#include <fmt/format.h>

#include <cmath>

namespace quadsonde::product {
namespace {

constexpr double staff = 26, feather = 10, spacing = 4;

/// The path in barb axes, the staff along -y (wind from the north), before it is turned.
std::string barb_path(int half_feathers, double side) {
  std::string path = fmt::format("M0 0L0 {}", coordinate(-staff));
  double at = -staff;
  const bool only_half = half_feathers == 1;
  for (; half_feathers >= 10; half_feathers -= 10, at += 2 * spacing)
    path += fmt::format("M0 {}L{} {}L0 {}Z", coordinate(at), coordinate(side * feather), coordinate(at + spacing / 2),
                        coordinate(at + 1.5 * spacing));
  for (; half_feathers >= 2; half_feathers -= 2, at += spacing)
    path += fmt::format("M0 {}L{} {}", coordinate(at), coordinate(side * feather), coordinate(at - spacing));
  // A lone half feather stands in from the end, or it would be read as a bent staff.
  if (only_half) at += spacing;
  if (half_feathers == 1)
    path += fmt::format("M0 {}L{} {}", coordinate(at), coordinate(side * feather / 2), coordinate(at - spacing / 2));
  return path;
}

}  // namespace

void draw_barb(Markup& svg, double x, double y, double speed, double from_deg, bool southern,
               const std::string& colour) {
  const int half_feathers = static_cast<int>(std::lround(std::min(speed, 200.0) / 2.5));
  svg.empty("circle", {{"cx", x},
                       {"cy", y},
                       {"r", half_feathers ? 1.8 : 4.0},
                       {"fill", half_feathers ? colour : "none"},
                       {"stroke", colour}});
  if (!half_feathers) return;
  svg.empty("path", {{"d", barb_path(half_feathers, southern ? -1 : 1)},
                     {"transform",
                      fmt::format("translate({} {}) rotate({})", coordinate(x), coordinate(y), coordinate(from_deg))},
                     {"fill", colour},
                     {"stroke", colour},
                     {"stroke-width", 1.3},
                     {"stroke-linejoin", "round"}});
}

}  // namespace quadsonde::product
