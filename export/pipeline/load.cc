#include "export/pipeline/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "export/geoid/geoid.h"
#include "export/sha256.h"
#include "ingest/open/mapped_file.h"
#include "ingest/open/open_log.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Flight;
using ingest::Kind;
using ingest::Problem;

ingest::Where in(const std::string& file) { return {file, {}, {}, {}}; }

/// What open_log takes, with the maps read.
ingest::Result<ingest::OpenSettings> open_settings(const InputSettings& settings) {
  ingest::OpenSettings open;
  open.mode = settings.recover ? ingest::Reading::salvage : ingest::Reading::tolerant;
  open.height_offset_m = settings.height_offset_m;
  open.sensor_offset_s = settings.sensor_offset_s;
  if (!settings.topics.empty()) open.topics = settings.topics;
  if (!settings.sensor.empty()) open.sensor = settings.sensor;
  if (settings.columns == "auto") return open;
  auto map = ingest::read_column_map(settings.columns);
  if (!map) return fail(map.error());
  open.columns = std::move(*map);
  return open;
}

/// Whether the vehicle is in the air between two times although nothing says so: its tilt wanders by more than 0.2
/// degrees over 5 s, which one that stands never does (recorded hovers: 0.27 degrees at the calmest, 1 in wind).
bool tilt_wanders(const Flight& flight, ingest::LogTime from, ingest::LogTime to) {
  constexpr double least = 0.2 * std::numbers::pi / 180;
  const auto window = ingest::seconds(5);
  bool any = false;
  for (auto begin = from; begin + ingest::seconds(2) <= to; begin = begin + window) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double squares = 0, n = 0;
    for (auto i = ingest::last_at_or_before(flight.attitude, begin) + 1;
         i < static_cast<std::ptrdiff_t>(flight.attitude.size()); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (flight.attitude.time[k] > std::min(begin + window, to)) break;
      const Eigen::Vector2d tilt = (flight.attitude.value[k] * Eigen::Vector3d::UnitZ()).head<2>();
      sum += tilt, squares += tilt.squaredNorm(), n += 1;
    }
    if (n < 5) continue;
    any = true;
    if (std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm())) < least) return false;
  }
  return any;
}

/// No ground speed above what receiver noise makes of a parked vehicle, and at least one sample of it.
bool slow(const Flight& flight, ingest::LogTime from, ingest::LogTime to) {
  bool any = false;
  for (auto i = ingest::last_at_or_before(flight.velocity, from) + 1;
       i < static_cast<std::ptrdiff_t>(flight.velocity.size()); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (flight.velocity.time[k] > to) break;
    if (flight.velocity.value[k].norm() > 0.6) return false;
    any = true;
  }
  return any;
}

/// A hover that was cut out of a longer log shows neither take-off nor ground: what looks like standing still is not.
std::optional<ingest::Segment> whole_log_in_air(const Flight& flight) {
  if (!flight.landed.empty() || flight.velocity.size() < 2) return std::nullopt;
  const ingest::Segment whole{flight.velocity.time.front(), flight.velocity.time.back(), true, true};
  const bool long_enough = ingest::to_seconds(whole.to - whole.from) >= ingest::SegmentSettings{}.min_duration;
  return long_enough && tilt_wanders(flight, whole.from, whole.to) ? std::optional(whole) : std::nullopt;
}

/// A barometer that drifted shows a parked vehicle metres above the ground: where it stands as still as only the ground
/// lets it to the end of its segment, it has landed when that began.
void end_where_it_stands(const Flight& flight, ingest::Segment& segment) {
  if (!flight.landed.empty()) return;
  const auto window = ingest::seconds(5);
  auto stands_from = segment.to;
  while (stands_from - window > segment.from && !tilt_wanders(flight, stands_from - window, stands_from) &&
         slow(flight, stands_from - window, stands_from))
    stands_from = stands_from - window;
  if (stands_from == segment.to) return;
  // To the half second: what stands on the ground makes a bin below take-off out of its rest.
  const auto step = ingest::seconds(0.5);
  while (stands_from - step > segment.from && !tilt_wanders(flight, stands_from - step, stands_from - step + window) &&
         slow(flight, stands_from - step, stands_from - step + window))
    stands_from = stands_from - step;
  segment.to = stands_from;
  segment.ends_in_air = false;
}

/// A moment at the lowest height of a log is a landing only if the vehicle is seen to stay there: logs end in the
/// middle of vertical flights too. Where the log itself tells of landings, it is believed.
void doubt_short_stands(const Flight& flight, std::vector<ingest::Segment>& segments) {
  if (!flight.landed.empty()) return;
  const auto least = ingest::seconds(2);
  auto last = flight.velocity.time.front();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto next = i + 1 < segments.size() ? segments[i + 1].from : flight.velocity.time.back();
    if (segments[i].from - last < least) segments[i].starts_in_air = true;
    if (next - segments[i].to < least) segments[i].ends_in_air = true;
    last = segments[i].to;
  }
}

/// A height stream as differences from its value at take-off, else at the landing; nothing if neither was seen.
template <class Stream, class Up>
void make_ground_height(Flight& flight, const Stream& whole, const ingest::Segment& segment, Up up) {
  if (!flight.height_ground.empty() || whole.empty()) return;
  const auto before =
      segment.starts_in_air ? -1 : ingest::last_at_or_before(whole, segment.from - ingest::seconds(0.5));
  const auto after = segment.ends_in_air ? -1 : ingest::last_at_or_before(whole, segment.to + ingest::seconds(2));
  const auto at = before >= 0 ? before : after;
  if (at < 0) return;
  const double ground = up(whole.value[static_cast<std::size_t>(at)]);
  flight.height_ground.source = whole.source;
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole.time[i] >= segment.from && whole.time[i] <= segment.to)
      flight.height_ground.push(whole.time[i], ingest::GroundHeight{up(whole.value[i]) - ground});
}

/// Heights above the sea where the log has none but above the ellipsoid, shifted as the log's own would be.
/// @return how they were made; empty where they were not
std::string make_msl_heights(Flight& flight, const Geoid& geoid, double offset_m) {
  if (!add_msl_heights(flight, geoid)) return {};
  for (auto& h : flight.height_msl.value) h.m += offset_m;
  return fmt::format("height above the ellipsoid ({}) minus the geoid ({})", flight.height_ellipsoid.source,
                     geoid.provenance());
}

/// The flights of one boot, appended to the log's.
void add_parts(LoadedLog& log, const std::shared_ptr<const Flight>& boot, const std::string& made_heights,
               const HeadingFacts& heading, const InputSettings& settings) {
  const auto file = log.path.string();
  auto segments = ingest::airborne_segments(*boot);
  std::vector<Problem> problems = boot->problems;
  for (auto& segment : segments) end_where_it_stands(*boot, segment);
  doubt_short_stands(*boot, segments);
  if (segments.empty())
    if (const auto whole = whole_log_in_air(*boot)) {
      segments = {*whole};
      problems.push_back({Kind::doubtful,
                          "nothing shows a take-off or a landing: the whole log is taken as one flight in the air",
                          in(file), "give a log that begins on the ground to have heights above take-off"});
    }
  for (std::size_t i = 0; i < segments.size(); ++i) {
    FlightPart part;
    part.number = static_cast<int>(log.parts.size()) + 1;
    part.boot = boot;
    part.segment = segments[i];
    const auto half_way = [](ingest::LogTime a, ingest::LogTime b) { return a + (b - a) / 2; };
    part.share_from = i ? half_way(segments[i - 1].to, segments[i].from) : ingest::LogTime{INT64_MIN};
    part.share_to =
        i + 1 < segments.size() ? half_way(segments[i].to, segments[i + 1].from) : ingest::LogTime{INT64_MAX};
    part.takeoff = ingest::takeoff_height(*boot, segments[i]);
    part.drift = find_height_drift(*boot, segments[i]);
    if (!part.takeoff && settings.takeoff_msl_m) part.takeoff = ingest::MslHeight{*settings.takeoff_msl_m};
    part.problems = problems;
    part.made_heights = made_heights;
    part.heading = heading;
    log.parts.push_back(std::move(part));
  }
}

/// The user's word on when the log begins, where the log has none: it holds for the first boot, since nothing tells
/// how long the pause before another was.
ingest::Result<void> apply_start(LoadedLog& log, const std::string& text) {
  if (text.empty()) return {};
  const auto start = ingest::parse_iso8601(text);
  if (!start)
    return fail(Kind::usage, fmt::format("--start-utc {}: this is no time", text), {},
                "give a time such as 2026-06-01T06:00:00Z");
  auto& flights = log.content.flights;
  for (auto& flight : flights) {
    const auto span = ingest::time_span(flight);
    if (!span) continue;
    if (flight.clock.utc_minus_log)
      flight.problems.push_back({Kind::doubtful, "the log tells its own time, so --start-utc is not used",
                                 in(log.path.string()), "leave --start-utc out"});
    else if (&flight == &flights.front())
      flight.clock = {ingest::Duration(start->ns - span->first.ns), 1, "--start-utc"};
    else
      flight.problems.push_back({Kind::missing, "--start-utc holds for the first start of the autopilot only",
                                 in(log.path.string()), "give this flight in a log of its own to time it"});
  }
  return {};
}

Problem never_flies(const LoadedLog& log) {
  return {Kind::no_answer, "the vehicle never leaves the ground in this log", in(log.path.string()),
          "give a log with a flight of at least 10 s"};
}

/// Reads the bytes once: for the flights, and for the fingerprint.
ingest::Result<void> read_file(LoadedLog& log, const InputSettings& settings) {
  const auto open = open_settings(settings);
  if (!open) return fail(open.error());
  const auto file = ingest::MappedFile::open(log.path);
  if (!file) return fail(file.error());
  auto content = ingest::open_log(file->bytes(), log.path, *open);
  if (!content) return fail(content.error());
  log.content = std::move(*content);
  log.sha256 = sha256_hex(file->bytes());
  return {};
}

}  // namespace

Flight FlightPart::airborne() const {
  auto flight = ingest::cut(*boot, segment.from, segment.to);
  if (drift) take_off_drift(flight, *drift);
  if (!flight.height_msl.empty()) return flight;
  make_ground_height(flight, boot->height_ellipsoid, segment, [](ingest::EllipsoidHeight h) { return h.m; });
  make_ground_height(flight, boot->local_position, segment, [](const Eigen::Vector3d& p) { return -p.z(); });
  return flight;
}

ingest::Result<LoadedLog> load_log(const std::filesystem::path& path, const InputSettings& settings,
                                   const Control& control) {
  control.report("reading", 0);
  LoadedLog log;
  log.path = path;
  if (auto read = read_file(log, settings); !read) return fail(read.error());
  if (control.stopped()) return fail(stopped_problem());
  if (auto started = apply_start(log, settings.start_utc); !started) return fail(started.error());
  log.nothing = ingest::why_no_flight(log.content);
  const auto geoid = Geoid::open();
  const bool magnetic_by_map = std::find(log.content.details.begin(), log.content.details.end(),
                                         std::pair<std::string, std::string>("heading", "magnetic")) !=
                               log.content.details.end();
  const auto north = settings.heading == "magnetic" || magnetic_by_map ? MagneticNorth::open() : MagneticNorth();
  for (auto& flight : log.content.flights) {
    const bool usable = !ingest::why_unusable(flight, log.content.format);
    const auto made_heights = make_msl_heights(flight, geoid, settings.height_offset_m);
    const auto heading =
        correct_heading(flight, log.content.format, magnetic_by_map, settings, north, path.string());
    log.boots.push_back(std::make_shared<const Flight>(std::move(flight)));
    if (usable) add_parts(log, log.boots.back(), made_heights, heading, settings);
  }
  log.content.flights.clear();
  if (!log.nothing && log.parts.empty()) log.nothing = never_flies(log);
  if (log.nothing && log.nothing->where.file.empty()) log.nothing->where.file = path.string();
  control.report("reading", 0.2);
  return log;
}

ingest::Result<std::vector<FlightPart>> choose_flights(const LoadedLog& log, const std::string& choice,
                                                       bool all_by_default, std::vector<Problem>& notes) {
  if (log.parts.empty()) return fail(*log.nothing);
  const bool by_itself = choice.empty();
  if (choice == "all" || (by_itself && all_by_default)) return log.parts;
  if (by_itself || choice == "longest") {
    const auto longest =
        std::max_element(log.parts.begin(), log.parts.end(),
                         [](const FlightPart& a, const FlightPart& b) { return a.duration_s() < b.duration_s(); });
    if (by_itself && log.parts.size() > 1)
      notes.push_back(
          {Kind::doubtful,
           fmt::format("the log has {} flights; this is the longest, number {}", log.parts.size(), longest->number),
           in(log.path.string()), "choose with --flight N or --flight all"});
    return std::vector{*longest};
  }
  int number = 0;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
  if (error != std::errc{} || end != choice.data() + choice.size())
    return fail(Kind::usage, fmt::format("--flight {}: expected a number, all or longest", choice), {},
                "give --flight 1");
  if (number < 1 || number > static_cast<int>(log.parts.size()))
    return fail(Kind::usage, fmt::format("there is no flight {} in this log: it has {}", number, log.parts.size()),
                in(log.path.string()), "see `quadsonde info` for its flights");
  return std::vector{log.parts[static_cast<std::size_t>(number - 1)]};
}

}  // namespace quadsonde::product
