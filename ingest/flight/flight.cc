#include "ingest/flight/flight.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

namespace quadsonde::ingest {
namespace {

bool finite(const Eigen::Quaterniond& q) { return q.coeffs().allFinite() && q.norm() > 0.5; }
bool finite(const Eigen::Vector3d& v) { return v.allFinite(); }
bool finite(const GeoPoint& p) {
  // Receivers write 0, 0 before the first fix; no multirotor flies in the Gulf of Guinea to the metre.
  return std::abs(p.lat_deg) <= 90 && std::abs(p.lon_deg) <= 360 && !(p.lat_deg == 0 && p.lon_deg == 0);
}
bool finite(const MslHeight& h) { return std::isfinite(h.m) && std::abs(h.m) < 2e4; }
bool finite(const EllipsoidHeight& h) { return std::isfinite(h.m) && std::abs(h.m) < 2e4; }
bool finite(const GroundHeight& h) { return std::isfinite(h.m) && std::abs(h.m) < 2e4; }
bool finite(const AutopilotWind& w) { return w.v_NA_N.allFinite(); }
template <class T>
bool finite(const T&) {
  return true;
}

/// Keeps the rows that `order` names, in that order.
template <class T>
void pick(std::vector<T>& column, const std::vector<std::size_t>& order) {
  std::vector<T> kept;
  kept.reserve(order.size());
  for (const auto i : order) kept.push_back(column[i]);
  column = std::move(kept);
}

/// The rows of a stream that are finite, in time order; empty optional when nothing has to change.
template <class T>
std::optional<std::vector<std::size_t>> sound_rows(const Stream<T>& stream) {
  bool sorted = true, sound = true;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    sorted = sorted && (i == 0 || stream.time[i - 1] <= stream.time[i]);
    sound = sound && finite(static_cast<const T&>(stream.value[i]));
  }
  if (sorted && sound) return std::nullopt;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < stream.size(); ++i)
    if (finite(static_cast<const T&>(stream.value[i]))) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return stream.time[a] < stream.time[b]; });
  return order;
}

void tidy_sd(VelocityStream& stream, const std::vector<std::size_t>& order) {
  if (!stream.sd.empty()) pick(stream.sd, order);
}
template <class T>
void tidy_sd(Stream<T>&, const std::vector<std::size_t>&) {}

template <class S>
void tidy_stream(S& stream, std::vector<Problem>& problems, const char* name) {
  const auto order = sound_rows(stream);
  if (!order) return;
  const auto lost = stream.size() - order->size();
  tidy_sd(stream, *order);
  pick(stream.time, *order);
  pick(stream.value, *order);
  if (lost > 0)
    problems.push_back({Kind::damaged, fmt::format("{} of {} {} samples are not numbers and were left out", lost,
                                                   lost + stream.size(), name),
                        {{}, {}, {}, stream.source}, "the rest is used"});
}

template <class F, class Function>
void for_each_stream(F& flight, Function&& function) {
  function(flight.attitude, "attitude");
  function(flight.velocity, "velocity");
  function(flight.position, "position");
  function(flight.local_position, "local position");
  function(flight.height_msl, "MSL height");
  function(flight.height_ellipsoid, "ellipsoid height");
  function(flight.height_ground, "height above take-off");
  function(flight.barometer, "barometer");
  function(flight.accelerometer, "accelerometer");
  function(flight.rotors, "rotor speed");
  function(flight.air, "air temperature and humidity");
  function(flight.autopilot_wind, "autopilot wind");
  function(flight.events, "event");
  function(flight.landed, "landed");
}

template <class T>
void cut_stream(Stream<T>& stream, std::size_t first, std::size_t last) {
  const auto range = [&](auto& column) {
    column.erase(column.begin() + static_cast<std::ptrdiff_t>(last), column.end());
    column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  };
  range(stream.time);
  range(stream.value);
}

}  // namespace

void tidy(Flight& flight) {
  for_each_stream(flight, [&](auto& stream, const char* name) { tidy_stream(stream, flight.problems, name); });
  // A unit quaternion stays as it is, so that tidying twice changes no bit.
  for (auto& q : flight.attitude.value)
    if (std::abs(q.squaredNorm() - 1) > 1e-14) q.normalize();
}

std::optional<std::pair<LogTime, LogTime>> time_span(const Flight& flight) {
  std::optional<std::pair<LogTime, LogTime>> span;
  const auto add = [&](const std::vector<LogTime>& time) {
    if (time.empty()) return;
    if (!span) span = {time.front(), time.back()};
    span = {std::min(span->first, time.front()), std::max(span->second, time.back())};
  };
  add(flight.attitude.time);
  add(flight.velocity.time);
  return span;
}

Flight cut(const Flight& flight, LogTime from, LogTime to) {
  Flight part = flight;
  for_each_stream(part, [&](auto& stream, const char*) {
    const auto begin = stream.time.begin();
    const auto first = static_cast<std::size_t>(std::lower_bound(begin, stream.time.end(), from) - begin);
    const auto last = std::max(first, static_cast<std::size_t>(std::upper_bound(begin, stream.time.end(), to) - begin));
    if constexpr (requires { stream.sd; })
      if (!stream.sd.empty())
        stream.sd = std::vector<double>(stream.sd.begin() + static_cast<std::ptrdiff_t>(first),
                                        stream.sd.begin() + static_cast<std::ptrdiff_t>(last));
    cut_stream(stream, first, last);
  });
  return part;
}

}  // namespace quadsonde::ingest
