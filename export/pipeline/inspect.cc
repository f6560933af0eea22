#include "export/pipeline/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "export/report/autopilot_wind.h"
#include "ingest/flight/rotation.h"
#include "ingest/open/open_log.h"
#include "profiles/legs.h"

namespace quadsonde::product {
namespace {

using ingest::Flight;

// Below: the nose turned too little to tell trim from wind; the motion too little to tell drag from wind.
constexpr double least_heading_index = 0.4, least_excitation = 1.5;

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

/// Heading at every velocity sample of the flight, with that velocity.
struct Motion {
  std::vector<double> heading;
  std::vector<std::complex<double>> velocity;  ///< N + iE
};

Motion motion_of(const Flight& f) {
  Motion motion;
  for (std::size_t i = 0; i < f.velocity.size(); ++i) {
    const auto at = ingest::last_at_or_before(f.attitude, f.velocity.time[i]);
    if (at < 0) continue;
    motion.heading.push_back(ingest::heading(f.attitude.value[static_cast<std::size_t>(at)]));
    motion.velocity.emplace_back(f.velocity.value[i].x(), f.velocity.value[i].y());
  }
  return motion;
}

/// rms of v minus its projection on span{1, exp(i psi)}, both coefficients complex.
double excitation_of(const Motion& m) {
  using C = std::complex<double>;
  C sum_v = 0, sum_e = 0, sum_ve = 0;
  double vv = 0;
  const auto n = static_cast<double>(m.velocity.size());
  if (n < 2) return 0;
  for (std::size_t i = 0; i < m.velocity.size(); ++i) {
    const C e = std::polar(1.0, m.heading[i]);
    sum_v += m.velocity[i], sum_e += e, sum_ve += m.velocity[i] * std::conj(e), vv += std::norm(m.velocity[i]);
  }
  // Normal equations of v = a + b e: [n, E; conj(E), n] [a; b] = [V; VE].
  const double determinant = n * n - std::norm(sum_e);
  C a = sum_v / n, b = 0;
  if (determinant > 1e-9 * n * n) {
    b = (n * sum_ve - std::conj(sum_e) * sum_v) / determinant;
    a = (sum_v - b * sum_e) / n;
  }
  const double explained = std::real(std::conj(a) * sum_v + std::conj(b) * sum_ve);
  return std::sqrt(std::max(0.0, vv - explained) / n);
}

double heading_index_of(const Motion& m) {
  std::complex<double> sum = 0;
  for (const double psi : m.heading) sum += std::polar(1.0, psi);
  const auto n = static_cast<double>(m.heading.size());
  return n > 0 ? std::sqrt(std::max(0.0, 1 - std::norm(sum) / (n * n))) : 0;
}

double turned(const Motion& m) {
  double way = 0, at = m.heading.empty() ? 0 : m.heading[0];
  for (const double psi : m.heading) {
    const double step = ingest::wrap_angle(psi - at);
    if (std::abs(step) < 10 * std::numbers::pi / 180) continue;
    way += std::abs(step), at = psi;
  }
  return way * 180 / std::numbers::pi;
}

/// Heights at the velocity's times, as the estimator will see them.
std::vector<estimator::WindPoint> height_points(const Flight& f, const std::optional<ingest::MslHeight>& takeoff,
                                                bool& agl) {
  std::vector<estimator::WindPoint> points;
  agl = !f.height_ground.empty() || (takeoff && !f.height_msl.empty());
  for (std::size_t i = 0; i < f.velocity.size(); ++i) {
    estimator::WindPoint p;
    p.time = f.velocity.time[i];
    p.v_up = -f.velocity.value[i].z();
    const auto ground = ingest::last_at_or_before(f.height_ground, p.time),
               msl = ingest::last_at_or_before(f.height_msl, p.time);
    if (ground >= 0)
      p.height_agl = f.height_ground.value[static_cast<std::size_t>(ground)];
    else if (msl >= 0 && takeoff && f.height_ground.empty())
      p.height_agl = ingest::above_takeoff(f.height_msl.value[static_cast<std::size_t>(msl)], *takeoff);
    else if (msl >= 0 && !agl)
      p.height_agl = ingest::GroundHeight{f.height_msl.value[static_cast<std::size_t>(msl)].m};
    points.push_back(std::move(p));
  }
  return points;
}

void find_climbs(const std::vector<estimator::WindPoint>& points, double bin_m, Manoeuvre& m) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : points) {
    heights.push_back(p.height_agl ? std::optional(p.height_agl->m) : std::nullopt);
    if (!heights.back()) continue;
    m.lowest = std::min(m.lowest.value_or(*heights.back()), *heights.back());
    m.highest = std::max(m.highest.value_or(*heights.back()), *heights.back());
  }
  if (points.empty() || !m.lowest) return;
  const auto parts = profiles::find_parts(points, heights, bin_m / 2);
  for (std::size_t begin = 0, end; begin < parts.size(); begin = end) {
    end = begin + 1;
    while (end < parts.size() && parts[end] == parts[begin]) ++end;
    double low = 1e9, high = -1e9;
    for (std::size_t i = begin; i < end; ++i)
      if (heights[i]) low = std::min(low, *heights[i]), high = std::max(high, *heights[i]);
    if (high - low < bin_m) continue;
    m.ascents += parts[begin] == profiles::Part::up;
    m.descents += parts[begin] == profiles::Part::down;
  }
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
  facts.trim_can_be_measured = m.heading_index >= least_heading_index;
  facts.profile_possible = m.lowest && *m.highest - *m.lowest >= bin_m;
  facts.can_calibrate = m.excitation >= least_excitation;
  facts.advice = manoeuvre_advice(facts);
  return facts;
}

}  // namespace

Manoeuvre find_manoeuvre(const FlightPart& part, double bin_m) {
  const auto flight = part.airborne();
  Manoeuvre m;
  const auto motion = motion_of(flight);
  m.heading_index = heading_index_of(motion);
  m.turned_deg = turned(motion);
  m.excitation = excitation_of(motion);
  for (const auto& v : flight.velocity.value) m.max_speed = std::max(m.max_speed, v.norm());
  find_climbs(height_points(flight, part.takeoff, m.above_takeoff), bin_m, m);
  return m;
}

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
