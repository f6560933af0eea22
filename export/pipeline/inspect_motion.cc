// What a flight's motion can show of wind, tilt trim, drag and latency. Source: design notes, section 8.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "estimator/filter/excitation.h"
#include "export/pipeline/inspect.h"
#include "ingest/flight/rotation.h"
#include "profiles/legs.h"

namespace quadsonde::product {
namespace {

using ingest::Flight;

/// Below: the nose turned too little to tell the trim from the wind. The estimator's limit too.
constexpr double least_heading_index = 0.4;
/// From here on the latency is told apart from the drag; each reversal gives it to some 10 ms.
constexpr int enough_reversals = 4;
constexpr double longest_turn = 15;  ///< from leg to leg; a survey's multirotor takes 5 to 10 s [s]

/// Heading at every velocity sample of the flight, with that velocity.
struct Motion {
  std::vector<double> seconds, heading;
  std::vector<std::complex<double>> velocity;  ///< N + iE
};

Motion motion_of(const Flight& f) {
  Motion motion;
  for (std::size_t i = 0; i < f.velocity.size(); ++i) {
    const auto at = ingest::last_at_or_before(f.attitude, f.velocity.time[i]);
    if (at < 0) continue;
    motion.seconds.push_back(ingest::to_seconds(f.velocity.time[i] - f.velocity.time[0]));
    motion.heading.push_back(ingest::heading(f.attitude.value[static_cast<std::size_t>(at)]));
    motion.velocity.emplace_back(f.velocity.value[i].x(), f.velocity.value[i].y());
  }
  return motion;
}

/// Excitation, and what is left of the motion's spread once it is taken off: the part that turns with the nose.
void find_excitation(const Motion& motion, Manoeuvre& m) {
  estimator::ExcitationSums sums;
  std::complex<double> sum = 0;
  double square = 0;
  for (std::size_t i = 0; i < motion.velocity.size(); ++i) {
    const auto v = motion.velocity[i];
    sums.add(v.real(), v.imag(), motion.heading[i]);
    sum += v, square += std::norm(v);
  }
  const auto n = static_cast<double>(motion.velocity.size());
  if (n < 2) return;
  m.excitation = sums.index();
  const double spread = square / n - std::norm(sum / n);
  m.turning_motion = std::sqrt(std::max(0.0, spread - m.excitation * m.excitation));
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

struct StraightLeg {
  double from = 0, to = 0;
  std::complex<double> velocity;
};

/// Stretches of 3 s and more, faster than 1 m/s, in which the velocity stays near its own mean and does not turn: a
/// stretch of a circle, which ends where the velocity has left its mean, shows it between its halves.
std::vector<StraightLeg> straight_legs(const Motion& m) {
  std::vector<StraightLeg> legs;
  for (std::size_t begin = 0, end; begin < m.velocity.size(); begin = end) {
    std::complex<double> sum = m.velocity[begin];
    for (end = begin + 1; end < m.velocity.size(); ++end) {
      const auto mean = sum / static_cast<double>(end - begin);
      if (std::abs(m.velocity[end] - mean) > 0.35 * std::abs(mean)) break;
      sum += m.velocity[end];
    }
    const auto n = static_cast<double>(end - begin);
    const StraightLeg leg{m.seconds[begin], m.seconds[end - 1], sum / n};
    std::complex<double> turn = 0;  // mean of the second half minus that of the first
    for (std::size_t i = begin; i < end; ++i) turn += (2 * i < begin + end ? -2.0 : 2.0) * m.velocity[i] / n;
    const double speed = std::abs(leg.velocity);
    if (leg.to - leg.from >= 3 && speed >= 1 && std::abs(turn) < 0.2 * speed) legs.push_back(leg);
  }
  return legs;
}

int reversals_of(const Motion& m) {
  const auto legs = straight_legs(m);
  int count = 0;
  for (std::size_t i = 1; i < legs.size(); ++i) {
    const double turn = std::abs(legs[i].velocity - legs[i - 1].velocity);
    const double speed = std::max(std::abs(legs[i].velocity), std::abs(legs[i - 1].velocity));
    count += legs[i].from - legs[i - 1].to <= longest_turn && turn >= speed;
  }
  return count;
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

bool climbs(const Manoeuvre& m, double bin_m) {
  return m.lowest && *m.highest - *m.lowest >= bin_m && m.ascents + m.descents > 0;
}

std::string needed(const Manoeuvre& m) {
  return fmt::format("(excitation {:.2f} m/s; {:.1f} are needed)", m.excitation, estimator::enough_excitation);
}

}  // namespace

Manoeuvre find_manoeuvre(const FlightPart& part, double bin_m) {
  const auto flight = part.airborne();
  Manoeuvre m;
  const auto motion = motion_of(flight);
  m.heading_index = heading_index_of(motion);
  m.turned_deg = turned(motion);
  find_excitation(motion, m);
  m.reversals = reversals_of(motion);
  for (const auto& v : flight.velocity.value) m.max_speed = std::max(m.max_speed, v.norm());
  find_climbs(height_points(flight, part.takeoff, m.above_takeoff), bin_m, m);
  return m;
}

Observability observability(const Manoeuvre& m, double bin_m) {
  using Wind = Observability::Wind;
  using Drag = Observability::Drag;
  Observability o;
  o.trim = m.heading_index >= least_heading_index;
  o.latency = m.reversals >= enough_reversals;
  if (m.excitation >= estimator::enough_excitation)
    o.drag = o.latency ? Drag::yes : Drag::with_latency_known;
  else
    o.drag = m.excitation >= estimator::some_excitation ? Drag::refused : Drag::no;
  const bool motion_turns = m.turning_motion >= estimator::some_excitation;
  if (!o.trim)
    o.wind = climbs(m, bin_m) ? Wind::shear_only : Wind::within_trim_prior;
  else if (climbs(m, bin_m))
    o.wind = Wind::by_height;
  else
    o.wind = motion_turns && m.excitation < estimator::enough_excitation ? Wind::with_drag_given : Wind::yes;
  return o;
}

std::string_view name(Observability::Wind wind) {
  switch (wind) {
    case Observability::Wind::yes:
      break;
    case Observability::Wind::by_height:
      return "by_height";
    case Observability::Wind::with_drag_given:
      return "with_drag_given";
    case Observability::Wind::within_trim_prior:
      return "within_trim_prior";
    case Observability::Wind::shear_only:
      return "shear_only";
  }
  return "yes";
}

std::string_view name(Observability::Drag drag) {
  switch (drag) {
    case Observability::Drag::yes:
      return "yes";
    case Observability::Drag::with_latency_known:
      return "with_latency_known";
    case Observability::Drag::refused:
      return "refused";
    case Observability::Drag::no:
      break;
  }
  return "no";
}

std::string wind_sentence(const Observability& o) {
  const std::string within = "only within what is known of the tilt trim, 0.7 m/s for each degree of it";
  switch (o.wind) {
    case Observability::Wind::yes:
      break;
    case Observability::Wind::by_height:
      return "yes, by height: the nose turned on the way, which tells it from the tilt trim";
    case Observability::Wind::with_drag_given:
      return "yes, with the vehicle's drag given: motion and nose turned together, so an error of the drag passes for "
             "a tilt trim";
    case Observability::Wind::within_trim_prior:
      return within;
    case Observability::Wind::shear_only:
      return "its change with height, yes; its level " + within;
  }
  return "yes: the nose turned, which tells it from the tilt trim";
}

std::string trim_sentence(const Observability& o) {
  return o.trim ? "observed: the nose turned" : std::string(estimator::sentence(estimator::Reason::trim_unobserved));
}

std::string drag_sentence(const Observability& o, const Manoeuvre& m) {
  switch (o.drag) {
    case Observability::Drag::yes:
      return "yes: calibrate can find it from this flight " + needed(m);
    case Observability::Drag::with_latency_known:
      return "yes where the latency is known, else some 5 % off: steady turns do not tell the two apart " + needed(m);
    case Observability::Drag::refused:
      return "no: a fit would be 4 to 12 % off, so calibrate refuses it " + needed(m);
    case Observability::Drag::no:
      break;
  }
  return "no, whatever a fit may say: no motion but what wind and tilt trim explain as well " + needed(m);
}

std::string latency_sentence(const Observability& o, const Manoeuvre& m) {
  if (o.latency) return fmt::format("yes: {} reversals between straight legs", m.reversals);
  return "no: it shows in straight legs with abrupt reversals" +
         (m.reversals ? fmt::format(", of which there are {}", m.reversals) : std::string());
}

}  // namespace quadsonde::product
