#include "ingest/motion/consistency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ingest/flight/rotation.h"
#include "ingest/motion/fault_search.h"
#include "ingest/motion/kinematics.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Vector2d;

constexpr double degree = std::numbers::pi / 180;

Finding finding_of(const FaultCandidate& candidate, double size) {
  Finding f;
  f.fault = candidate.fault;
  f.id = candidate.id;
  f.sentence = candidate.sentence;
  f.causes = usual_causes(candidate.fault);
  f.size = size;
  return f;
}

Finding finding(FaultClass fault, std::string id, std::string sentence, double size, bool decides) {
  return {fault, std::move(id), std::move(sentence), usual_causes(fault), {}, size, 0, decides};
}

void add_velocity_against_position(const Flight& flight, std::vector<Finding>& out, bool& confirmed) {
  const auto seen = velocity_against_position(flight);
  if (!seen || seen->sd > 0.1) return;
  const auto& m = seen->map;
  const Eigen::Matrix2d square = m.transpose() * m;
  const double scale = std::sqrt(square.trace() / 2);
  const bool rigid = (square / (scale * scale) - Eigen::Matrix2d::Identity()).norm() < 0.4;
  const double off = (m - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff();
  confirmed = off < 0.15;
  if (off < std::max(0.2, 5 * seen->sd)) return;
  const bool reflected = m.determinant() < 0;
  const double angle = std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1)) / degree;
  std::string what;
  if (!rigid)
    what = "it is not north and east, turned, exchanged or scaled";
  else if (reflected)
    what = std::abs(m(0, 1) + m(1, 0)) > std::abs(m(0, 0) - m(1, 1)) ? "north and east are exchanged"
                                                                     : "one axis has the wrong sign";
  else if (std::abs(angle) > 8)
    what = fmt::format("it is turned by {:.0f} degrees", angle);
  else
    what = scaled_by(1 / scale, false).sentence;
  out.push_back(finding(
      FaultClass::velocity_against_position, "velocity-against-position",
      fmt::format("the velocity does not add up to the change of position ({:.2f}, {:.2f}; {:.2f}, {:.2f} instead "
                  "of 1, 0; 0, 1): {}",
                  m(0, 0), m(0, 1), m(1, 0), m(1, 1), what),
      scale, true));
}

void add_vertical(const Flight& flight, std::vector<Finding>& out) {
  const auto seen = vertical_against_height(flight);
  if (!seen || seen->sd > 0.1 || std::abs(seen->slope - 1) < std::max(0.25, 5 * seen->sd)) return;
  const auto what = seen->slope < -0.5 ? std::string("up and down are exchanged")
                    : seen->slope < 0.05
                        ? std::string("the two have nothing in common")
                        : fmt::format("the vertical velocity is {:.2f} times too large", 1 / seen->slope);
  out.push_back(
      finding(FaultClass::vertical_velocity, "vertical-velocity",
              fmt::format("the height changes by {:.2f} times what the down velocity says: {}", seen->slope, what),
              seen->slope, true));
}

void add_standstill(const Flight& flight, std::vector<Finding>& out) {
  const double zeros = leading_zeros(flight);
  if (zeros > 1)
    out.push_back(finding(FaultClass::zeros_before_fix, "zeros-before-fix",
                          fmt::format("the velocity is exactly zero for the first {:.1f} s", zeros), zeros, false));
  double stuck = 0;
  std::string where;
  for (const auto& stretch : frozen_stretches(flight, 1.0)) {
    if (stretch.stream == "velocity" && stretch.from <= 0 && zeros > 1) continue;
    stuck += stretch.to - stretch.from;
    if (where.empty()) where = fmt::format("{} from {:.1f} to {:.1f} s", stretch.stream, stretch.from, stretch.to);
  }
  const auto span = time_span(flight);
  const double whole = span ? to_seconds(span->second - span->first) : 0;
  if (stuck > 0)
    out.push_back(finding(FaultClass::frozen_stream, "frozen-stream",
                          fmt::format("the {} repeats one value; {:.1f} s altogether", where, stuck), stuck,
                          stuck > 0.3 * whole));
}

/// Tilts that no multirotor flies for long: angles in degrees that were read as radians wrap around.
void add_steep(const Telemetry& telemetry, std::vector<Finding>& out) {
  if (telemetry.steep < 0.2) return;
  out.push_back(
      finding(FaultClass::tilt_scale, "tilt-impossible",
              fmt::format("the vehicle is tilted beyond 60 degrees {:.0f} % of the time: degrees read as radians",
                          100 * telemetry.steep),
              telemetry.steep, true));
}

/// While the nose does not turn, a trim is a wind and nobody can tell them apart.
bool heading_turned(const Telemetry& telemetry) {
  Vector2d mean = Vector2d::Zero();
  for (const double psi : telemetry.heading)
    mean += Vector2d(std::cos(psi), std::sin(psi)) / static_cast<double>(telemetry.heading.size());
  return std::sqrt(std::max(0.0, 1 - mean.squaredNorm())) > 0.4;
}

void add_trim(const ConsistencyReport& report, const DragArguments& drag, std::vector<Finding>& out) {
  const double off = std::hypot(report.trim_roll_deg - drag.trim_roll_deg, report.trim_pitch_deg - drag.trim_pitch_deg);
  if (off < std::max(1.5 * drag.trim_sd_deg, 1.5)) return;
  out.push_back(finding(FaultClass::tilt_offset, "tilt-offset",
                        fmt::format("level flight needs a roll of {:.1f} and a pitch of {:.1f} degrees",
                                    report.trim_roll_deg, report.trim_pitch_deg),
                        off, false));
}

/// An axis whose tilt, where there is motion enough, takes no part in it.
void add_unrelated(const ConsistencyReport& report, std::vector<Finding>& out) {
  for (const auto& axis : report.axes) {
    if (axis.acceleration_rms < 0.2 || axis.gain + 3 * axis.gain_sd > 0.4) continue;
    out.push_back(finding(
        FaultClass::attitude_unrelated, "attitude-unrelated-" + axis.axis,
        fmt::format("the {} tilt does not move the vehicle {}: its share is {:.2f} +- {:.2f} where it must be 1 "
                    "(correlation with the acceleration {:.2f})",
                    axis.axis, axis.axis, axis.gain, axis.gain_sd, axis.correlation),
        axis.gain, true));
  }
}

/// Turbulence that was found in the residual takes up whatever else is wrong; too much of it is no turbulence.
void add_unexplained(const ConsistencyReport& report, const DragArguments& drag, std::vector<Finding>& out) {
  if (!report.noise_is_known || drag.turbulence_sd || report.noise.turbulence_sd < 3 || !out.empty()) return;
  out.push_back(finding(FaultClass::unexplained, "unexplained",
                        fmt::format("what is left would need a turbulence of {:.1f} m/s", report.noise.turbulence_sd),
                        report.noise.turbulence_sd, false));
}

void foretell(const FaultSearch& search, ConsistencyReport& report) {
  report.foretold = search.foretold();
  for (const auto& fault : report.foretold)
    if (!fault.shown()) report.cannot_show.push_back(fault.sentence);
  report.cannot_show.push_back("a wrong mass: it only enters through the drag");
  report.cannot_show.push_back("a heading that is off by less than about 10 degrees");
}

/// Could this flight have shown that the attitude's axes and signs are wrong?
bool shows_axes(const ConsistencyReport& report) {
  const auto shown = [&](const char* id) {
    return std::any_of(report.foretold.begin(), report.foretold.end(),
                       [&](const auto& f) { return f.id == id && f.shown(); });
  };
  // A hover is no evidence, however well its small tilts fit small motions: what drives both is the controller.
  const bool moves = std::any_of(report.axes.begin(), report.axes.end(),
                                 [](const auto& axis) { return axis.acceleration_rms > 0.15; });
  return moves && shown("tilt-sign") && shown("roll-pitch-exchanged");
}

void judge(ConsistencyReport& report) {
  const double ratio = report.chi2_per_dof / std::max(report.chi2_restored, 1e-9);
  const auto decisive =
      std::find_if(report.findings.begin(), report.findings.end(), [](const auto& f) { return f.decides; });
  const double limit_doubtful = report.noise_is_known ? 1.1 : 1.4, limit = report.noise_is_known ? 1.5 : 2.0;
  const double judged = report.noise_is_known ? report.chi2_per_dof : ratio;
  const auto has = [&](FaultClass fault) {
    return std::any_of(report.findings.begin(), report.findings.end(), [&](const auto& f) { return f.fault == fault; });
  };
  if (decisive != report.findings.end()) {
    report.verdict = Verdict::inconsistent;
    report.because = decisive->sentence;
  } else if (judged > limit) {
    report.verdict = Verdict::inconsistent;
    report.because =
        fmt::format("the motion misses the velocity by {:.2f} times what noise and turbulence allow", judged);
  } else if (judged > limit_doubtful || has(FaultClass::unexplained)) {
    report.verdict = Verdict::doubtful;
    report.because = report.findings.empty() ? fmt::format("chi2 per degree of freedom is {:.2f}", judged)
                                             : report.findings.front().sentence;
  } else if (!shows_axes(report)) {
    report.verdict = Verdict::cannot_be_shown;
    report.because =
        "this flight moves too little, or only in ways that many faults would not change, to be evidence of "
        "consistency";
  } else {
    report.verdict = Verdict::consistent;
    report.because = "the equations of motion explain the velocity, and the faults tried would have shown";
  }
}

std::optional<Problem> unusable(const Flight& flight) {
  if (flight.attitude.size() < 20)
    return Problem{Kind::missing,
                   "the flight has no attitude to integrate over",
                   {{}, {}, {}, flight.attitude.source},
                   "log the attitude"};
  if (flight.velocity.size() < 20)
    return Problem{Kind::missing,
                   "the flight has no velocity to compare with",
                   {{}, {}, {}, flight.velocity.source},
                   "log the velocity"};
  return std::nullopt;
}

}  // namespace

std::string name(Verdict verdict) {
  switch (verdict) {
    case Verdict::consistent:
      return "consistent";
    case Verdict::doubtful:
      return "doubtful";
    case Verdict::inconsistent:
      return "inconsistent";
    case Verdict::cannot_be_shown:
      break;
  }
  return "cannot be shown";
}

DragArguments drag_arguments(const Vehicle& vehicle) {
  DragArguments out;
  out.drag = vehicle.drag;
  const double c = std::max(vehicle.drag.linear + 3 * vehicle.drag.quadratic, 0.02);
  const double formal =
      std::sqrt(vehicle.covariance(p_linear, p_linear) + 9 * vehicle.covariance(p_quadratic, p_quadratic)) / c;
  out.drag_log_sd = std::clamp(std::hypot(formal, vehicle.between_flights_rel_sd), 0.02, 0.5);
  out.latency_s = vehicle.is_prior() ? 0 : vehicle.latency_s;
  out.trim_roll_deg = vehicle.trim_roll_deg;
  out.trim_pitch_deg = vehicle.trim_pitch_deg;
  out.trim_sd_deg = std::hypot(0.3, std::max(vehicle.parameter_sd(p_trim_roll), vehicle.parameter_sd(p_trim_pitch)));
  return out;
}

Result<ConsistencyReport> check_consistency(const Flight& flight, const DragArguments& drag,
                                            const ConsistencySettings& settings) {
  if (const auto problem = unusable(flight)) return fail(*problem);
  const auto telemetry = std::make_shared<const Telemetry>(telemetry_of(flight));
  auto windows = shooting_windows(*telemetry, settings.window_s, static_cast<std::size_t>(settings.most_windows));
  if (windows.empty())
    return fail(Kind::no_answer, "not ten seconds of attitude and velocity without a hole", {},
                "a longer flight, or a log with fewer gaps");
  ConsistencyReport report;
  bool confirmed = false;
  add_steep(*telemetry, report.findings);
  add_velocity_against_position(flight, report.findings, confirmed);
  FaultSearch search(telemetry, std::move(windows), drag, settings, confirmed);
  if (!search.run()) return fail(Kind::no_answer, "the equations of motion could not be fitted to this log");
  search.fill(report);
  // A tilt that wraps around has no size to be fitted.
  if (const auto best = search.best(); best && telemetry->steep < 0.2) {
    auto found = finding_of(best->candidate, best->size);
    found.improvement = report.chi2_per_dof / report.chi2_restored;
    found.alternatives = best->alternatives;
    found.decides = found.improvement > (report.noise_is_known ? 1.5 : 2.0);
    report.findings.insert(report.findings.begin(), found);
  }
  add_unrelated(report, report.findings);
  add_vertical(flight, report.findings);
  add_standstill(flight, report.findings);
  if (heading_turned(*telemetry)) add_trim(report, drag, report.findings);
  add_unexplained(report, drag, report.findings);
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const auto& a, const auto& b) { return a.decides > b.decides; });
  foretell(search, report);
  judge(report);
  return report;
}

std::string to_text(const ConsistencyReport& r) {
  std::string out = fmt::format("{}: {}\n", name(r.verdict), r.because);
  out += fmt::format(
      "chi2 per degree of freedom {:.2f}, {:.2f} restored ({} windows; noise {}: velocity {:.3f} m/s, turbulence "
      "{:.2f} m/s)\n",
      r.chi2_per_dof, r.chi2_restored, r.windows.size(),
      r.noise_is_known ? "measured" : "not separable, so only the ratio counts", r.noise.velocity_sd,
      r.noise.turbulence_sd);
  if (r.chi2_integrated && r.chi2_restored_integrated)
    out +=
        fmt::format("integrated by CVODES: {:.2f}, restored {:.2f}\n", *r.chi2_integrated, *r.chi2_restored_integrated);
  for (const auto& axis : r.axes)
    out += fmt::format(
        "{} tilt against acceleration: rms {:.2f} m/s2, correlation {:.2f} (exchanged {:.2f}), share {:.2f} +- "
        "{:.2f}\n",
        axis.axis, axis.acceleration_rms, axis.correlation, axis.correlation_exchanged, axis.gain, axis.gain_sd);
  for (const auto& f : r.findings) {
    out += fmt::format("{}: {}", name(f.fault), f.sentence);
    if (f.improvement > 0) out += fmt::format(" (undone, chi2 is {:.2f} times smaller)", f.improvement);
    out += '\n';
    for (const auto& other : f.alternatives) out += fmt::format("  or, no worse on this flight: {}\n", other);
    for (const auto& cause : f.causes) out += fmt::format("  usual cause: {}\n", cause);
  }
  for (const auto& text : r.cannot_show) out += fmt::format("this flight cannot show: {}\n", text);
  return out;
}

}  // namespace quadsonde::ingest
