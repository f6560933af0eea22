#include "estimator/smoother/wind_series.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadsonde::estimator {
namespace {

struct ReasonText {
  std::string_view name, sentence;
  Quality at_best;
};
constexpr ReasonText texts[] = {
    {"converging", "the wind is not yet told apart from the start values", Quality::none},
    {"no_attitude", "the attitude is missing around this instant", Quality::none},
    {"data_gap", "the velocity has a gap longer than the filter may coast", Quality::none},
    {"on_ground", "the vehicle is on the ground", Quality::none},
    {"tilt_over_45_deg", "the tilt is over 45 degrees, where the drag law does not hold", Quality::none},
    {"no_samples", "no sample with an estimate fell into this bin", Quality::none},
    {"fast_descent", "the descent is so fast that the drag law is not known", Quality::doubtful},
    {"trim_unobserved", "tilt trim unobserved: the heading never turned, so level lies within the trim's prior",
     Quality::doubtful},
    {"wide_uncertainty", "the uncertainty is above 1 m/s and above 30 % of the speed", Quality::doubtful},
    {"outside_airspeed_range", "the airspeed is outside the range seen while calibrating", Quality::doubtful},
    {"low_height", "below 3 m the ground changes the flow through the rotors", Quality::doubtful},
    {"model_fault", "jumps or rejected samples say that the model does not fit this flight", Quality::doubtful},
    {"crosstalk_heading", "the estimated wind turns with the nose", Quality::doubtful},
    {"crosstalk_velocity", "the estimated wind follows the vehicle's own velocity: the drag is not right",
     Quality::doubtful},
    {"few_samples", "fewer than 10 samples or one effective sample in this bin", Quality::doubtful},
    {"up_down_differ", "ascent and descent differ by more than their uncertainties", Quality::doubtful},
    {"inconsistent_telemetry", "the log contradicts itself or the equations of motion", Quality::bad},
    {"doubtful_telemetry", "the log fits the equations of motion badly", Quality::doubtful},
    {"noise_misfit", "the velocities scatter otherwise than the log states of their noise", Quality::doubtful},
    {"hold_out_failed", "velocities kept from the filter were not foretold within their uncertainty",
     Quality::doubtful},
    {"halves_differ", "the two halves of a level flight differ by more than their uncertainties", Quality::doubtful},
    {"height_drift", "the height drifted by more than half a bin during the flight", Quality::doubtful},
    {"uncalibrated", "no vehicle file: the drag is that of a class of vehicles", Quality::good},
    {"standard_density", "the air density is that of the standard atmosphere", Quality::good},
    {"accelerometer_differs", "the accelerometer tells of another airspeed than the attitude", Quality::doubtful},
    {"no_thrust_model", "no thrust model: without rotor speeds that give the thrust there is no vertical wind",
     Quality::none},
};
static_assert(std::size(texts) == static_cast<std::size_t>(Reason::count));

}  // namespace

std::string_view name(Quality quality) {
  constexpr std::string_view names[] = {"good", "doubtful", "bad", "none"};
  return names[static_cast<int>(quality)];
}
std::string_view name(Mode mode) {
  constexpr std::string_view names[] = {"smoothed", "causal", "classic"};
  return names[static_cast<int>(mode)];
}
std::string_view name(Reason reason) { return texts[static_cast<int>(reason)].name; }
std::string_view sentence(Reason reason) { return texts[static_cast<int>(reason)].sentence; }
Quality at_best(Reason reason) { return texts[static_cast<int>(reason)].at_best; }

Quality Reasons::at_best() const {
  Quality worst = Quality::good;
  for (const auto reason : list()) worst = std::max(worst, estimator::at_best(reason));
  return worst;
}

std::vector<Reason> Reasons::list() const {
  std::vector<Reason> all;
  for (int i = 0; i < static_cast<int>(Reason::count); ++i)
    if (has(static_cast<Reason>(i))) all.push_back(static_cast<Reason>(i));
  return all;
}

double speed_sd(const WindEstimate& wind) {
  const double speed = wind.v_NA_N.norm();
  const auto& C = wind.covariance;
  const double half_trace = 0.5 * C.trace();
  const double widest = half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - C.determinant()));
  if (speed * speed < 4 * widest) return std::sqrt(std::max(0.0, widest));
  const Eigen::Vector2d along = wind.v_NA_N / speed;
  return std::sqrt(std::max(0.0, along.dot(C * along)));
}

WindReport to_report(const WindEstimate& wind) {
  WindReport report;
  report.speed_m_s = wind.v_NA_N.norm();
  const double least = wind.has_covariance ? 2 * speed_sd(wind) : 0.5;
  if (report.speed_m_s <= 0 || report.speed_m_s < least) return report;
  double from = std::atan2(-wind.v_NA_N.y(), -wind.v_NA_N.x()) * 180 / std::numbers::pi;
  if (from <= 0) from += 360;
  report.from_deg = from;
  return report;
}

std::optional<double> direction_sd_deg(const WindEstimate& wind) {
  if (!wind.has_covariance || !to_report(wind).from_deg) return std::nullopt;
  const double speed = wind.v_NA_N.norm();
  const Eigen::Vector2d across(-wind.v_NA_N.y() / speed, wind.v_NA_N.x() / speed);
  return std::sqrt(std::max(0.0, across.dot(wind.covariance * across))) / speed * 180 / std::numbers::pi;
}

void add_to_all(WindSeries& series, Reasons reasons) {
  if (reasons.empty()) return;
  for (auto& point : series.points) {
    if (!std::holds_alternative<WindEstimate>(point.wind)) continue;
    point.reasons.add(reasons);
    point.quality = std::max(point.quality, reasons.at_best());
  }
}

}  // namespace quadsonde::estimator
