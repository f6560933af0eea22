#include "export/csv/rows.h"

#include <cmath>

#include "export/csv/numbers.h"
#include "profiles/air_levels.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;

/// What both tables say about a wind; every text empty when there is none.
struct WindText {
  std::string east, north, sd_east, sd_north, covariance, speed, sd_speed, from, sd_from;
};

WindText wind_text(const estimator::MaybeWind& maybe) {
  WindText text;
  const auto* wind = std::get_if<WindEstimate>(&maybe);
  if (!wind) return text;
  const auto report = estimator::to_report(*wind);
  text.north = fixed(wind->v_NA_N.x(), digits::speed);
  text.east = fixed(wind->v_NA_N.y(), digits::speed);
  text.speed = fixed(report.speed_m_s, digits::speed);
  text.from = fixed(report.from_deg, digits::direction);
  if (text.from == "0.00") text.from = "360.00";  // north is 360, also after rounding
  if (!wind->has_covariance) return text;
  text.sd_north = fixed(std::sqrt(wind->covariance(0, 0)), digits::speed);
  text.sd_east = fixed(std::sqrt(wind->covariance(1, 1)), digits::speed);
  text.covariance = fixed(wind->covariance(0, 1), digits::covariance);
  text.sd_speed = fixed(estimator::speed_sd(*wind), digits::speed);
  text.sd_from = fixed(estimator::direction_sd_deg(*wind), digits::direction);
  return text;
}

template <class Height>
std::string height_text(const std::optional<Height>& height) {
  return height ? fixed(height->m, digits::metres) : "";
}

std::string word(std::string_view text) { return std::string(text); }

}  // namespace

Row wind_row(const estimator::WindPoint& p, estimator::Mode mode) {
  auto wind = wind_text(p.wind);
  return {{"time_s", seconds_text(p.time)},
          {"utc", utc_text(p.utc), true},
          {"lat_deg", p.place ? fixed(p.place->lat_deg, digits::degrees) : ""},
          {"lon_deg", p.place ? fixed(p.place->lon_deg, digits::degrees) : ""},
          {"height_msl_m", height_text(p.height_msl)},
          {"height_agl_m", height_text(p.height_agl)},
          {"wind_east_m_s", std::move(wind.east)},
          {"wind_north_m_s", std::move(wind.north)},
          {"sd_wind_east_m_s", std::move(wind.sd_east)},
          {"sd_wind_north_m_s", std::move(wind.sd_north)},
          {"cov_wind_east_north_m2_s2", std::move(wind.covariance)},
          {"wind_speed_m_s", std::move(wind.speed)},
          {"wind_from_deg", std::move(wind.from)},
          {"quality", word(estimator::name(p.quality)), true},
          {"mode", word(estimator::name(mode)), true},
          {"wind_up_m_s", p.vertical ? fixed(p.vertical->wind_up, digits::speed) : ""},
          {"sd_wind_up_m_s", p.vertical ? fixed(p.vertical->sd, digits::speed) : ""},
          {"drag_factor", p.drag ? fixed(p.drag->factor, 4) : ""},
          {"sd_drag_factor", p.drag ? fixed(p.drag->sd * p.drag->factor, 4) : ""},
          {"drag_updated", p.drag ? (p.drag->updated ? "1" : "0") : ""}};
}

Row profile_row(const profiles::Bin& b, profiles::LegName leg) {
  auto wind = wind_text(b.wind);
  return {{"leg", word(profiles::name(leg)), true},
          {"bin_bottom_m", fixed(b.bottom, digits::metres)},
          {"bin_top_m", fixed(b.top, digits::metres)},
          {"height_agl_m", height_text(b.height_agl)},
          {"height_msl_m", height_text(b.height_msl)},
          {"utc", utc_text(b.utc), true},
          {"lat_deg", b.place ? fixed(b.place->lat_deg, digits::degrees) : ""},
          {"lon_deg", b.place ? fixed(b.place->lon_deg, digits::degrees) : ""},
          {"wind_east_m_s", std::move(wind.east)},
          {"wind_north_m_s", std::move(wind.north)},
          {"sd_wind_east_m_s", std::move(wind.sd_east)},
          {"sd_wind_north_m_s", std::move(wind.sd_north)},
          {"wind_speed_m_s", std::move(wind.speed)},
          {"sd_wind_speed_m_s", std::move(wind.sd_speed)},
          {"wind_from_deg", std::move(wind.from)},
          {"sd_wind_from_deg", std::move(wind.sd_from)},
          {"sigma_east_m_s", b.sigma ? fixed(b.sigma->y(), digits::speed) : ""},
          {"sigma_north_m_s", b.sigma ? fixed(b.sigma->x(), digits::speed) : ""},
          {"samples", std::to_string(b.samples)},
          {"effective_samples", fixed(b.effective_samples, 2)},
          {"quality", word(estimator::name(b.quality)), true},
          {"cov_wind_east_north_m2_s2", std::move(wind.covariance)},
          {"sd_sampling_m_s", fixed(b.sd_sampling, digits::speed)},
          {"sd_calibration_m_s", fixed(b.sd_calibration, digits::speed)},
          {"sd_trim_m_s", fixed(b.sd_trim, digits::speed)},
          {"spread_from_deg", fixed(b.spread_from_deg, digits::direction)},
          {"sd_noise_m_s", fixed(b.sd_noise, digits::speed)},
          {"sd_climb_law_m_s", fixed(b.sd_climb_law, digits::speed)},
          {"resolution_m", fixed(b.resolution_m, digits::metres)},
          {"freedom", fixed(b.freedom, 3)},
          {"air_pressure_pa", fixed(b.pressure_pa, 0)},
          {"air_temperature_k", fixed(b.temperature_k, 2)},
          {"relative_humidity_pct", fixed(b.relative_humidity_pct, 1)},
          {"barometric_altitude_m", fixed(profiles::barometric_altitude(b), digits::metres)}};
}

}  // namespace quadsonde::product
