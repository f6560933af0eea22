#include "export/pipeline/run_log.h"

#include <fmt/format.h>

#include <algorithm>

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/mcap/foxglove_layout.h"
#include "export/pipeline/netcdf.h"
#include "export/pipeline/problems.h"
#include "export/pipeline/render.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;

/// The stem without a second ending: flight.csv.gz -> flight.
std::string stem_of(const std::filesystem::path& log) {
  auto name = log.filename();
  const auto ending = name.extension();
  if (ending == ".gz" || ending == ".zst") name = name.stem();
  return name.stem().string();
}

/// Products of an earlier run that this one does not make would contradict it.
void remove_older(const std::filesystem::path& folder, const std::vector<std::string>& made) {
  std::error_code ignored;
  for (const auto& name : product_names())
    if (std::find(made.begin(), made.end(), name) == made.end()) std::filesystem::remove(folder / name, ignored);
}

/// Before anything is computed: may this folder be written?
ingest::Result<void> check_free(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& name : product_names())
    if (std::filesystem::exists(folder / name, error))
      return fail(Kind::usage, "the result of an earlier run is already there", {(folder / name).string(), {}, {}, {}},
                  "name another folder with -o or allow overwriting with --force");
  return {};
}

FlightProducts products_of(const FlightAnswer& answer) {
  return {&answer.series, answer.profile ? &*answer.profile : nullptr, &answer.source};
}

ingest::Result<void> write_products(Outputs& outputs, FlightRun& run, const std::filesystem::path& folder) {
  const auto& answer = run.answer;
  const auto write = [&](const char* name, const std::string& content) -> ingest::Result<void> {
    if (name != std::string("run.json")) run.files.push_back(name);
    return outputs.add(folder / name, content);
  };
  if (auto made = outputs.make_folder(folder); !made) return made;
  run.files.push_back("flight.mcap");
  if (auto done = outputs.add_flight(folder / "flight.mcap", answer.part.whole(), {}, products_of(answer)); !done)
    return done;
  if (auto done = write("foxglove_layout.json", foxglove_layout(answer.profile ? &*answer.profile : nullptr)); !done)
    return done;
  if (auto done = write("wind.csv", *render_wind(answer, Format::csv)); !done) return done;
  // A flight that cannot be a netCDF file (no UTC, no place) has its other products all the same, and they say so.
  const auto write_netcdf = [&](const char* name, const ingest::Result<std::string>& bytes) -> ingest::Result<void> {
    if (bytes) return write(name, *bytes);
    add_once(run.answer.source.problems, bytes.error());
    return {};
  };
  if (auto done = write_netcdf("wind.nc", wind_netcdf_of(answer)); !done) return done;
  if (auto done = write("wind.svg", *render_wind(answer, Format::svg)); !done) return done;
  if (auto done = write("state.svg", render_state(answer)); !done) return done;
  if (answer.profile) {
    if (auto done = write("profile.csv", *render_profile(answer, Format::csv)); !done) return done;
    if (auto done = write_netcdf("profile.nc", profile_netcdf_of(answer)); !done) return done;
    if (auto done = write("profile.svg", *render_profile(answer, Format::svg)); !done) return done;
  }
  if (auto done = write("report.html", *render_profile(answer, Format::html)); !done) return done;
  if (answer.comparison)
    if (auto done =
            write("compare.json", comparison_json(*answer.comparison, answer.source.file, answer.source.flight));
        !done)
      return done;
  run.files.push_back("run.json");
  return write("run.json", run_json(answer, run.files));
}

ingest::Result<void> write_folders(RunResult& result, bool overwrite, const Control& control) {
  control.report("writing", 0.9);
  Outputs outputs(overwrite, control);
  for (auto& run : result.flights)
    if (auto done = write_products(outputs, run, run.folder); !done) return done;
  if (auto done = outputs.commit(); !done) return done;
  for (const auto& run : result.flights) remove_older(run.folder, run.files);
  control.report("writing", 1);
  return {};
}

}  // namespace

bool RunResult::with_doubts() const {
  return !failures.empty() || !notes.empty() || std::any_of(flights.begin(), flights.end(), [](const FlightRun& run) {
    return !run.answer.source.problems.empty() || run.answer.no_profile.has_value();
  });
}

std::string flight_folder_name(const std::filesystem::path& log, int flight, int flights) {
  return flights > 1 ? fmt::format("{}-{}", stem_of(log), flight) : stem_of(log);
}

const std::vector<std::string>& product_names() {
  static const std::vector<std::string> names{"flight.mcap",  "foxglove_layout.json", "wind.csv",    "wind.nc",
                                              "wind.svg",     "state.svg",   "profile.csv",
                                              "profile.nc",   "profile.svg", "report.html",
                                              "compare.json", "run.json"};
  return names;
}

std::string run_json(const FlightAnswer& answer, const std::vector<std::string>& files) {
  Json object = {
      {"schema", "quadsonde.run/1"}, {"version", std::string(version())}, {"source", json_source(answer.source)}};
  const auto& title = answer.title;
  object["flight"] = {{"number", title.flight},
                      {"of", title.flights},
                      {"start_utc", title.start ? Json(utc_text(title.start)) : Json()},
                      {"duration_s", json_number(title.duration_s, 3)},
                      {"lat_deg", title.place ? json_number(title.place->lat_deg, 7) : Json()},
                      {"lon_deg", title.place ? json_number(title.place->lon_deg, 7) : Json()},
                      {"takeoff_msl_m", answer.part.takeoff ? json_number(answer.part.takeoff->m, 2) : Json()},
                      {"vehicle", title.vehicle.empty() ? Json() : Json(title.vehicle)},
                      {"autopilot", title.autopilot.empty() ? Json() : Json(title.autopilot)}};
  object["vehicle"] = json_vehicle_of(answer.source);
  object["settings"] = json_settings(answer.source.settings);
  object["autopilot_wind"] = json_autopilot(answer.autopilot_wind);
  object["diagnostics"] = json_diagnostics(answer.series.diagnostics);
  auto problems = answer.source.problems;
  if (answer.no_profile) problems.push_back(*answer.no_profile);
  object["problems"] = json_problems(problems);
  object["files"] = files;
  return json_text(object);
}

ingest::Result<RunResult> run_log(const RunRequest& request, const Control& control) {
  Wanted wanted;
  wanted.profile = request.want_profile;
  wanted.classic = request.want_classic;
  auto references = read_reference_files(request.references);
  if (!references) return fail(references.error());
  if (const auto place = reference_place(request.reference.reference_at); !place) return fail(place.error());
  wanted.references = &*references;
  wanted.reference = request.reference;
  auto vehicle = choose_vehicle(request.settings.drag, request.log);
  if (!vehicle) return fail(vehicle.error());
  auto log = load_log(request.log, request.settings.input, control);
  if (!log) return fail(log.error());
  RunResult result;
  auto parts = choose_flights(*log, request.settings.flight.flight, request.all_flights, result.notes);
  if (!parts) return fail(parts.error());
  vehicle = choose_vehicle(request.settings.drag, request.log, &parts->front().boot->vehicle);
  if (!vehicle) return fail(vehicle.error());
  const auto flights = static_cast<int>(log->parts.size());
  const auto folder_of = [&](int number) { return *request.folder / flight_folder_name(request.log, number, flights); };
  if (request.folder && !request.overwrite)
    for (const auto& part : *parts)
      if (auto is_free = check_free(folder_of(part.number)); !is_free) return fail(is_free.error());

  for (const auto& part : *parts) {
    auto answer = analyse(*log, part, *vehicle, request.settings, wanted, control);
    if (control.stopped()) return fail(stopped_problem());
    if (answer)
      result.flights.push_back({std::move(*answer), {}, {}});
    else
      result.failures.push_back(answer.error());
  }
  if (result.flights.empty()) return fail(result.failures.front());
  if (!request.folder) return result;
  for (auto& run : result.flights) run.folder = folder_of(run.answer.part.number);
  if (auto done = write_folders(result, request.overwrite, control); !done) return fail(done.error());
  return result;
}

}  // namespace quadsonde::product
