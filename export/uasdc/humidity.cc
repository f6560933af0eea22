#include "export/uasdc/humidity.h"

#include <cmath>

namespace quadsonde::product {
namespace {

constexpr double zero_celsius_k = 273.15, least_c = -45, most_c = 60;
constexpr double a_pa = 611.2, b = 17.62, c = 243.12;

/// A share of saturation that a sensor may report: fog reads a little above 100.
bool is_humidity(double relative_humidity_pct) { return relative_humidity_pct >= 0 && relative_humidity_pct <= 150; }

}  // namespace

std::optional<double> saturation_vapour_pressure_pa(double temperature_k) {
  const double t = temperature_k - zero_celsius_k;
  if (!(t >= least_c && t <= most_c)) return std::nullopt;
  return a_pa * std::exp(b * t / (c + t));
}

std::optional<double> dew_point_k(double temperature_k, double relative_humidity_pct) {
  const auto saturated = saturation_vapour_pressure_pa(temperature_k);
  if (!saturated || !is_humidity(relative_humidity_pct) || relative_humidity_pct == 0) return std::nullopt;
  const double x = std::log(relative_humidity_pct / 100 * *saturated / a_pa);
  return zero_celsius_k + c * x / (b - x);
}

std::optional<double> mixing_ratio(double temperature_k, double relative_humidity_pct, double pressure_pa) {
  const auto saturated = saturation_vapour_pressure_pa(temperature_k);
  if (!saturated || !is_humidity(relative_humidity_pct) || !(pressure_pa > 0)) return std::nullopt;
  const double p = pressure_pa / 100;
  const double vapour = relative_humidity_pct / 100 * (1.0016 + 3.15e-6 * p - 0.074 / p) * *saturated;
  if (!(vapour >= 0 && vapour < pressure_pa)) return std::nullopt;
  return 0.62198 * vapour / (pressure_pa - vapour);
}

}  // namespace quadsonde::product
