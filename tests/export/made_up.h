#pragma once
// A wind series and a profile that nobody estimated: known numbers for tests of what is written about them.
#include <cmath>
#include <numbers>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "profiles/profile.h"

namespace quadsonde::support {

inline Eigen::Vector2d toward_from(double speed, double from_deg) {
  const double a = (from_deg + 180) * std::numbers::pi / 180;
  return {speed * std::cos(a), speed * std::sin(a)};
}

inline estimator::WindEstimate estimate_of(double speed, double from_deg, double sd = 0.2) {
  estimator::WindEstimate wind;
  wind.v_NA_N = toward_from(speed, from_deg);
  wind.covariance << sd * sd, 0.1 * sd * sd, 0.1 * sd * sd, sd * sd;
  return wind;
}

inline estimator::WindPoint point_at(double time_s, double height, estimator::MaybeWind wind) {
  estimator::WindPoint p;
  p.time = ingest::LogTime{ingest::seconds(time_s).count()};
  p.utc = ingest::UtcTime{1'750'000'000'000'000'000} + ingest::seconds(time_s);
  p.place = ingest::GeoPoint{43.5657, 1.4815};
  p.height_msl = ingest::MslHeight{150 + height};
  p.height_agl = ingest::GroundHeight{height};
  p.wind = wind;
  p.quality =
      std::holds_alternative<estimator::WindEstimate>(wind) ? estimator::Quality::good : estimator::Quality::none;
  return p;
}

inline estimator::WindSeries made_up_series(int count = 400) {
  estimator::WindSeries series;
  for (int i = 0; i < count; ++i) {
    const double h = 10 + 230.0 * (i < count / 2 ? i : count - i) / (count / 2.0);
    if (i < 10)
      series.points.push_back(point_at(i * 0.1, h, estimator::NoEstimate{estimator::Reason::converging}));
    else
      series.points.push_back(point_at(i * 0.1, h, estimate_of(3 + h / 40 + 0.3 * std::sin(i * 0.2), 240 + h / 5)));
  }
  series.diagnostics.heading_index = 0.97;
  series.diagnostics.trim_estimated = true;
  series.diagnostics.sigma_u = 0.5;
  series.diagnostics.nis_mean = 2.01;
  series.diagnostics.air_density = 1.2;
  return series;
}

inline profiles::Bin bin_at(double bottom, double speed, double from_deg, double sd,
                            estimator::Quality quality = estimator::Quality::good) {
  profiles::Bin bin;
  bin.bottom = bottom, bin.top = bottom + 10;
  bin.height_agl = ingest::GroundHeight{bottom + 5.1};
  bin.height_msl = ingest::MslHeight{bottom + 155.1};
  bin.utc = ingest::UtcTime{1'750'000'000'000'000'000} + ingest::seconds(bottom);
  bin.place = ingest::GeoPoint{43.5657, 1.4815};
  bin.wind = estimate_of(speed, from_deg, sd);
  bin.sigma = Eigen::Vector2d(0.4, 0.5);
  bin.samples = 100;
  bin.effective_samples = 8.25;
  bin.quality = quality;
  if (quality == estimator::Quality::doubtful) bin.reasons.add(estimator::Reason::fast_descent);
  bin.sd_sampling = 0.3, bin.sd_calibration = 0.12, bin.sd_trim = 0.05, bin.spread_from_deg = 6.5;
  return bin;
}

/// Ascent, descent and both, 10 to 240 m, a jet at 180 m; one empty bin in the descent; the lowest descent bins
/// doubtful.
inline profiles::WindProfile made_up_profile(double wobble = 0.35) {
  profiles::WindProfile profile;
  profiles::Leg up{profiles::LegName::up, {}}, down{profiles::LegName::down, {}}, all{profiles::LegName::all, {}};
  for (int i = 1; i < 24; ++i) {
    const double z = 10.0 * i + 5;
    const double speed = 2 + 5 * (1 - std::exp(-z / 120)) + 2.5 * std::exp(-std::pow((z - 180) / 50, 2));
    const double from = 250 + 40 * (1 - std::exp(-z / 300));
    up.bins.push_back(bin_at(10.0 * i, speed + wobble * std::sin(i), from + 6 * std::sin(0.7 * i), 0.15));
    down.bins.push_back(bin_at(10.0 * i, speed - 0.1 + wobble * std::sin(1.7 * i + 2), from + 5 * std::cos(i), 0.25,
                               i < 6 ? estimator::Quality::doubtful : estimator::Quality::good));
    all.bins.push_back(bin_at(10.0 * i, speed, from, 0.12));
  }
  profiles::Bin empty;
  empty.bottom = 150, empty.top = 160;
  empty.height_agl = ingest::GroundHeight{155};
  empty.reasons.add(estimator::Reason::no_samples);
  down.bins[14] = empty;
  profile.legs = {up, down, all};
  profile.up_down = profiles::UpDownTest{41.2, 44, 0.59};
  return profile;
}

inline product::ProductSource made_up_source() {
  product::ProductSource source;
  source.file = "hover.ulg";
  source.sha256 = "00ff";
  source.flight = 2;
  source.vehicle = ingest::class_prior();
  source.settings = {
      {"bin_m", 10.0}, {"turbulence_sd_m_s", std::monostate{}}, {"jump_test", true}, {"vehicle", std::string("auto")}};
  source.problems = {{ingest::Kind::damaged,
                      "a record is cut",
                      {"/somewhere/hover.ulg", 17, {}, "vehicle_attitude"},
                      "nothing to do"}};
  return source;
}

}  // namespace quadsonde::support
