#include "export/report/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace quadsonde::product {
namespace {

Axis with_step(double low, double high, double from, double to, double step) {
  Axis axis{std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step, from, to, step};
  if (axis.high <= axis.low) axis.high = axis.low + step;
  return axis;
}

}  // namespace

std::vector<double> Axis::ticks() const {
  std::vector<double> all;
  const auto count = std::min(1000L, std::lround((high - low) / step));
  for (long i = 0; i <= count; ++i) all.push_back(low + static_cast<double>(i) * step);
  return all;
}

std::string Axis::label(double tick) const {
  const int digits = step >= 0.999 ? 0 : step >= 0.0999 ? 1 : 2;
  auto text = fmt::format("{:.{}f}", tick, digits);
  return text.find_first_not_of("-0.") == std::string::npos ? "0" : text;
}

Axis round_axis(double low, double high, double from, double to, int wanted) {
  if (!(high > low)) high = low + 1;
  const double raw = (high - low) / wanted;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double multiple : {1.0, 2.0, 5.0})
    if (multiple * power >= raw * 0.999) {
      step = multiple * power;
      break;
    }
  return with_step(low, high, from, to, step);
}

Axis angle_axis(double low, double high, double from, double to, int wanted) {
  double step = 180;
  for (const double candidate : {5.0, 10.0, 15.0, 30.0, 45.0, 90.0})
    if (candidate * wanted >= (high - low) * 0.999) {
      step = candidate;
      break;
    }
  return with_step(low, high, from, to, step);
}

}  // namespace quadsonde::product
