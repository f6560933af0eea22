#pragma once
#include <string>

#include "export/report/markup.h"

namespace quadsonde::product {

/// A wind barb at a place on paper: the staff points to where the wind comes from; half feather 2.5 m/s, feather
/// 5 m/s, pennant 25 m/s, a ring below 1.25 m/s. Feathers on the side of low pressure: clockwise in the north.
/// Source: WMO-No. 485, appendix II-4, plotting of wind (10 and 5 knots read as 5 and 2.5 m/s).
void draw_barb(Markup& svg, double x, double y, double speed_m_s, double from_deg, bool southern,
               const std::string& colour);

}  // namespace quadsonde::product
