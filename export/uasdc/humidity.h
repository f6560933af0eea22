#pragma once
// Water vapour from what a sensor measures.
#include <optional>

namespace quadsonde::product {

/// Saturation vapour pressure over liquid water, without the air's own effect [Pa]; empty outside -45 to 60 degrees
/// Celsius, where the formula is stated (error below 0.3 %).
/// e_w = 611.2 Pa exp(17.62 t / (243.12 + t)), t [deg C].
/// Source: WMO-No. 8 (2018), Vol. I, annex 4.B.
std::optional<double> saturation_vapour_pressure_pa(double temperature_k);

/// Dew point over liquid water [K]: where e_w is the humidity's share of e_w at this temperature. Empty without
/// humidity (0 or less), and outside the formula's range.
/// t_d = 243.12 ln(e / 611.2 Pa) / (17.62 - ln(e / 611.2 Pa)). Source: as above.
std::optional<double> dew_point_k(double temperature_k, double relative_humidity_pct);

/// Mass of vapour per mass of dry air [kg/kg]: r = 0.62198 e' / (p - e'), e' = U/100 f(p) e_w,
/// f = 1.0016 + 3.15e-6 p - 0.074 / p, p [hPa]. Empty where no air would be left, and outside the formula's range.
/// Source: as above, annexes 4.A and 4.B.
std::optional<double> mixing_ratio(double temperature_k, double relative_humidity_pct, double pressure_pa);

}  // namespace quadsonde::product
