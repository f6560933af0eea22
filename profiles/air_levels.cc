#include "profiles/air_levels.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace quadsonde::profiles {
namespace {

struct Mean {
  double sum = 0, n = 0;
  void add(const std::optional<double>& value) {
    if (value && std::isfinite(*value)) sum += *value, n += 1;
  }
  std::optional<double> value() const { return n > 0 ? std::optional(sum / n) : std::nullopt; }
};
struct AirMeans {
  Mean pressure, temperature, humidity, barometer;
};

/// Height of the series' point at or before a time; empty outside the flight.
class HeightAt {
 public:
  HeightAt(const estimator::WindSeries& series, Datum datum) : series_(series), datum_(datum) {}
  std::optional<double> operator()(ingest::LogTime t) {
    const auto& points = series_.points;
    while (at_ + 1 < points.size() && points[at_ + 1].time <= t) ++at_;
    if (points.empty() || points[at_].time > t || ingest::to_seconds(t - points[at_].time) > 2) return std::nullopt;
    if (datum_ == Datum::agl)
      return points[at_].height_agl ? std::optional(points[at_].height_agl->m) : std::nullopt;
    return points[at_].height_msl ? std::optional(points[at_].height_msl->m) : std::nullopt;
  }

 private:
  const estimator::WindSeries& series_;
  Datum datum_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<double> barometric_altitude(double pressure_pa) {
  // ISO 2533: 288.15 K and 101325 Pa at sea level, 6.5 K per km up to 11 km, where 22632 Pa remain.
  constexpr double sea_level = 101325, tropopause = 22632, temperature = 288.15, lapse = 0.0065;
  constexpr double exponent = 287.05287 * lapse / 9.80665;
  if (!(pressure_pa >= tropopause && pressure_pa < 1.2 * sea_level)) return std::nullopt;
  return temperature / lapse * (1 - std::pow(pressure_pa / sea_level, exponent));
}

std::optional<double> barometric_altitude(const Bin& bin) {
  return bin.pressure_pa ? barometric_altitude(*bin.pressure_pa) : std::nullopt;
}

void fill_air(WindProfile& profile, const estimator::WindSeries& series, const ingest::Flight& flight) {
  std::map<std::int64_t, AirMeans> means;  // by index of the bin
  const auto index = [&](double height) { return static_cast<std::int64_t>(std::floor(height / profile.bin_m)); };
  HeightAt of_air(series, profile.datum), of_barometer(series, profile.datum);
  for (std::size_t i = 0; i < flight.air.size(); ++i)
    if (const auto height = of_air(flight.air.time[i])) {
      auto& m = means[index(*height)];
      m.pressure.add(flight.air.value[i].pressure_pa);
      m.temperature.add(flight.air.value[i].temperature_k);
      m.humidity.add(flight.air.value[i].relative_humidity_pct);
    }
  for (std::size_t i = 0; i < flight.barometer.size(); ++i)
    if (const auto height = of_barometer(flight.barometer.time[i]))
      means[index(*height)].barometer.add(flight.barometer.value[i].pressure_pa);
  const auto fill = [&](Leg& leg) {
    for (auto& bin : leg.bins) {
      const auto found = means.find(std::llround(bin.bottom / profile.bin_m));
      if (found == means.end()) continue;
      bin.pressure_pa = found->second.pressure.value();
      if (!bin.pressure_pa) bin.pressure_pa = found->second.barometer.value();
      bin.temperature_k = found->second.temperature.value();
      bin.relative_humidity_pct = found->second.humidity.value();
    }
  };
  for (auto& leg : profile.legs) fill(leg);
  for (auto& leg : profile.flown) fill(leg);
}

}  // namespace quadsonde::profiles
