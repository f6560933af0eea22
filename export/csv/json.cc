#include "export/csv/json.h"

#include <charconv>
#include <cmath>

#include "export/csv/numbers.h"
#include "export/csv/rows.h"
#include "export/csv/tables.h"
#include "export/version.h"
#include "profiles/levels.h"

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

/// A value without an estimate names its own reason first.
Json row_object(const Row& row, const estimator::MaybeWind& wind, estimator::Reasons reasons) {
  if (const auto* none = std::get_if<estimator::NoEstimate>(&wind)) reasons.add(none->reason);
  Json object = Json::object();
  for (const auto& field : row)
    object[std::string(field.name)] = field.word && !field.text.empty() ? Json(field.text) : number_of(field.text);
  object["reasons"] = json_reasons(reasons);
  return object;
}

}  // namespace

Json json_head(std::string_view schema, const ProductSource& source) {
  Json object = {
      {"schema", std::string(schema)}, {"version", std::string(version())}, {"source", json_source(source)}};
  object["vehicle"] = json_vehicle_of(source);
  object["settings"] = json_settings(source.settings);
  object["problems"] = json_problems(source.problems);
  return object;
}

Json json_row(const estimator::WindPoint& point, estimator::Mode mode) {
  return row_object(wind_row(point, mode), point.wind, point.reasons);
}
Json json_row(const profiles::Bin& bin, profiles::LegName leg) {
  return row_object(profile_row(bin, leg), bin.wind, bin.reasons);
}

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

Json json_vehicle_of(const ProductSource& source) {
  auto object = json_vehicle(source.vehicle);
  if (source.vehicle_file.empty()) return object;
  object["file"] = source.vehicle_file;
  object["sha256"] = source.vehicle_sha256;
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
  Json object = {{"file", source.file}, {"sha256", source.sha256}, {"flight", source.flight}};
  if (!source.made_heights.empty()) object["heights"] = source.made_heights;
  return object;
}

Json json_reasons(estimator::Reasons reasons) {
  Json list = Json::array();
  for (const auto reason : reasons.list()) list.push_back(std::string(estimator::name(reason)));
  return list;
}

namespace {

/// Null where the drag was not to be learned; `updated_s` 0: factor and sd are the prior.
Json json_online_drag(const std::optional<estimator::OnlineDrag>& drag) {
  if (!drag) return nullptr;
  return {{"factor", json_number(drag->factor, 4)},
          {"sd_factor", json_number(drag->sd * drag->factor, 4)},
          {"latency_s", json_number(drag->latency, 4)},
          {"sd_latency_s", json_number(drag->latency_sd, 4)},
          {"updated_s", json_number(drag->seconds, 1)},
          {"first_time_s", drag->first ? Json::parse(seconds_text(*drag->first)) : Json()},
          {"last_time_s", drag->last ? Json::parse(seconds_text(*drag->last)) : Json()}};
}

/// Null where nobody asked; `none` names the reason where there is no vertical wind.
Json json_vertical(const std::optional<estimator::VerticalWind>& vertical) {
  if (!vertical) return nullptr;
  if (vertical->none) return {{"none", std::string(estimator::name(vertical->none->reason))}, {"why", vertical->why}};
  return {{"axial_drag_per_s", json_number(vertical->axial, 4)},
          {"sd_axial_drag_per_s", json_number(vertical->axial_sd, 4)},
          {"axial_drag_from_flight", vertical->axial_from_flight},
          {"sd_level_m_s", json_number(vertical->level_sd, 3)}};
}

}  // namespace

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
  object["climb_linear_s_per_m"] = json_number(d.climb_linear, 4);
  object["sd_climb_linear_s_per_m"] = json_number(d.climb_linear_sd, 4);
  object["climb_estimated"] = d.climb_estimated;
  object["max_tilt_deg"] = json_number(d.max_tilt_deg, 2);
  object["max_airspeed_m_s"] = json_number(d.max_airspeed, 2);
  object["air_density_kg_m3"] = json_number(d.air_density, 4);
  object["standard_density"] = d.standard_density;
  object["log_likelihood"] = json_number(d.log_likelihood, 2);
  Json checks = Json::array();
  for (const auto& check : d.self_checks)
    checks.push_back({{"name", check.name},
                      {"what", check.sentence},
                      {"value", json_number(check.value, 4)},
                      {"sd", json_number(check.sd, 4)},
                      {"limit", json_number(check.limit, 4)},
                      {"judged", check.judged},
                      {"passed", check.judged ? Json(check.passed) : Json()}});
  object["self_checks"] = checks;
  object["online_drag"] = json_online_drag(d.online_drag);
  object["vertical_wind"] = json_vertical(d.vertical);
  return object;
}

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string wind_json(const estimator::WindSeries& series, const ProductSource& source) {
  Json object = json_head("quadsonde.wind/1", source);
  object["diagnostics"] = json_diagnostics(series.diagnostics);
  Json rows = Json::array();
  for (const auto& point : series.points)
    rows.push_back(json_row(point, series.mode));
  object["rows"] = std::move(rows);
  return json_text(object);
}

Json json_found_legs(const profiles::WindProfile& profile) {
  Json list = Json::array();
  for (const auto& leg : profile.found)
    list.push_back({{"kind", std::string(profiles::name(leg.kind))},
                    {"from_time_s", Json::parse(seconds_text(leg.from))},
                    {"to_time_s", Json::parse(seconds_text(leg.to))},
                    {"lowest_m", json_number(leg.lowest, 2)},
                    {"highest_m", json_number(leg.highest, 2)},
                    {"climb_m_s", json_number(leg.climb, 3)},
                    {"speed_m_s", json_number(leg.speed, 3)}});
  return list;
}

Json json_up_down(const profiles::WindProfile& profile) {
  if (!profile.up_down) return nullptr;
  return {{"chi2", json_number(profile.up_down->chi2, 4)},
          {"degrees_of_freedom", profile.up_down->degrees_of_freedom},
          {"p_value", json_number(profile.up_down->p_value, 6)}};
}

namespace {

Json json_uncertain(const profiles::Uncertain& u) {
  return {{"value", json_number(u.value, 5)}, {"sd", json_number(u.sd, 5)}};
}

Json json_level(const profiles::LevelWind& level) {
  const auto report = level.wind ? estimator::to_report(*level.wind) : estimator::WindReport{};
  const bool known = level.wind && level.wind->has_covariance;
  return {{"height_m", json_number(level.height, 2)},
          {"wind_east_m_s", level.wind ? json_number(level.wind->v_NA_N.y(), 4) : Json()},
          {"wind_north_m_s", level.wind ? json_number(level.wind->v_NA_N.x(), 4) : Json()},
          {"wind_speed_m_s", level.wind ? json_number(report.speed_m_s, 4) : Json()},
          {"sd_wind_speed_m_s", known ? json_number(estimator::speed_sd(*level.wind), 4) : Json()},
          {"wind_from_deg", json_number(report.from_deg, 2)},
          {"sd_wind_from_deg", known ? json_number(estimator::direction_sd_deg(*level.wind), 2) : Json()}};
}

}  // namespace

Json json_levels(const profiles::WindProfile& profile) {
  const auto levels = profiles::describe_levels(profile);
  Json object = {
      {"hub_height_m", json_number(profile.hub_height, 2)}, {"winds", Json::array()}, {"shears", Json::array()}};
  for (const auto& level : levels.winds) object["winds"].push_back(json_level(level));
  for (const auto& shear : levels.shears)
    object["shears"].push_back({{"lower_m", json_number(shear.lower, 2)},
                                {"upper_m", json_number(shear.upper, 2)},
                                {"shear_per_s", json_uncertain(shear.shear)},
                                {"veer_deg", shear.veer ? json_uncertain(*shear.veer) : Json()}});
  object["power_law"] = levels.power ? Json{{"exponent", json_uncertain(levels.power->exponent)},
                                            {"speed_10m_m_s", json_uncertain(levels.power->speed_10m)},
                                            {"bins", levels.power->bins}}
                                     : Json();
  object["log_law"] = levels.log ? Json{{"friction_velocity_m_s", json_uncertain(levels.log->friction_velocity)},
                                        {"log_roughness", json_uncertain(levels.log->log_roughness)},
                                        {"roughness_m", json_number(levels.log->roughness, 6)},
                                        {"bins", levels.log->bins}}
                                 : Json();
  object["jet"] = levels.jet ? Json{{"height_m", json_number(levels.jet->height, 2)},
                                    {"speed_m_s", json_uncertain(levels.jet->speed)},
                                    {"drop_above_m_s", json_number(levels.jet->drop_above, 3)},
                                    {"probability", json_number(levels.jet->probability, 3)}}
                             : Json();
  object["bulk_richardson"] = levels.richardson ? Json{{"lower_m", json_number(levels.richardson->lower, 2)},
                                                       {"upper_m", json_number(levels.richardson->upper, 2)},
                                                       {"number", json_uncertain(levels.richardson->number)}}
                                                : Json();
  return object;
}

namespace {

Json json_optimal(const profiles::OptimalDetails& optimal) {
  Json kernel = Json::array();
  for (Eigen::Index i = 0; i < optimal.kernel.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < optimal.kernel.cols(); ++j) row.push_back(json_number(optimal.kernel(i, j), 4));
    kernel.push_back(std::move(row));
  }
  Json heights = Json::array();
  for (const double z : optimal.height) heights.push_back(json_number(z, 2));
  return {{"degrees_of_freedom", json_number(optimal.degrees_of_freedom, 3)},
          {"height_m", heights},
          {"averaging_kernel", kernel}};
}

}  // namespace

std::string profile_json(const profiles::WindProfile& profile, const ProductSource& source) {
  Json object = json_head("quadsonde.profile/1", source);
  object["datum"] = std::string(profiles::name(profile.datum));
  if (profile.up_down) object["up_down"] = json_up_down(profile);
  object["method"] = std::string(profiles::name(profile.method));
  object["notes"] = json_problems(profile.notes);
  object["legs"] = json_found_legs(profile);
  object["levels"] = json_levels(profile);
  if (profile.optimal) object["optimal"] = json_optimal(*profile.optimal);
  Json rows = Json::array();
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins)
      rows.push_back(json_row(bin, leg.name));
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
