#include "export/pipeline/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimator/filter/excitation.h"
#include "export/report/autopilot_wind.h"
#include "ingest/open/open_log.h"

namespace quadsonde::product {
namespace {

using ingest::Flight;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class T>
void add_stream(std::vector<StreamFacts>& all, const char* name, const ingest::Stream<T>& stream) {
  if (stream.empty()) return;
  StreamFacts facts;
  facts.name = name, facts.source = stream.source, facts.samples = stream.size();
  facts.latency = stream.latency;
  std::vector<double> steps;
  for (std::size_t i = 1; i < stream.size(); ++i)
    steps.push_back(ingest::to_seconds(stream.time[i] - stream.time[i - 1]));
  if (!steps.empty()) {
    const double middle = median(steps);
    if (middle > 0) facts.rate_hz = 1 / middle;
    facts.longest_gap_s = *std::max_element(steps.begin(), steps.end());
    facts.gaps = static_cast<std::size_t>(
        std::count_if(steps.begin(), steps.end(), [&](double s) { return s > 1 && s > 5 * middle; }));
    for (auto& step : steps) step = std::abs(step - middle);
    if (steps.size() >= 10) facts.jitter_s = 1.4826 * median(std::move(steps));
  }
  all.push_back(std::move(facts));
}

std::vector<StreamFacts> stream_facts(const Flight& f) {
  std::vector<StreamFacts> all;
  add_stream(all, "attitude", f.attitude);
  add_stream(all, "velocity", f.velocity);
  add_stream(all, "position", f.position);
  add_stream(all, "local position", f.local_position);
  add_stream(all, "height above sea", f.height_msl);
  add_stream(all, "height, ellipsoid", f.height_ellipsoid);
  add_stream(all, "height, take-off", f.height_ground);
  add_stream(all, "barometer", f.barometer);
  add_stream(all, "accelerometer", f.accelerometer);
  add_stream(all, "rotors", f.rotors);
  add_stream(all, "air", f.air);
  add_stream(all, "autopilot's wind", f.autopilot_wind);
  add_stream(all, "events", f.events);
  return all;
}

std::string airframe_word(ingest::Airframe airframe) {
  switch (airframe) {
    case ingest::Airframe::multirotor:
      return "multirotor";
    case ingest::Airframe::helicopter:
      return "helicopter";
    case ingest::Airframe::fixed_wing:
      return "fixed wing";
    case ingest::Airframe::vtol:
      return "VTOL";
    case ingest::Airframe::other:
      return "other";
    case ingest::Airframe::unknown:
      break;
  }
  return "";
}

BootFacts boot_facts(const Flight& flight, const std::string& format) {
  BootFacts facts;
  facts.vehicle = flight.vehicle.name;
  facts.autopilot = flight.vehicle.autopilot;
  facts.firmware = flight.vehicle.firmware;
  facts.airframe = airframe_word(flight.vehicle.airframe);
  facts.rotors = flight.vehicle.rotors;
  facts.simulated = flight.vehicle.simulated;
  if (flight.clock.utc_minus_log) facts.utc_uncertainty_s = flight.clock.uncertainty_s;
  facts.clock_source = flight.clock.source;
  facts.streams = stream_facts(flight);
  facts.autopilot_wind = mean_autopilot_wind(flight);
  facts.lacking = ingest::why_unusable(flight, format);
  return facts;
}

std::vector<std::string> manoeuvre_advice(const FlightFacts& facts) {
  const auto& m = facts.manoeuvre;
  std::vector<std::string> all;
  if (!facts.trim_can_be_measured)
    all.push_back(
        "Turn the nose through at least one full turn while hovering or climbing: it separates the tilt trim from the "
        "wind, "
        "which is uncertain by about 2 m/s without it.");
  if (!facts.profile_possible)
    all.push_back("Climb: a profile needs at least two heights 10 m apart.");
  else if (!m.ascents || !m.descents)
    all.push_back("Fly the way up and the way down at equal, slow rates: each checks the other.");
  if (!facts.can_calibrate)
    all.push_back(
        "To calibrate the drag: fly a square or back and forth at 3 to 5 m/s for 5 min, turning the nose steadily and "
        "independently of the track.");
  return all;
}

FlightFacts flight_facts(const LoadedLog& log, const FlightPart& part, double bin_m) {
  FlightFacts facts;
  auto& title = facts.title;
  title.file = log.path.filename().string();
  title.flight = part.number, title.flights = static_cast<int>(log.parts.size());
  title.start = part.boot->clock.to_utc(part.segment.from);
  title.duration_s = part.duration_s();
  const auto flight = part.airborne();
  if (!flight.position.empty())
    title.place = flight.position.value.front();
  else if (flight.origin)
    title.place = flight.origin->point;
  facts.starts_in_air = part.segment.starts_in_air, facts.ends_in_air = part.segment.ends_in_air;
  auto& m = facts.manoeuvre = find_manoeuvre(part, bin_m);
  facts.observable = observability(m, bin_m);
  facts.trim_can_be_measured = facts.observable.trim;
  facts.profile_possible = m.lowest && *m.highest - *m.lowest >= bin_m;
  facts.can_calibrate = m.excitation >= estimator::enough_excitation;
  facts.advice = manoeuvre_advice(facts);
  return facts;
}

}  // namespace

LogFacts inspect(const LoadedLog& log, double bin_m) {
  LogFacts facts;
  facts.file = log.path.filename().string();
  facts.sha256 = log.sha256;
  facts.format = log.content.format;
  facts.messages = log.content.messages, facts.salvaged = log.content.salvaged;
  facts.details = log.content.details;
  facts.topics = log.content.topics;
  facts.problems = log.content.problems;
  for (const auto& boot : log.boots) {
    facts.boots.push_back(boot_facts(*boot, log.content.format));
    facts.problems.insert(facts.problems.end(), boot->problems.begin(), boot->problems.end());
  }
  for (const auto& part : log.parts) {
    facts.flights.push_back(flight_facts(log, part, bin_m));
    // What was met while this flight was found; the boot's own stands there already.
    for (std::size_t i = part.boot->problems.size(); i < part.problems.size(); ++i)
      facts.problems.push_back(part.problems[i]);
  }
  facts.nothing = log.nothing;
  return facts;
}

}  // namespace quadsonde::product
