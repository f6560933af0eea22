#pragma once
// One axis of a picture: values to places on paper, and the round numbers along it.
#include <string>
#include <vector>

namespace quadsonde::product {

struct Axis {
  double low = 0, high = 1;   ///< values at the ends
  double from = 0, to = 100;  ///< places of the ends
  double step = 1;            ///< between ticks
  double place(double value) const { return from + (value - low) / (high - low) * (to - from); }
  std::vector<double> ticks() const;
  std::string label(double tick) const;
};

/// An axis whose ends are ticks, with about `wanted` intervals of 1, 2 or 5 times a power of ten.
Axis round_axis(double low, double high, double from, double to, int wanted);
/// The same with steps that suit angles: 5, 10, 15, 30, 45, 90.
Axis angle_axis(double low, double high, double from, double to, int wanted);

}  // namespace quadsonde::product
