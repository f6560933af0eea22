#include "export/pipeline/free_flights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimator/smoother/chi_square.h"
#include "export/pipeline/analyse.h"
#include "export/pipeline/check.h"
#include "export/pipeline/load.h"
#include "export/pipeline/outputs.h"
#include "export/pipeline/tunnel_runs.h"
#include "export/report/free_flight_picture.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::FaultClass;
using ingest::Kind;
using ingest::Problem;

constexpr double between_flights = 0.10;  // of ln c (1 sigma)
constexpr double least_probability = 1e-3;

struct Loaded {
  std::vector<estimator::FreeFlight> flights;
  std::vector<ingest::VehicleLog> logs;
  std::vector<Problem> problems;
  std::optional<ingest::UtcTime> newest;
  std::string vehicle, vehicle_log;  ///< as the first log that names one does
  std::optional<double> mass;        ///< as the first log that has one does
  std::string mass_log;
  int rotors = 0;
  std::string rotors_log;
};

/// What the fit itself finds is no reason to refuse a log.
bool only_fitted_faults(const ingest::ConsistencyReport& report) {
  bool any = false;
  for (const auto& finding : report.findings) {
    if (!finding.decides) continue;
    any = true;
    if (finding.fault != FaultClass::latency && finding.fault != FaultClass::tilt_offset) return false;
  }
  return any;
}

ingest::Result<void> check_flight(const LoadedLog& log, const FlightPart& part, Loaded& loaded,
                                  const Control& control) {
  VehicleInUse nobody;
  nobody.vehicle = ingest::class_prior();
  Control quiet = control;
  quiet.progress = nullptr;
  const auto answer = check(log, part, nobody, {}, quiet);
  // A flight too short to be checked is judged by what it can tell of the drag.
  if (!answer) return control.stopped() ? fail(stopped_problem()) : ingest::Result<void>{};
  auto verdict = verdict_problem(answer->report, log.path.string());
  if (!verdict) return {};
  if (verdict->kind == Kind::inconsistent && !only_fitted_faults(answer->report)) {
    verdict->what = "no drag can be found from it: " + verdict->what;
    return fail(*verdict);
  }
  verdict->kind = Kind::doubtful;
  loaded.problems.push_back(*verdict);
  return {};
}

/// Mass and rotors as far as logs tell them.
ingest::Result<void> same_build(const LoadedLog& log, const ingest::Flight& flight, Loaded& loaded) {
  const auto file = log.path.filename().string();
  const auto& vehicle = flight.vehicle;
  const ingest::Where where{log.path.string(), {}, {}, {}};
  if (vehicle.mass_kg && loaded.mass && std::abs(std::log(*vehicle.mass_kg / *loaded.mass)) > 0.02)
    return fail(Kind::usage,
                fmt::format("this log was flown with {:g} kg, {} with {:g} kg", *vehicle.mass_kg, loaded.mass_log,
                            *loaded.mass),
                where, "calibrate each load from its own logs; the drag is scaled to other masses afterwards");
  if (vehicle.mass_kg && !loaded.mass) loaded.mass = vehicle.mass_kg, loaded.mass_log = file;
  if (vehicle.rotors > 0 && loaded.rotors > 0 && vehicle.rotors != loaded.rotors)
    return fail(Kind::usage,
                fmt::format("this log is of a vehicle with {} rotors, {} of one with {}", vehicle.rotors,
                            loaded.rotors_log, loaded.rotors),
                where, "calibrate each vehicle from its own logs");
  if (vehicle.rotors > 0 && loaded.rotors == 0) loaded.rotors = vehicle.rotors, loaded.rotors_log = file;
  return {};
}

ingest::Result<void> same_vehicle(const LoadedLog& log, const ingest::Flight& flight, Loaded& loaded) {
  if (auto same = same_build(log, flight, loaded); !same) return same;
  const auto file = log.path.filename().string();
  if (flight.vehicle.name.empty()) return {};
  if (loaded.vehicle.empty()) {
    loaded.vehicle = flight.vehicle.name, loaded.vehicle_log = file;
    return {};
  }
  if (loaded.vehicle == flight.vehicle.name) return {};
  return fail(Kind::usage,
              fmt::format("this log is of the vehicle \"{}\", {} of \"{}\"", flight.vehicle.name, loaded.vehicle_log,
                          loaded.vehicle),
              {log.path.string(), {}, {}, {}}, "calibrate each vehicle from its own logs");
}

ingest::Result<void> add_log(const std::filesystem::path& path, const FreeFlightsRequest& request, Loaded& loaded,
                             const Control& control) {
  Control quiet = control;
  quiet.progress = nullptr;
  const auto log = load_log(path, request.input, quiet);
  if (!log) return fail(log.error());
  const auto parts = choose_flights(*log, request.flight.flight, true, loaded.problems);
  if (!parts) return fail(parts.error());
  const auto add = [&](const std::vector<Problem>& some) {
    loaded.problems.insert(loaded.problems.end(), some.begin(), some.end());
  };
  add(log->content.problems);
  for (const auto& part : *parts) {
    add(part.problems);
    auto flight = part.airborne();
    if (auto same = same_vehicle(*log, flight, loaded); !same) return same;
    if (auto sound = check_flight(*log, part, loaded, control); !sound) return sound;
    if (const auto span = ingest::time_span(flight))
      if (const auto end = flight.clock.to_utc(span->second); end && (!loaded.newest || *end > *loaded.newest))
        loaded.newest = end;
    auto name = path.filename().string();
    if (parts->size() > 1) name += fmt::format(", flight {}", part.number);
    loaded.flights.push_back({std::move(name), std::move(flight), std::nullopt});
  }
  const bool known = std::any_of(loaded.logs.begin(), loaded.logs.end(),
                                 [&](const auto& other) { return other.sha256 == log->sha256; });
  if (known)
    return fail(Kind::usage, "this log was given twice", {path.string(), {}, {}, {}}, "each flight counts once");
  loaded.logs.push_back({path.filename().string(), log->sha256});
  return {};
}

/// What is known beforehand: nothing but the class, or the file to be updated.
ingest::Result<ingest::Vehicle> prior_of(const DragSettings& drag, std::string& updates) {
  if (drag.vehicle == "auto") return ingest::class_prior();
  constexpr std::string_view class_prefix = "class:";
  if (drag.vehicle.starts_with(class_prefix))
    return ingest::class_prior(std::string_view(drag.vehicle).substr(class_prefix.size()));
  auto vehicle = ingest::read_vehicle(drag.vehicle);
  if (vehicle) updates = drag.vehicle;
  return vehicle;
}

}  // namespace

std::optional<std::string> different_drags(const std::vector<estimator::FreeFlightRun>& runs) {
  double weights = 0, mean = 0, chi2 = 0;
  const estimator::FreeFlightRun *least = nullptr, *most = nullptr;
  int count = 0;
  const auto variance = [](const auto& run) {
    return std::pow(*run.drag_sd / *run.drag, 2) + between_flights * between_flights;
  };
  for (const auto& run : runs) {
    if (!run.drag || !run.drag_sd || !(*run.drag > 0)) continue;
    mean += std::log(*run.drag) / variance(run), weights += 1 / variance(run), ++count;
    if (!least || *run.drag < *least->drag) least = &run;
    if (!most || *run.drag > *most->drag) most = &run;
  }
  if (count < 2) return std::nullopt;
  mean /= weights;
  for (const auto& run : runs)
    if (run.drag && run.drag_sd && *run.drag > 0) chi2 += std::pow(std::log(*run.drag) - mean, 2) / variance(run);
  if (estimator::chi_square_tail(chi2, count - 1) > least_probability) return std::nullopt;
  return fmt::format("the flights do not share one drag: {} shows {:.3f} +- {:.3f} 1/s, {} {:.3f} +- {:.3f}, as of "
                     "different vehicles or loads (chi2 {:.0f} of {} flights)",
                     least->name, *least->drag, *least->drag_sd, most->name, *most->drag, *most->drag_sd, chi2, count);
}

ingest::Result<FreeFlightsResult> run_free_flights(const FreeFlightsRequest& request, const Control& control) {
  FreeFlightsResult result;
  estimator::FreeFlightSettings settings;
  auto prior = prior_of(request.drag, result.updates);
  if (!prior) return fail(prior.error());
  settings.prior = std::move(*prior);
  result.prior = settings.prior;
  settings.mass = request.drag.mass_kg;
  Loaded loaded;
  for (std::size_t i = 0; i < request.logs.size(); ++i) {
    control.report("reading and checking", 0.7 * static_cast<double>(i) / static_cast<double>(request.logs.size()));
    if (control.stopped()) return fail(stopped_problem());
    if (auto added = add_log(request.logs[i], request, loaded, control); !added) return fail(added.error());
  }
  if (!settings.mass && !loaded.flights.empty()) settings.mass = loaded.flights.front().flight.vehicle.mass_kg;
  control.report("calibrating", 0.7);
  auto calibration = estimator::calibrate_free_flight(loaded.flights, settings);
  if (!calibration) return fail(calibration.error());
  result.calibration = std::move(*calibration);
  // Stronger than any other reason: the fit to all of them together means nothing.
  if (auto different = different_drags(result.calibration.runs)) {
    result.calibration.refused = std::move(different);
    result.calibration.vehicle = settings.prior;
    result.calibration.moves.clear();
    result.calibration.identifiability.advice.clear();
  }
  result.problems = std::move(loaded.problems);
  const auto& notes = result.calibration.notes;
  result.problems.insert(result.problems.end(), notes.begin(), notes.end());
  if (control.stopped()) return fail(stopped_problem());
  if (result.calibration.refused) return result;
  const auto created = creation_time(loaded.newest);
  if (!created) return fail(created.error());
  auto& vehicle = result.calibration.vehicle;
  if (vehicle.name.empty()) vehicle.name = loaded.vehicle;
  if (vehicle.id.empty()) vehicle.id = (request.output ? *request.output : request.logs.front()).stem().string();
  if (result.updates.empty()) vehicle.logs.clear();
  for (const auto& log : loaded.logs) {
    if (std::any_of(vehicle.logs.begin(), vehicle.logs.end(), [&](const auto& o) { return o.sha256 == log.sha256; }))
      return fail(Kind::usage, fmt::format("{} went into {} before", log.name, result.updates), {},
                  "update a vehicle with flights that it does not know yet");
    vehicle.logs.push_back(log);
  }
  vehicle.created = *created;
  vehicle.version = version();
  if (!request.output) return result;
  control.report("writing", 0.95);
  Outputs outputs(request.overwrite, control);
  const auto picture =
      request.output->parent_path() / fmt::format("{}_drag.svg", request.output->stem().string());
  if (auto added = outputs.add(*request.output, ingest::to_toml(vehicle)); !added) return fail(added.error());
  if (auto added = outputs.add(picture, free_flight_drag_svg(result.calibration, result.prior)); !added)
    return fail(added.error());
  if (auto written = outputs.commit(); !written) return fail(written.error());
  result.files = {*request.output, picture};
  return result;
}

}  // namespace quadsonde::product
