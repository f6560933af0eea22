#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "export/csv/json.h"
#include "export/report/plot.h"
#include "export/report/text_answer.h"
#include "export/report/tunnel_picture.h"

namespace quadsonde::product {
namespace {

using estimator::TunnelCalibration;
using estimator::TunnelRunFit;

constexpr double interval95 = 1.96;

double tilt_deg(double tangent) { return std::atan(tangent) * 180 / std::numbers::pi; }

std::string run_row(const TunnelRunFit& run) {
  const auto name = shortened(run.name, 21);
  const double still =
      100.0 * static_cast<double>(run.steady) / static_cast<double>(std::max<std::size_t>(1, run.seen));
  if (!run.drag)
    return fmt::format("{:<21} {:6.2f} {:>6} {:>7} {:7.2f} {:>7} {:>7} {:4.0f} {:5.0f}\n", name, run.wind_speed, "-",
                       "-", tilt_deg(run.amplitude), "-", "", run.turn_deg, still);
  return fmt::format("{:<21} {:6.2f} {:6.0f} {:7.0f} {:7.2f} {:7.3f} {:>7} {:4.0f} {:5.0f}\n", name, run.wind_speed,
                     run.wind_from_deg, run.fitted_from_deg, tilt_deg(run.amplitude), *run.drag,
                     fmt::format("+-{:.3f}", interval95 * *run.drag_sd).substr(0, 7), run.turn_deg, still);
}

std::string runs_table(const TunnelCalibration& c) {
  auto text = fmt::format("{:<21} {:>6} {:>6} {:>7} {:>7} {:>7} {:>7} {:>4} {:>5}\n", "run", "wind", "from", "by tilt",
                          "swing", "drag", "95 %", "turn", "still");
  text += fmt::format("{:<21} {:>6} {:>6} {:>7} {:>7} {:>7} {:>7} {:>4} {:>5}\n", "", "m/s", "deg", "deg", "deg", "1/s",
                      "1/s", "deg", "%");
  for (const auto& run : c.runs) text += run_row(run);
  return text;
}

/// A few airspeeds of the range, rounded for people.
std::vector<double> speeds_to_tell(const TunnelCalibration& c) {
  double low = 1e9, high = 0;
  for (const auto& run : c.runs)
    if (run.drag) low = std::min(low, std::round(run.wind_speed)), high = std::max(high, std::round(run.wind_speed));
  if (high <= low) return {high};
  if (high - low < 2) return {low, high};
  return {low, std::round((low + high) / 2), high};
}

std::string law_text(const TunnelCalibration& c) {
  const auto& v = c.vehicle;
  auto text = c.quadratic
                  ? fmt::format("Drag per mass: c = {:.4f} 1/s + {:.4f} 1/m |a|", v.drag.linear, v.drag.quadratic)
                  : fmt::format("Drag per mass: c = {:.4f} 1/s", v.drag.linear);
  text += fmt::format(" ({}).\n", c.quadratic ? "linear + quadratic" : "linear");
  for (const double speed : speeds_to_tell(c)) {
    const auto at = estimator::drag_at(v, speed);
    text += fmt::format("  at {:4.0f} m/s  {:.4f} +- {:.4f} 1/s (95 %, {:.1f} %)\n", speed, at.value,
                        interval95 * at.sd, 100 * interval95 * at.sd / at.value);
  }
  return text + wrapped("  Chosen: " + c.why_terms + ".", 79, 2) + "\n";
}

std::string error_text(const std::optional<double>& error) { return error ? fmt::format("{:+.2f}", *error) : "-"; }
std::string rms_text(const std::optional<double>& rms) { return rms ? fmt::format("{:.2f}", *rms) : "-"; }

std::string left_out_text(const TunnelCalibration& c) {
  auto text = fmt::format("Left out and predicted by the others, error in m/s:\n  {:>8} {:>10} {:>20}\n", "wind",
                          "linear", "linear + quadratic");
  for (const auto& left : c.left_out)
    text += fmt::format("  {:8.2f} {:>10} {:>20}\n", left.wind_speed, error_text(left.linear_error),
                        error_text(left.quadratic_error));
  return text + fmt::format("  {:>8} {:>10} {:>20}\n", "rms", rms_text(c.linear_left_out_rms),
                            rms_text(c.quadratic_left_out_rms));
}

std::string ends_text(const TunnelCalibration& c) {
  auto text = fmt::format("Starts of the common fit (linear + quadratic), {} of {} at the best end:\n", c.ends_at_best,
                          c.ends.size());
  text += fmt::format("  {:>17}    {:>17} {:>14}\n", "from 1/s, 1/m", "to 1/s, 1/m", "cost");
  for (const auto& end : c.ends)
    text += fmt::format("  {:8.3f} {:8.4f}    {:8.4f} {:8.5f} {:14.4f}{}\n", end.start_linear, end.start_quadratic,
                        end.linear, end.quadratic, end.cost, end.converged ? "" : "  not converged");
  return text;
}

std::string closing(const TunnelCalibration& c) {
  const auto& v = c.vehicle;
  const auto half = [&](ingest::DragParameter p) { return interval95 * v.parameter_sd(p); };
  auto text = fmt::format("Trim: roll {:+.2f} +- {:.2f} deg, pitch {:+.2f} +- {:.2f} deg.\n", v.trim_roll_deg,
                          half(ingest::p_trim_roll), v.trim_pitch_deg, half(ingest::p_trim_pitch));
  text += fmt::format("The wind comes {:+.1f} +- {:.1f} deg from the stated direction, by the tilt.\n",
                      c.flow_offset_deg, interval95 * c.flow_offset_sd_deg);
  text += wrapped(fmt::format(
      "Rank {} of {}; least certain: {}. Residual {:.3f} m/s2. From flight to flight the drag moves by some {:.0f} % "
      "more (1 sigma), which estimates add.",
      c.rank, c.parameters, c.weakest, v.residual_rms_m_s2.value_or(0), 100 * v.between_flights_rel_sd));
  return text + "\n";
}

Json json_run(const TunnelRunFit& run) {
  return {{"run", run.name},
          {"wind_speed_m_s", json_number(run.wind_speed, 4)},
          {"wind_speed_sd_m_s", json_number(run.wind_speed_sd, 4)},
          {"wind_from_deg", json_number(run.wind_from_deg, 2)},
          {"fitted_from_deg", run.drag ? json_number(run.fitted_from_deg, 2) : Json()},
          {"fitted_wind_speed_m_s", json_number(run.wind_estimate, 4)},
          {"fitted_wind_speed_sd_m_s", json_number(run.wind_estimate_sd, 4)},
          {"amplitude", json_number(run.amplitude, 6)},
          {"amplitude_sd", json_number(run.amplitude_sd, 6)},
          {"drag_per_s", json_number(run.drag, 6)},
          {"sd_drag_per_s", json_number(run.drag_sd, 6)},
          {"trim_roll_deg", json_number(tilt_deg(run.trim_roll), 4)},
          {"trim_pitch_deg", json_number(tilt_deg(run.trim_pitch), 4)},
          {"turn_deg", json_number(run.turn_deg, 0)},
          {"residual_rms_m_s2", json_number(run.residual_rms, 5)},
          {"samples", run.steady},
          {"samples_seen", run.seen},
          {"samples_per_independent", json_number(run.inflation, 3)},
          {"air_density_kg_m3", json_number(run.air_density, 4)}};
}

}  // namespace

std::string tunnel_answer(const TunnelCalibration& c) {
  const auto& v = c.vehicle;
  const auto title = fmt::format("{}: drag from {} runs in a known wind, {:.4g} kg, air density {:.3f} kg/m3",
                                 shortened(v.name.empty() ? v.id : v.name, 60), c.runs.size(), v.mass_kg.value_or(0),
                                 v.air_density_kg_m3);
  return wrapped(title) + "\n\n" + runs_table(c) + "\n" + law_text(c) + closing(c) + "\n" + left_out_text(c) + "\n" +
         ends_text(c);
}

std::string tunnel_json(const TunnelCalibration& c) {
  Json object = {{"schema", "quadsonde.calibration/1"}, {"vehicle", json_vehicle(c.vehicle)}};
  object["terms"] = c.quadratic ? "linear+quadratic" : "linear";
  object["why"] = c.why_terms;
  object["flow_offset_deg"] = json_number(c.flow_offset_deg, 3);
  object["sd_flow_offset_deg"] = json_number(c.flow_offset_sd_deg, 3);
  object["rank"] = c.rank;
  object["parameters"] = c.parameters;
  object["weakest"] = c.weakest;
  object["singular_values"] = Json::array();
  for (const double value : c.singular_values) object["singular_values"].push_back(json_number(value, 4));
  object["runs"] = Json::array();
  for (const auto& run : c.runs) object["runs"].push_back(json_run(run));
  object["left_out"] = Json::array();
  for (const auto& left : c.left_out)
    object["left_out"].push_back({{"wind_speed_m_s", json_number(left.wind_speed, 4)},
                                  {"linear_error_m_s", json_number(left.linear_error, 4)},
                                  {"quadratic_error_m_s", json_number(left.quadratic_error, 4)}});
  object["linear_left_out_rms_m_s"] = json_number(c.linear_left_out_rms, 4);
  object["quadratic_left_out_rms_m_s"] = json_number(c.quadratic_left_out_rms, 4);
  object["ends"] = Json::array();
  for (const auto& end : c.ends)
    object["ends"].push_back({{"start_linear_per_s", json_number(end.start_linear, 6)},
                              {"start_quadratic_per_m", json_number(end.start_quadratic, 6)},
                              {"linear_per_s", json_number(end.linear, 6)},
                              {"quadratic_per_m", json_number(end.quadratic, 6)},
                              {"cost", json_number(end.cost, 6)},
                              {"iterations", end.iterations},
                              {"converged", end.converged}});
  object["problems"] = json_problems(c.notes);
  return json_text(object);
}

}  // namespace quadsonde::product
