#include "export/csv/json.h"

#include <charconv>
#include <cmath>

#include "export/csv/numbers.h"
#include "export/csv/rows.h"
#include "export/csv/tables.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

/// The number that a text shows, so that JSON and CSV never differ in a digit.
Json number_of(const std::string& text) {
  if (text.empty()) return nullptr;
  if (text.find('.') == std::string::npos) {
    std::int64_t whole = 0;
    std::from_chars(text.data(), text.data() + text.size(), whole);
    return whole;
  }
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Json row_object(const Row& row, estimator::Reasons reasons) {
  Json object = Json::object();
  for (const auto& field : row)
    object[std::string(field.name)] = field.word && !field.text.empty() ? Json(field.text) : number_of(field.text);
  object["reasons"] = json_reasons(reasons);
  return object;
}

Json product_head(const char* schema, const ProductSource& source) {
  Json object = {{"schema", schema}, {"version", std::string(version())}, {"source", json_source(source)}};
  object["vehicle"] = json_vehicle(source.vehicle);
  object["settings"] = json_settings(source.settings);
  object["problems"] = json_problems(source.problems);
  return object;
}

/// A value without an estimate names its own reason first.
estimator::Reasons all_reasons(const estimator::MaybeWind& wind, estimator::Reasons reasons) {
  if (const auto* none = std::get_if<estimator::NoEstimate>(&wind)) reasons.add(none->reason);
  return reasons;
}

}  // namespace

Json json_number(std::optional<double> value, int digits) { return number_of(fixed(value, digits)); }

Json json_problem(const ingest::Problem& p) {
  Json where = Json::object();
  where["file"] = p.where.file.empty() ? Json() : Json(std::filesystem::path(p.where.file).filename().string());
  where["byte"] = p.where.byte ? Json(*p.where.byte) : Json();
  where["line"] = p.where.line ? Json(*p.where.line) : Json();
  where["topic"] = p.where.topic.empty() ? Json() : Json(p.where.topic);
  return {{"what", p.what}, {"where", where}, {"hint", p.hint}};
}

Json json_problems(const std::vector<ingest::Problem>& problems) {
  Json list = Json::array();
  for (const auto& problem : problems) list.push_back(json_problem(problem));
  return list;
}

Json json_vehicle(const ingest::Vehicle& v) {
  const auto sd = [&](ingest::DragParameter p) { return json_number(v.parameter_sd(p), 6); };
  const auto known = [](const std::optional<double>& value) { return value ? json_number(value, 6) : Json(); };
  Json object = {{"id", v.id}, {"name", v.name}, {"method", v.method}, {"mass_kg", known(v.mass_kg)}};
  object["linear_per_s"] = json_number(v.drag.linear, 6);
  object["sd_linear_per_s"] = sd(ingest::p_linear);
  object["quadratic_per_m"] = json_number(v.drag.quadratic, 6);
  object["sd_quadratic_per_m"] = sd(ingest::p_quadratic);
  object["climb_linear_s_per_m"] = json_number(v.drag.climb_linear, 6);
  object["sd_climb_linear_s_per_m"] = sd(ingest::p_climb_linear);
  object["climb_quadratic_s2_per_m2"] = json_number(v.drag.climb_quadratic, 6);
  object["sd_climb_quadratic_s2_per_m2"] = sd(ingest::p_climb_quadratic);
  object["latency_s"] = json_number(v.latency_s, 6);
  object["sd_latency_s"] = sd(ingest::p_latency);
  object["trim_roll_deg"] = json_number(v.trim_roll_deg, 4);
  object["sd_trim_roll_deg"] = sd(ingest::p_trim_roll);
  object["trim_pitch_deg"] = json_number(v.trim_pitch_deg, 4);
  object["sd_trim_pitch_deg"] = sd(ingest::p_trim_pitch);
  object["between_flights_rel_sd"] = json_number(v.between_flights_rel_sd, 4);
  object["air_density_kg_m3"] = json_number(v.air_density_kg_m3, 4);
  object["density_exponent"] = json_number(v.density_exponent, 4);
  return object;
}

Json json_settings(const std::vector<NamedSetting>& settings) {
  Json object = Json::object();
  for (const auto& [name, value] : settings)
    object[name] = std::visit(
        [](const auto& v) -> Json {
          if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::monostate>)
            return nullptr;
          else
            return v;
        },
        value);
  return object;
}

Json json_source(const ProductSource& source) {
  return {{"file", source.file}, {"sha256", source.sha256}, {"flight", source.flight}};
}

Json json_reasons(estimator::Reasons reasons) {
  Json list = Json::array();
  for (const auto reason : reasons.list()) list.push_back(std::string(estimator::name(reason)));
  return list;
}

Json json_diagnostics(const estimator::FlightDiagnostics& d) {
  Json object = {{"heading_index", json_number(d.heading_index, 4)}, {"trim_estimated", d.trim_estimated}};
  object["trim_roll_deg"] = json_number(d.trim_deg.x(), 4);
  object["trim_pitch_deg"] = json_number(d.trim_deg.y(), 4);
  object["sd_trim_roll_deg"] = json_number(d.trim_sd_deg.x(), 4);
  object["sd_trim_pitch_deg"] = json_number(d.trim_sd_deg.y(), 4);
  object["excitation_m_s"] = json_number(d.excitation, 4);
  object["turbulence_sd_m_s"] = json_number(d.sigma_u, 4);
  object["nis_mean"] = json_number(d.nis_mean, 4);
  object["jumps"] = d.jumps;
  object["rejected"] = d.rejected;
  object["restarts"] = d.restarts;
  object["jump_test_off"] = d.jump_test_off;
  object["crosstalk_heading_m_s"] = json_number(d.crosstalk_heading, 4);
  object["crosstalk_velocity"] = json_number(d.crosstalk_velocity, 4);
  object["sd_crosstalk_velocity"] = json_number(d.crosstalk_velocity_sd, 4);
  object["climb_linear_s_per_m"] = json_number(d.climb_linear, 4);
  object["sd_climb_linear_s_per_m"] = json_number(d.climb_linear_sd, 4);
  object["climb_estimated"] = d.climb_estimated;
  object["max_tilt_deg"] = json_number(d.max_tilt_deg, 2);
  object["max_airspeed_m_s"] = json_number(d.max_airspeed, 2);
  object["air_density_kg_m3"] = json_number(d.air_density, 4);
  object["standard_density"] = d.standard_density;
  object["log_likelihood"] = json_number(d.log_likelihood, 2);
  return object;
}

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string wind_json(const estimator::WindSeries& series, const ProductSource& source) {
  Json object = product_head("quadsonde.wind/1", source);
  object["diagnostics"] = json_diagnostics(series.diagnostics);
  Json rows = Json::array();
  for (const auto& point : series.points)
    rows.push_back(row_object(wind_row(point, series.mode), all_reasons(point.wind, point.reasons)));
  object["rows"] = std::move(rows);
  return json_text(object);
}

std::string profile_json(const profiles::WindProfile& profile, const ProductSource& source) {
  Json object = product_head("quadsonde.profile/1", source);
  object["datum"] = std::string(profiles::name(profile.datum));
  if (profile.up_down)
    object["up_down"] = {{"chi2", json_number(profile.up_down->chi2, 4)},
                         {"degrees_of_freedom", profile.up_down->degrees_of_freedom},
                         {"p_value", json_number(profile.up_down->p_value, 6)}};
  Json rows = Json::array();
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins)
      rows.push_back(row_object(profile_row(bin, leg.name), all_reasons(bin.wind, bin.reasons)));
  object["rows"] = std::move(rows);
  return json_text(object);
}

std::string json_list(const std::vector<std::string>& objects) {
  std::string text = "[\n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    auto object = objects[i];
    while (!object.empty() && object.back() == '\n') object.pop_back();
    text += object + (i + 1 < objects.size() ? ",\n" : "\n");
  }
  return text + "]\n";
}

}  // namespace quadsonde::product
