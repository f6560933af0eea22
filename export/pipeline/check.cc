#include "export/pipeline/check.h"

#include <fmt/format.h>

#include "export/csv/json.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

Json json_finding(const ingest::Finding& f) {
  return {{"class", ingest::name(f.fault)},
          {"id", f.id},
          {"what", f.sentence},
          {"size", json_number(f.size, 4)},
          {"improvement", f.improvement > 0 ? json_number(f.improvement, 3) : Json()},
          {"decides", f.decides},
          {"usual_causes", f.causes},
          {"alternatives", f.alternatives}};
}

Json json_axis(const ingest::FollowedAxis& a) {
  return {{"axis", a.axis},
          {"acceleration_rms_m_s2", json_number(a.acceleration_rms, 3)},
          {"correlation", json_number(a.correlation, 3)},
          {"correlation_exchanged", json_number(a.correlation_exchanged, 3)},
          {"tilt_share", json_number(a.gain, 3)},
          {"sd_tilt_share", json_number(a.gain_sd, 3)}};
}

Json json_noise(const ingest::ConsistencyReport& r) {
  return {{"measured_apart", r.noise_is_known},
          {"velocity_sd_m_s", json_number(r.noise.velocity_sd, 4)},
          {"acceleration_psd_m2_s3", json_number(r.noise.acceleration_psd, 7)},
          {"turbulence_sd_m_s", json_number(r.noise.turbulence_sd, 3)}};
}

}  // namespace

ingest::Result<CheckAnswer> check(const LoadedLog& log, const FlightPart& part, const VehicleInUse& vehicle,
                                  const ingest::ConsistencySettings& settings, const Control& control) {
  if (control.stopped()) return fail(stopped_problem());
  control.report("checking", 0.3);
  auto report = ingest::check_consistency(part.airborne(), ingest::drag_arguments(vehicle.vehicle), settings);
  if (!report) {
    auto problem = report.error();
    if (problem.where.file.empty()) problem.where.file = log.path.string();
    return fail(problem);
  }
  control.report("checking", 1);
  if (control.stopped()) return fail(stopped_problem());
  const double latency = ingest::drag_arguments(vehicle.vehicle).latency_s;
  CheckAnswer answer{log.path.filename().string(), log.sha256,   part.number, vehicle.from,
                     std::move(*report),           ingest::estimate_heading_offset(part.airborne(), latency),
                     part.problems};
  answer.problems.insert(answer.problems.end(), vehicle.notes.begin(), vehicle.notes.end());
  return answer;
}

std::optional<ingest::Problem> verdict_problem(const ingest::ConsistencyReport& report, const std::string& file) {
  const ingest::Where where{file, {}, {}, {}};
  switch (report.verdict) {
    case ingest::Verdict::consistent:
      return std::nullopt;
    case ingest::Verdict::inconsistent:
      return ingest::Problem{Kind::inconsistent,
                             "the telemetry contradicts itself or the equations of motion: " + report.because, where,
                             "see `quadsonde check` for the usual causes; correct the log's columns with --columns"};
    case ingest::Verdict::doubtful:
      return ingest::Problem{Kind::doubtful, "the telemetry fits the equations of motion badly: " + report.because,
                             where, "see `quadsonde check`"};
    case ingest::Verdict::cannot_be_shown:
      break;
  }
  return ingest::Problem{Kind::doubtful, "whether the telemetry is consistent cannot be shown: " + report.because,
                         where, "fly a square of 3 to 5 m/s and turn the nose steadily, to have the next log checked"};
}

std::optional<ingest::Problem> heading_problem(const std::optional<ingest::HeadingOffset>& heading,
                                               double heading_sd_deg, const InputSettings& input,
                                               const std::string& file) {
  if (!heading || !heading->determined(heading_sd_deg)) return std::nullopt;
  return ingest::Problem{
      Kind::doubtful,
      fmt::format("the motion says that every heading should be turned by {:+.1f} deg (+-{:.1f}, 1 sigma), and so "
                  "should the wind: declination missing or twice, compass or autopilot mounted askew",
                  heading->deg, heading->sd_deg),
      {file, {}, {}, {}},
      fmt::format("if another flight says the same, give --heading-offset-deg {:.1f}",
                  heading->deg + input.heading_offset_deg)};
}

std::string check_text(const CheckAnswer& answer) {
  auto text = fmt::format("{}, flight {}, drag of {}\n{}", answer.file, answer.flight, answer.vehicle_from,
                          ingest::to_text(answer.report));
  if (!answer.heading) return text + "Offset of all headings: this flight cannot show it.\n";
  return text + fmt::format("Offset of all headings by the motion: {:+.1f} deg, 1 sigma {:.1f} deg.\n",
                            answer.heading->deg, answer.heading->sd_deg);
}

std::string check_json(const CheckAnswer& answer) {
  const auto& r = answer.report;
  Json findings = Json::array(), axes = Json::array(), foretold = Json::array(), windows = Json::array();
  for (const auto& f : r.findings) findings.push_back(json_finding(f));
  for (const auto& a : r.axes) axes.push_back(json_axis(a));
  for (const auto& f : r.foretold)
    foretold.push_back({{"id", f.id}, {"what", f.sentence}, {"ratio", json_number(f.ratio, 3)}, {"shown", f.shown()}});
  for (const double ratio : r.windows) windows.push_back(json_number(ratio, 3));
  const auto known = [](const std::optional<double>& value) { return value ? json_number(value, 3) : Json(); };
  Json object = {{"schema", "quadsonde.check/1"},
                 {"source", {{"file", answer.file}, {"sha256", answer.sha256}, {"flight", answer.flight}}},
                 {"verdict", ingest::name(r.verdict)},
                 {"because", r.because},
                 {"chi2_per_dof", json_number(r.chi2_per_dof, 3)},
                 {"chi2_per_dof_restored", json_number(r.chi2_restored, 3)},
                 {"chi2_per_dof_integrated", known(r.chi2_integrated)},
                 {"chi2_per_dof_restored_integrated", known(r.chi2_restored_integrated)},
                 {"noise", json_noise(r)},
                 {"drag_linear_per_s", json_number(r.drag_linear_per_s, 4)},
                 {"trim_roll_deg", json_number(r.trim_roll_deg, 2)},
                 {"trim_pitch_deg", json_number(r.trim_pitch_deg, 2)}};
  if (answer.heading)
    object["heading_offset"] = {{"deg", json_number(answer.heading->deg, 2)},
                                {"sd_deg", json_number(answer.heading->sd_deg, 2)}};
  else
    object["heading_offset"] = Json();
  object["findings"] = findings;
  object["axes"] = axes;
  object["foretold"] = foretold;
  object["cannot_show"] = r.cannot_show;
  object["windows"] = windows;
  object["problems"] = json_problems(answer.problems);
  return json_text(object);
}

}  // namespace quadsonde::product
