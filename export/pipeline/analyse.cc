#include "export/pipeline/analyse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "export/pipeline/check.h"
#include "export/pipeline/problems.h"
#include "profiles/air_levels.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;

/// Collects settings by name; what takes a name and a value may be followed by anything.
struct Collector {
  std::vector<NamedSetting>& settings;
  template <class... More>
  void operator()(const char* name, const std::string& value, const More&...) {
    settings.push_back({name, value});
  }
  template <class... More>
  void operator()(const char* name, const std::string& value, std::initializer_list<const char*>, const More&...) {
    settings.push_back({name, value});
  }
  template <class... More>
  void operator()(const char* name, bool value, const More&...) {
    settings.push_back({name, value});
  }
  template <class... More>
  void operator()(const char* name, double value, const More&...) {
    settings.push_back({name, value});
  }
  template <class... More>
  void operator()(const char* name, const std::optional<double>& value, const More&...) {
    settings.push_back({name, value ? SettingValue(*value) : SettingValue()});
  }
};

FlightTitle title_of(const LoadedLog& log, const FlightPart& part) {
  FlightTitle title;
  title.file = log.path.filename().string();
  title.flight = part.number;
  title.flights = static_cast<int>(log.parts.size());
  title.start = part.boot->clock.to_utc(part.segment.from);
  const auto& positions = part.boot->position;
  if (!positions.empty()) {
    const auto at = std::max<std::ptrdiff_t>(0, ingest::last_at_or_before(positions, part.segment.from));
    title.place = positions.value[static_cast<std::size_t>(at)];
  } else if (part.boot->origin) {
    title.place = part.boot->origin->point;
  }
  title.duration_s = part.duration_s();
  title.heading = part.heading.words;
  title.vehicle = part.boot->vehicle.name;
  title.autopilot = part.boot->vehicle.autopilot;
  return title;
}

/// Only the legs asked for stay; `each` keeps all.
std::optional<Problem> keep_legs(profiles::WindProfile& profile, const std::string& wanted) {
  if (wanted == "each") return std::nullopt;
  std::erase_if(profile.flown, [&](const profiles::Leg& leg) { return profiles::name(leg.name) != wanted; });
  std::erase_if(profile.legs, [&](const profiles::Leg& leg) { return profiles::name(leg.name) != wanted; });
  if (!profile.legs.empty()) return std::nullopt;
  return Problem{Kind::no_answer,
                 fmt::format("the flight has no leg \"{}\": it never climbs or descends by one bin", wanted),
                 {},
                 "ask for --leg all or smaller bins with --bin-m"};
}

bool has_wind(const estimator::WindSeries& series) {
  return std::any_of(series.points.begin(), series.points.end(),
                     [](const auto& p) { return std::holds_alternative<estimator::WindEstimate>(p.wind); });
}

/// @param flight  the airborne part, cut once for every stage
ingest::Result<void> add_series(FlightAnswer& answer, const ingest::Flight& flight, const ingest::Vehicle& vehicle,
                                const PipelineSettings& settings, bool classic) {
  auto estimate = settings.estimate;
  estimate.takeoff = answer.part.takeoff;
  estimate.heading_sd_deg = std::hypot(estimate.heading_sd_deg, answer.part.heading.sd_deg);
  auto series = estimator::estimate_wind(flight, vehicle, estimate);
  if (!series) return fail(series.error());
  if (!has_wind(*series))
    return fail(Kind::no_answer, "no instant of this flight has a wind", {},
                "see `quadsonde info` for what the log lacks");
  answer.series = std::move(*series);
  answer.autopilot_wind = beside_autopilot(flight, answer.series);
  add_once(answer.source.problems, answer.series.problems);
  if (!classic || settings.estimate.mode == estimator::Mode::classic) return {};
  estimate.mode = estimator::Mode::classic;
  if (auto beside = estimator::estimate_wind(flight, vehicle, estimate)) answer.classic = std::move(*beside);
  return {};
}

void add_comparison(FlightAnswer& answer, const std::vector<ReferenceFile>& references,
                    const ReferenceSettings& settings) {
  answer.comparison = compare_with({&answer.series, answer.classic ? &*answer.classic : nullptr,
                                    answer.profile ? &*answer.profile : nullptr},
                                   references, settings);
  add_once(answer.source.problems, answer.comparison->problems());
}

/// A log that contradicts itself gives numbers that nobody should use: they are `bad`, each with that reason. That a
/// flight cannot show its consistency is no fault of it.
void add_check(FlightAnswer& answer, const ingest::Flight& flight, const ingest::Vehicle& vehicle,
               const std::string& file) {
  auto report = ingest::check_consistency(flight, ingest::drag_arguments(vehicle));
  if (!report) return;
  answer.check = std::move(*report);
  estimator::Reasons reasons;
  if (answer.check->verdict == ingest::Verdict::inconsistent) reasons.add(estimator::Reason::inconsistent_telemetry);
  if (answer.check->verdict == ingest::Verdict::doubtful) reasons.add(estimator::Reason::doubtful_telemetry);
  if (reasons.empty()) return;
  estimator::add_to_all(answer.series, reasons);
  if (answer.classic) estimator::add_to_all(*answer.classic, reasons);
  add_once(answer.source.problems, *verdict_problem(*answer.check, file));
}

/// Only where nothing worse is known of the telemetry: a fault that turns the tilt is named by the check.
void advise_heading(FlightAnswer& answer, const ingest::Flight& flight, const ingest::Vehicle& vehicle,
                    const PipelineSettings& settings, const std::string& file) {
  if (answer.check && answer.check->verdict == ingest::Verdict::inconsistent) return;
  const auto heading = ingest::estimate_heading_offset(flight, ingest::drag_arguments(vehicle).latency_s);
  if (const auto advice = heading_problem(heading, settings.estimate.heading_sd_deg, settings.input, file))
    add_once(answer.source.problems, *advice);
}

/// A drift of more than half a bin is taken off, but not in silence: evenly in time is an assumption.
void add_drift(FlightAnswer& answer, double bin_m) {
  const auto& drift = answer.part.drift;
  if (!drift || std::abs(drift->metres) <= bin_m / 2) return;
  estimator::Reasons reasons;
  reasons.add(estimator::Reason::height_drift);
  estimator::add_to_all(answer.series, reasons);
  add_once(answer.source.problems, {{Kind::doubtful, drift_words(*drift), {answer.source.file, {}, {}, {}},
                                     "trust heights in the middle of the flight to half of that only"}});
}

void add_profile(FlightAnswer& answer, const ingest::Flight& flight, const PipelineSettings& settings) {
  add_drift(answer, settings.profile.bin_m);
  auto profile = profiles::make_profile(answer.series, settings.profile);
  if (!profile) {
    answer.no_profile = profile.error();
    return;
  }
  profiles::fill_air(*profile, answer.series, flight);
  for (auto& problem : profile->problems)
    if (problem.where.file.empty()) problem.where.file = answer.source.file;
  add_once(answer.source.problems, profile->problems);
  answer.no_profile = keep_legs(*profile, settings.leg.leg);
  if (answer.no_profile) return;
  answer.profile = std::move(*profile);
  if (answer.profile->flown.size() < 3) return;
  if (auto section = profiles::make_section({{answer.source.file, &*answer.profile}})) answer.section = std::move(*section);
}

}  // namespace

std::vector<NamedSetting> named_settings(const PipelineSettings& settings) {
  std::vector<NamedSetting> all;
  auto copy = settings;
  describe(copy, Collector{all});
  // Where a map or a vehicle file lay on this machine is nobody's business; its name is.
  for (auto& setting : all)
    if (auto* text = std::get_if<std::string>(&setting.value); text && text->find('/') != std::string::npos)
      *text = std::filesystem::path(*text).filename().string();
  return all;
}

ingest::Result<FlightAnswer> analyse(const LoadedLog& log, const FlightPart& part, const VehicleInUse& vehicle,
                                     const PipelineSettings& settings, const Wanted& wanted, const Control& control) {
  if (control.stopped()) return fail(stopped_problem());
  FlightAnswer answer;
  answer.part = part;
  answer.title = title_of(log, part);
  auto station = choose_station(settings.station.station, log.path);
  if (!station) return fail(station.error());
  answer.station = std::move(*station);
  answer.product = settings.product;
  answer.source = {answer.title.file, log.sha256, part.number, vehicle.vehicle, named_settings(settings), {}};
  answer.source.made_heights = part.made_heights;
  if (part.drift) {
    auto& heights = answer.source.made_heights;
    heights += (heights.empty() ? "" : "; ") + drift_words(*part.drift);
  }
  answer.source.vehicle_sha256 = vehicle.sha256;
  if (!vehicle.sha256.empty()) answer.source.vehicle_file = std::filesystem::path(vehicle.from).filename().string();
  auto& problems = answer.source.problems;
  add_once(problems, log.content.problems);
  add_once(problems, part.problems);
  add_once(problems, vehicle.notes);
  if (part.boot->vehicle.airframe == ingest::Airframe::helicopter)
    add_once(problems, {{Kind::doubtful,
                         "the log is of a helicopter; only what it flies like a multirotor can be trusted",
                         {log.path.string(), {}, {}, {}},
                         "judge the result by its quality and reasons"}});
  // Our own simulator has no autopilot; who flies that knows the truth.
  if (part.boot->vehicle.simulated && !part.boot->vehicle.autopilot.empty())
    add_once(problems, {{Kind::doubtful,
                         "the log is of a simulated flight: its wind is the simulator's, no air moved",
                         {log.path.string(), {}, {}, {}},
                         "give the log of a real flight"}});
  control.report("estimating the wind", 0.3);
  const auto flight = part.airborne();
  if (auto done = add_series(answer, flight, vehicle.vehicle, settings, wanted.classic); !done) {
    auto problem = control.stopped() ? stopped_problem() : done.error();
    if (problem.where.file.empty()) problem.where.file = log.path.string();
    return fail(std::move(problem));
  }
  if (settings.trust.check) {
    control.report("checking the telemetry", 0.6);
    add_check(answer, flight, vehicle.vehicle, log.path.string());
    advise_heading(answer, flight, vehicle.vehicle, settings, log.path.string());
    if (control.stopped()) return fail(stopped_problem());
  }
  control.report("making the profile", 0.8);
  if (wanted.profile) add_profile(answer, flight, settings);
  if (wanted.references && !wanted.references->empty()) add_comparison(answer, *wanted.references, wanted.reference);
  if (control.stopped()) return fail(stopped_problem());
  return answer;
}

}  // namespace quadsonde::product
