#include "export/pipeline/tunnel_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "export/pipeline/load.h"
#include "export/pipeline/outputs.h"
#include "export/report/tunnel_picture.h"
#include "export/version.h"
#include "ingest/motion/toml_fields.h"
#include "ingest/open/open_log.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;
using ingest::TomlFields;

ingest::LogTime log_time(double seconds) { return ingest::LogTime{} + ingest::seconds(seconds); }

TunnelEntry read_entry(TomlFields& fields, const std::filesystem::path& folder) {
  TunnelEntry entry;
  if (!fields.has("log")) fields.complain("log", "is missing: the log of this run");
  if (const auto log = fields.text("log")) entry.log = folder / *log;
  if (!fields.has("wind_speed_m_s"))
    fields.complain("wind_speed_m_s", "is missing: the wind that blew in this run, in m/s");
  fields.set("wind_speed_m_s", entry.wind_speed_m_s);
  // In calm air there is no direction to state.
  if (!fields.has("wind_from_deg") && entry.wind_speed_m_s > 0)
    fields.complain("wind_from_deg", "is missing: where the wind came from, clockwise from north");
  fields.set("wind_from_deg", entry.wind_from_deg);
  entry.wind_speed_sd_m_s = fields.number("wind_speed_sd_m_s");
  entry.air_density_kg_m3 = fields.number("air_density_kg_m3");
  entry.start_s = fields.number("start_s", -9e9, 9e9);
  entry.end_s = fields.number("end_s", -9e9, 9e9);
  if (const auto map = fields.text("columns")) entry.columns = *map == "auto" ? *map : (folder / *map).string();
  fields.leftover();
  return entry;
}

std::optional<estimator::TunnelTrim> read_trim(TomlFields& root) {
  const auto roll = root.number("trim_roll_deg", -30, 30), pitch = root.number("trim_pitch_deg", -30, 30);
  const auto sd = root.number("trim_sd_deg", 0.001, 30);
  if (!roll && !pitch && !sd) return std::nullopt;
  if (!roll || !pitch) {
    root.complain(roll ? "trim_pitch_deg" : "trim_roll_deg", "is missing: a trim has roll and pitch");
    return std::nullopt;
  }
  return estimator::TunnelTrim{*roll, *pitch, sd.value_or(estimator::TunnelTrim{}.sd_deg)};
}

/// From the hundredth to the ninety-fifth part of the heights [m]: noise and single spikes do not count. 0 without
/// heights.
double height_range(const ingest::Flight& flight) {
  std::vector<double> up;
  const auto take = [&](const auto& stream, auto height) {
    if (up.size() < 2)
      for (const auto& value : stream.value) up.push_back(height(value));
  };
  take(flight.height_ground, [](auto h) { return h.m; });
  take(flight.height_msl, [](auto h) { return h.m; });
  take(flight.height_ellipsoid, [](auto h) { return h.m; });
  take(flight.local_position, [](const Eigen::Vector3d& p) { return -p.z(); });
  if (up.size() < 2) return 0;
  std::sort(up.begin(), up.end());
  return up[up.size() * 95 / 100] - up[up.size() / 100];
}

/// What is in the air of the boot that has the longest flight. A low hover before a generator comes and goes in the
/// usual search for flights, which looks for a height of 1 m; so its first and last moments count, or the whole log if
/// the height never changes by more than its noise.
ingest::Result<ingest::Flight> airborne(const LoadedLog& log) {
  constexpr double least_climb = 1.5;  // [m]
  std::vector<Problem> unused;
  const auto longest = choose_flights(log, "longest", false, unused);
  if (!longest) return fail(longest.error());
  const auto& part = longest->front();
  if (!part.boot->landed.empty()) return part.airborne();
  if (height_range(*part.boot) < least_climb) return *part.boot;
  auto from = part.segment.from, to = part.segment.to;
  for (const auto& other : log.parts)
    if (other.boot == part.boot) from = std::min(from, other.segment.from), to = std::max(to, other.segment.to);
  return ingest::cut(*part.boot, from, to);
}

/// Stated times need no take-off; the boot that has most of them is meant.
ingest::Result<ingest::Flight> stated_part(const TunnelEntry& entry, const LoadedLog& log) {
  const auto from = entry.start_s ? log_time(*entry.start_s) : ingest::LogTime{INT64_MIN};
  const auto to = entry.end_s ? log_time(*entry.end_s) : ingest::LogTime{INT64_MAX};
  std::optional<ingest::Flight> best;
  for (const auto& boot : log.boots) {
    if (ingest::why_unusable(*boot, log.content.format)) continue;
    auto flight = ingest::cut(*boot, from, to);
    if (!best || flight.velocity.size() > best->velocity.size()) best = std::move(flight);
  }
  if (best) return *best;
  return fail(log.nothing.value_or(Problem{
      Kind::no_answer, "no flight of this log can be used", {log.path.string(), {}, {}, {}}, "see `quadsonde info`"}));
}

/// What the runs are, and where they came from.
struct Loaded {
  std::vector<estimator::TunnelRun> runs;
  std::vector<ingest::VehicleLog> logs;
  std::vector<Problem> problems;
  std::optional<ingest::UtcTime> newest;
};

ingest::Result<void> add_run(const TunnelEntry& entry, Loaded& loaded, const Control& control) {
  InputSettings input;
  input.columns = entry.columns;
  Control quiet = control;
  quiet.progress = nullptr;
  const auto log = load_log(entry.log, input, quiet);
  if (!log) return fail(log.error());
  auto flight = entry.start_s || entry.end_s ? stated_part(entry, *log) : airborne(*log);
  if (!flight) return fail(flight.error());
  loaded.problems.insert(loaded.problems.end(), log->content.problems.begin(), log->content.problems.end());
  loaded.problems.insert(loaded.problems.end(), flight->problems.begin(), flight->problems.end());
  if (const auto span = ingest::time_span(*flight))
    if (const auto end = flight->clock.to_utc(span->second); end && (!loaded.newest || *end > *loaded.newest))
      loaded.newest = end;
  estimator::TunnelRun run;
  run.name = entry.title();
  run.flight = std::move(*flight);
  run.wind_speed = entry.wind_speed_m_s;
  run.wind_speed_sd = entry.wind_speed_sd_m_s;
  run.wind_from_deg = entry.wind_from_deg;
  run.air_density = entry.air_density_kg_m3;
  if (entry.start_s) run.start = log_time(*entry.start_s);
  if (entry.end_s) run.end = log_time(*entry.end_s);
  loaded.runs.push_back(std::move(run));
  const auto same = std::find_if(loaded.logs.begin(), loaded.logs.end(),
                                 [&](const auto& known) { return known.sha256 == log->sha256; });
  if (same == loaded.logs.end()) loaded.logs.push_back({entry.log.filename().string(), log->sha256});
  return {};
}

ingest::Result<void> write(const TunnelRequest& request, TunnelResult& result, const Control& control) {
  if (!request.output) return {};
  const auto beside = [&](const char* what) {
    return request.output->parent_path() / fmt::format("{}_{}.svg", request.output->stem().string(), what);
  };
  result.files = {*request.output, beside("tilt"), beside("drag")};
  Outputs outputs(request.overwrite, control);
  const std::string texts[] = {ingest::to_toml(result.calibration.vehicle), tunnel_tilt_svg(result.calibration),
                               tunnel_drag_svg(result.calibration)};
  for (std::size_t i = 0; i < 3; ++i)
    if (auto added = outputs.add(result.files[i], texts[i]); !added) return added;
  return outputs.commit();
}

}  // namespace

ingest::Result<std::optional<ingest::UtcTime>> creation_time(const std::optional<ingest::UtcTime>& newest) {
  const char* told = std::getenv("SOURCE_DATE_EPOCH");
  if (!told || !*told) return newest;
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(told, told + std::strlen(told), seconds);
  if (error != std::errc{} || *end || seconds < 0 || seconds > 9'000'000'000)
    return fail(Kind::usage, fmt::format("SOURCE_DATE_EPOCH is \"{}\", not a number of seconds", told), {},
                "set it to seconds since 1970, or unset it");
  return ingest::UtcTime{seconds * 1'000'000'000};
}

std::string TunnelEntry::title() const {
  const auto name = log.filename().string();
  if (!start_s && !end_s) return name;
  if (!end_s) return fmt::format("{}, from {} s", name, *start_s);
  return start_s ? fmt::format("{}, {} to {} s", name, *start_s, *end_s) : fmt::format("{}, to {} s", name, *end_s);
}

ingest::Result<TunnelFile> parse_tunnel_file(std::string_view text, const std::filesystem::path& file) {
  const std::string file_name = file.string();
  const auto table = ingest::parse_toml(text, file_name);
  if (!table) return fail(table.error());
  std::optional<Problem> problem;
  TomlFields root(*table, "", file_name, problem);
  TunnelFile out;
  if (!root.has("mass_kg")) root.complain("mass_kg", "is missing: the mass of the vehicle as it flew");
  root.set("mass_kg", out.mass_kg);
  root.set("id", out.id);
  root.set("name", out.name);
  out.trim = read_trim(root);
  for (auto& fields : root.tables("run")) out.runs.push_back(read_entry(fields, file.parent_path()));
  root.leftover();
  if (problem) return fail(*problem);
  return out;
}

ingest::Result<TunnelFile> read_tunnel_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return fail(Kind::unreadable, "the list of runs cannot be opened", {file.string(), {}, {}, {}},
                "give a RUNS.toml; examples/02_calibrate_tunnel has one to start from");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_tunnel_file(text, file);
}

ingest::Result<TunnelResult> run_tunnel(const TunnelRequest& request, const Control& control) {
  auto file = read_tunnel_file(request.runs);
  if (!file) return fail(file.error());
  Loaded loaded;
  for (std::size_t i = 0; i < file->runs.size(); ++i) {
    control.report("reading", 0.5 * static_cast<double>(i) / static_cast<double>(file->runs.size()));
    if (control.stopped()) return fail(stopped_problem());
    if (auto added = add_run(file->runs[i], loaded, control); !added) return fail(added.error());
  }
  control.report("calibrating", 0.5);
  estimator::TunnelSettings settings;
  settings.mass = request.mass_kg.value_or(file->mass_kg);
  settings.trim = file->trim;
  auto calibration = estimator::calibrate_tunnel(loaded.runs, settings);
  if (!calibration) {
    auto problem = calibration.error();
    if (problem.where.file.empty()) problem.where.file = request.runs.string();
    return fail(problem);
  }
  const auto created = creation_time(loaded.newest);
  if (!created) return fail(created.error());
  TunnelResult result{std::move(*calibration), std::move(loaded.problems), {}};
  auto& vehicle = result.calibration.vehicle;
  if (!file->name.empty()) vehicle.name = file->name;
  if (!file->id.empty()) vehicle.id = file->id;
  if (vehicle.id.empty()) vehicle.id = (request.output ? *request.output : request.runs).stem().string();
  vehicle.logs = std::move(loaded.logs);
  vehicle.created = *created;
  vehicle.version = version();
  const auto& notes = result.calibration.notes;
  result.problems.insert(result.problems.end(), notes.begin(), notes.end());
  control.report("writing", 0.9);
  if (control.stopped()) return fail(stopped_problem());
  if (auto written = write(request, result, control); !written) return fail(written.error());
  return result;
}

}  // namespace quadsonde::product
