#include "export/report/free_flight_answer.h"

#include <fmt/format.h>

#include <cmath>

#include "estimator/calibration/tunnel.h"
#include "export/csv/json.h"
#include "export/report/plot.h"
#include "export/report/text_answer.h"

namespace quadsonde::product {
namespace {

using estimator::FreeFlightCalibration;

constexpr double interval95 = 1.96;

std::string flights_table(const FreeFlightCalibration& c) {
  auto text =
      fmt::format("{:<28} {:>8} {:>6} {:>9} {:>7} {:>8} {:>7}\n{:<28} {:>8} {:>6} {:>9} {:>7} {:>8} {:>7}\n", "flight",
                  "duration", "X", "nose", "windows", "density", "drag", "", "s", "m/s", "turned", "", "kg/m3", "1/s");
  for (const auto& run : c.runs) {
    const auto drag = !run.used ? "unused" : run.drag ? fmt::format("{:.3f}", *run.drag) : "used";
    text += fmt::format("{:<28} {:8.0f} {:6.2f} {:>9} {:7} {:8.3f} {:>7}\n", shortened(run.name, 28), run.seconds,
                        run.excitation, run.heading_index >= 0.4 ? "yes" : "no", run.windows, run.air_density, drag);
  }
  for (const auto& run : c.runs)
    if (!run.used) text += wrapped(fmt::format("  {}: {}.", shortened(run.name, 28), run.why_not), 79, 2) + "\n";
  return text;
}

std::string ways_text(const FreeFlightCalibration& c) {
  if (c.assumed.empty()) return "";
  auto text =
      fmt::format("Drag at {:.1f} m/s if the attitude errs by ...  (formal sd; latency; ln likelihood)\n", c.airspeed);
  for (const auto& a : c.assumed)
    text += fmt::format("  {:<32} {:.4f} 1/s  {:5.1f} %  {:6.3f} s  {:9.1f}{}\n", a.noise.words(), a.drag,
                        100 * a.drag_rel_sd, a.latency, a.log_likelihood, a.converged ? "" : "  not converged");
  if (c.referee)
    text += fmt::format("  {:<32} {:.4f} 1/s  {:5.1f} %  {:6.3f} s\n", "(least squares, no drag law)", c.referee->drag,
                        100 * c.referee->drag_sd / c.referee->drag, c.referee->latency);
  return text;
}

std::string law_text(const FreeFlightCalibration& c) {
  const auto& v = c.vehicle;
  auto text = c.quadratic
                  ? fmt::format("Drag per mass: c = {:.4f} 1/s + {:.4f} 1/m |a|", v.drag.linear, v.drag.quadratic)
                  : fmt::format("Drag per mass: c = {:.4f} 1/s", v.drag.linear);
  text += fmt::format(", air density {:.3f} kg/m3.\n", v.air_density_kg_m3);
  const double low = v.airspeed_range_m_s.x(), high = v.airspeed_range_m_s.y();
  for (const double speed : {low, 0.5 * (low + high), high}) {
    const auto at = estimator::drag_at(v, speed);
    const double next = std::hypot(at.sd, v.between_flights_rel_sd * at.value);
    text += fmt::format("  at {:4.1f} m/s  {:.4f} +- {:.4f} 1/s (95 %; +- {:.4f} for the next flight)\n", speed,
                        at.value, interval95 * at.sd, interval95 * next);
  }
  text += fmt::format("Latency {:.3f} +- {:.3f} s. Trim: roll {:+.2f} +- {:.2f}, pitch {:+.2f} +- {:.2f} deg{}.\n",
                      v.latency_s, interval95 * v.parameter_sd(ingest::p_latency), v.trim_roll_deg,
                      interval95 * v.parameter_sd(ingest::p_trim_roll), v.trim_pitch_deg,
                      interval95 * v.parameter_sd(ingest::p_trim_pitch), c.trim_determined ? "" : " (the prior's)");
  text += wrapped(fmt::format("Airspeeds {:.1f} to {:.1f} m/s, motion slower than 0.2 Hz. From flight to flight the "
                              "drag moves by some {:.0f} % more (1 sigma), which estimates add.",
                              low, high, 100 * v.between_flights_rel_sd)) +
          "\n";
  return text;
}

std::string moves_text(const FreeFlightCalibration& c, const std::string& updates) {
  if (c.moves.empty()) return "";
  auto text = fmt::format("{} is updated:\n", updates.empty() ? "The vehicle" : updates);
  for (const auto& m : c.moves) {
    const auto sigmas = m.before_sd > 0 ? fmt::format("{:+.1f} sigma", (m.after - m.before) / m.before_sd) : "";
    text += fmt::format("  {:<20} {:8.4f} +- {:.4f} -> {:8.4f} +- {:.4f} {:<5} {}\n", m.what, m.before, m.before_sd,
                        m.after, m.after_sd, m.unit, sigmas);
  }
  return text;
}

std::string identifiability_text(const FreeFlightCalibration& c) {
  const auto& id = c.identifiability;
  std::string text = "What these flights determine (1 sigma):\n";
  for (const auto& line : id.determined) text += "  " + line + "\n";
  if (id.rank > 0)
    text += wrapped(fmt::format("  Rank {} of {}, condition {:.0f}; least certain: {}.", id.rank, estimator::fit_count,
                                id.condition, id.weakest),
                    79, 2) +
            "\n";
  for (const auto& a : id.advice) {
    auto line = fmt::format("Next, for {}: {}", a.what, estimator::words(a.manoeuvre));
    if (a.simulated)
      line += fmt::format(". Simulated with this vehicle, that would bring it from +-{:.2g} to +-{:.2g} {}", a.now,
                          a.then, a.unit);
    text += wrapped(line + ".", 79, 0) + "\n";
  }
  return text;
}

std::string refusal_text(const FreeFlightCalibration& c) {
  auto text =
      wrapped(fmt::format("Refused: {}. There is no vehicle file; the drag stays at its prior, {:.3f} +- {:.3f} "
                          "1/s (1 sigma).",
                          *c.refused, c.vehicle.drag.linear, c.vehicle.parameter_sd(ingest::p_linear))) +
      "\n";
  if (c.seen)
    text +=
        wrapped(fmt::format("For information only: the flights seem to show {:.3f} 1/s with a formal sd of {:.0f} %, "
                            "which is not to be trusted.",
                            c.seen->drag, 100 * c.seen->formal_rel_sd)) +
        "\n";
  return text;
}

Json json_advice(const FreeFlightCalibration& c) {
  Json all = Json::array();
  for (const auto& a : c.identifiability.advice)
    all.push_back({{"for", a.what},
                   {"fly", estimator::words(a.manoeuvre)},
                   {"unit", a.unit},
                   {"sd_now", json_number(a.now, 4)},
                   {"sd_with_it", a.simulated ? json_number(a.then, 4) : Json()}});
  return all;
}

}  // namespace

std::string free_flight_answer(const FreeFlightCalibration& c, const std::string& updates) {
  const auto title = fmt::format("Drag from {} free flight{}, X {:.2f} m/s", c.runs.size(),
                                 c.runs.size() == 1 ? "" : "s", c.excitation);
  auto text = title + "\n\n" + flights_table(c) + "\n";
  if (const auto ways = ways_text(c); !ways.empty()) text += ways + "\n";
  text += (c.refused ? refusal_text(c) : law_text(c)) + "\n";
  if (const auto moves = moves_text(c, updates); !moves.empty()) text += moves + "\n";
  return text + identifiability_text(c);
}

std::string free_flight_json(const FreeFlightCalibration& c) {
  Json object = {{"schema", "quadsonde.calibration/1"}, {"method", "free-flight"}};
  object["refused"] = c.refused ? Json(*c.refused) : Json();
  object["vehicle"] = c.refused ? Json() : json_vehicle(c.vehicle);
  object["excitation_m_s"] = json_number(c.excitation, 3);
  object["airspeed_m_s"] = json_number(c.airspeed, 2);
  object["terms"] = c.quadratic ? "linear+quadratic" : "linear";
  object["drag_seen_per_s"] = c.seen ? json_number(c.seen->drag, 5) : Json();
  object["drag_rel_sd"] = c.seen ? json_number(c.seen->rel_sd, 4) : Json();
  object["drag_formal_rel_sd"] = c.seen ? json_number(c.seen->formal_rel_sd, 4) : Json();
  object["drag_half_range"] = c.seen ? json_number(c.seen->half_range, 4) : Json();
  object["runs"] = Json::array();
  for (const auto& run : c.runs)
    object["runs"].push_back({{"flight", run.name},
                              {"duration_s", json_number(run.seconds, 1)},
                              {"excitation_m_s", json_number(run.excitation, 3)},
                              {"heading_index", json_number(run.heading_index, 3)},
                              {"windows", run.windows},
                              {"air_density_kg_m3", json_number(run.air_density, 4)},
                              {"used", run.used},
                              {"why_not", run.used ? Json() : Json(run.why_not)},
                              {"drag_per_s", json_number(run.drag, 5)},
                              {"sd_drag_per_s", json_number(run.drag_sd, 5)}});
  object["assumed"] = Json::array();
  for (const auto& a : c.assumed)
    object["assumed"].push_back({{"tilt_sd_deg", json_number(a.noise.sd_deg, 2)},
                                 {"tilt_correlation_s", json_number(a.noise.correlation_s, 2)},
                                 {"drag_per_s", json_number(a.drag, 5)},
                                 {"formal_rel_sd", json_number(a.drag_rel_sd, 4)},
                                 {"latency_s", json_number(a.latency, 4)},
                                 {"log_likelihood", json_number(a.log_likelihood, 2)},
                                 {"converged", a.converged}});
  object["referee_drag_per_s"] = c.referee ? json_number(c.referee->drag, 5) : Json();
  const auto& id = c.identifiability;
  object["singular_values"] = Json::array();
  for (const double value : id.singular_values) object["singular_values"].push_back(json_number(value, 3));
  object["rank"] = id.rank;
  object["weakest"] = id.weakest;
  object["determined"] = id.determined;
  object["advice"] = json_advice(c);
  object["moves"] = Json::array();
  for (const auto& m : c.moves)
    object["moves"].push_back({{"what", m.what},
                               {"unit", m.unit},
                               {"before", json_number(m.before, 6)},
                               {"sd_before", json_number(m.before_sd, 6)},
                               {"after", json_number(m.after, 6)},
                               {"sd_after", json_number(m.after_sd, 6)}});
  object["problems"] = json_problems(c.notes);
  return json_text(object);
}

}  // namespace quadsonde::product
