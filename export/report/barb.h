#pragma once
#include <string>
#include <vector>

#include "export/report/markup.h"

namespace quadsonde::product {

/// A line, or the outline of an area, in a barb's own axes: the staff runs from the origin to (0, -barb_staff), which
/// is where the wind comes from; x to the right of it.
struct BarbStroke {
  struct Point {
    double x, y;
  };
  std::vector<Point> points;
  bool filled = false;
};
inline constexpr double barb_staff = 26;
/// The strokes of a wind barb; none below 1.25 m/s, which is a ring.
std::vector<BarbStroke> barb_strokes(double speed_m_s, bool southern);

/// A wind barb at a place on paper: the staff points to where the wind comes from; half feather 2.5 m/s, feather
/// 5 m/s, pennant 25 m/s, a ring below 1.25 m/s. Feathers on the side of low pressure: clockwise in the north.
/// Source: WMO-No. 485, appendix II-4, plotting of wind (10 and 5 knots read as 5 and 2.5 m/s).
void draw_barb(Markup& svg, double x, double y, double speed_m_s, double from_deg, bool southern,
               const std::string& colour);

}  // namespace quadsonde::product
