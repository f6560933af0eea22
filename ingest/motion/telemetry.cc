#include "ingest/motion/telemetry.h"

#include <algorithm>
#include <cmath>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest {
namespace {

using Eigen::Vector2d;

double median_interval(const std::vector<double>& time) {
  if (time.size() < 2) return 0.1;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < time.size(); ++i) gaps.push_back(time[i] - time[i - 1]);
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return std::max(*middle, 1e-4);
}

/// How many samples make one mean, so that means are not closer than `shortest`.
std::size_t group_size(double interval, double shortest) {
  return static_cast<std::size_t>(std::max(1.0, std::round(shortest / interval)));
}

struct RawAttitude {
  std::vector<double> time, heading;
  std::vector<Vector2d> tilt;
  std::size_t steep = 0;
};

RawAttitude raw_attitude(const Stream<Eigen::Quaterniond>& attitude, LogTime origin) {
  RawAttitude raw;
  double psi_before = 0;
  for (std::size_t i = 0; i < attitude.size(); ++i) {
    const double t = to_seconds(attitude.time[i] - origin);
    if (!raw.time.empty() && t <= raw.time.back()) continue;  // a repeated time adds nothing
    const Eigen::Vector3d n = attitude.value[i] * Eigen::Vector3d::UnitZ();
    const double psi = heading(attitude.value[i]);
    psi_before = raw.time.empty() ? psi : psi_before + wrap_angle(psi - psi_before);
    if (n.z() < 0.5) ++raw.steep;
    // Beyond 80 degrees a slope means nothing.
    const Vector2d s = n.z() > 0.17 ? thrust_slope<double>(n) : Vector2d::Zero();
    raw.time.push_back(t);
    raw.heading.push_back(psi_before);
    raw.tilt.push_back(turned(s, -psi_before));
  }
  return raw;
}

void fill_attitude(Telemetry& out, const RawAttitude& raw) {
  const std::size_t group = group_size(median_interval(raw.time), 0.02);
  for (std::size_t i = 0; i < raw.time.size();) {
    double n = 0, t = 0, psi = 0;
    Vector2d tilt = Vector2d::Zero();
    const double begin = raw.time[i];
    // A group never reaches over a hole.
    for (; i < raw.time.size() && n < static_cast<double>(group) && (group == 1 || raw.time[i] - begin < 0.03); ++i)
      n += 1, t += raw.time[i], psi += raw.heading[i], tilt += raw.tilt[i];
    out.attitude_time.push_back(t / n);
    out.heading.push_back(psi / n);
    out.tilt.push_back(tilt / n);
    out.slope.push_back(turned(tilt / n, psi / n));
  }
  out.attitude_interval = median_interval(out.attitude_time);
  out.steep = raw.time.empty() ? 0 : static_cast<double>(raw.steep) / static_cast<double>(raw.time.size());
}

void fill_velocity(Telemetry& out, const VelocityStream& velocity) {
  std::vector<double> time;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    const double t = to_seconds(velocity.time[i] - velocity.time.front());
    if (!time.empty() && t <= time.back()) continue;
    time.push_back(t);
    rows.push_back(i);
  }
  const std::size_t group = group_size(median_interval(time), 0.09);
  for (std::size_t i = 0; i < time.size();) {
    double n = 0, t = 0;
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    const double begin = time[i];
    for (; i < time.size() && n < static_cast<double>(group) && (group == 1 || time[i] - begin < 0.15); ++i)
      n += 1, t += time[i], v += velocity.value[rows[i]];
    out.velocity_time.push_back(t / n);
    out.v.push_back(v.head<2>() / n);
    out.v_down.push_back(v.z() / n);
  }
  out.velocity_interval = median_interval(out.velocity_time);
}

/// Index of the first element after t.
std::size_t after(const std::vector<double>& time, double t) {
  return static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
}

/// Is there an attitude sample at most `hole` from everywhere between two velocity samples?
bool covered(const Telemetry& t, std::size_t i, double hole) {
  const double from = t.velocity_time[i], to = t.velocity_time[i + 1];
  const std::size_t k = after(t.attitude_time, from);
  if (k == 0 || k >= t.attitude_time.size())
    return from >= t.attitude_time.front() - hole && to <= t.attitude_time.back() + hole;
  return t.attitude_time[k] - t.attitude_time[k - 1] <= hole;
}

void divide(std::size_t first, std::size_t last, const Telemetry& t, double length, std::vector<ShootingWindow>& out) {
  const double span = t.velocity_time[last] - t.velocity_time[first];
  if (span < length / 2) return;
  // A burst of samples must not make a covariance of gigabytes.
  constexpr double most_samples = 250;
  const double by_count = std::ceil(static_cast<double>(last - first + 1) / most_samples);
  const auto parts = static_cast<std::size_t>(std::max({1.0, std::round(span / length), by_count}));
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t n = last - first;
    const ShootingWindow window{first + part * n / parts, first + (part + 1) * n / parts - (part + 1 < parts ? 1 : 0)};
    // Too few samples say nothing beside four free parameters.
    if (window.last > window.first + 11) out.push_back(window);
  }
}

}  // namespace

Vector2d turned(const Vector2d& x, double heading) {
  const double c = std::cos(heading), s = std::sin(heading);
  return {c * x.x() - s * x.y(), s * x.x() + c * x.y()};
}

double interpolated(const std::vector<double>& time, const std::vector<double>& value, double t) {
  const std::size_t k = after(time, t);
  if (k == 0) return value.front();
  if (k == time.size()) return value.back();
  return value[k - 1] + (t - time[k - 1]) / (time[k] - time[k - 1]) * (value[k] - value[k - 1]);
}

std::vector<double> smoothed_slope(const std::vector<double>& time, const std::vector<double>& value) {
  std::vector<double> slope(time.size(), 0.0);
  std::size_t begin = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    while (time[begin] < time[i] - 0.5001) ++begin;
    double n = 0, st = 0, stt = 0, sv = 0, stv = 0;
    for (std::size_t k = begin; k < time.size() && time[k] <= time[i] + 0.5001; ++k) {
      const double t = time[k] - time[i], v = value[k] - value[i];
      n += 1, st += t, stt += t * t, sv += v, stv += t * v;
    }
    const double spread = stt - st * st / n;
    if (n >= 3 && spread > 1e-9) slope[i] = (stv - st * sv / n) / spread;
  }
  return slope;
}

Telemetry telemetry_of(const Flight& flight) {
  Telemetry out;
  if (flight.velocity.empty()) return out;
  fill_velocity(out, flight.velocity);
  fill_attitude(out, raw_attitude(flight.attitude, flight.velocity.time.front()));
  out.vdot_down = smoothed_slope(out.velocity_time, out.v_down);
  return out;
}

std::vector<ShootingWindow> shooting_windows(const Telemetry& t, double length, std::size_t most) {
  std::vector<ShootingWindow> all;
  if (t.velocity_time.size() < 2 || t.attitude_time.size() < 2) return all;
  const double velocity_hole = std::max(0.5, 5 * t.velocity_interval);
  const double attitude_hole = std::max(0.5, 5 * t.attitude_interval);
  std::size_t first = 0;
  for (std::size_t i = 0; i + 1 < t.velocity_time.size(); ++i) {
    if (t.velocity_time[i + 1] - t.velocity_time[i] <= velocity_hole && covered(t, i, attitude_hole)) continue;
    divide(first, i, t, length, all);
    first = i + 1;
  }
  divide(first, t.velocity_time.size() - 1, t, length, all);
  if (all.size() <= most) return all;
  std::vector<ShootingWindow> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

MotionCourse course_of(const Telemetry& t, const ShootingWindow& window, double latency, double gravity) {
  const double from = t.velocity_time[window.first], to = t.velocity_time[window.last];
  std::vector<double> times(t.velocity_time.begin() + static_cast<std::ptrdiff_t>(window.first),
                            t.velocity_time.begin() + static_cast<std::ptrdiff_t>(window.last) + 1);
  for (std::size_t k = after(t.attitude_time, from - latency); k < t.attitude_time.size(); ++k) {
    const double at = t.attitude_time[k] + latency;
    if (at >= to) break;
    times.push_back(at);
  }
  std::sort(times.begin(), times.end());
  // Two clocks that tick together but for rounding make one node.
  times.erase(std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < 1e-6; }), times.end());
  times.back() = to;
  MotionCourse course;
  course.reserve(times.size());
  std::size_t a = 0, v = window.first;
  for (const double at : times) {
    while (a + 2 < t.attitude_time.size() && t.attitude_time[a + 1] + latency <= at) ++a;
    while (v + 2 < t.velocity_time.size() && t.velocity_time[v + 1] <= at) ++v;
    const double p =
        std::clamp((at - latency - t.attitude_time[a]) / (t.attitude_time[a + 1] - t.attitude_time[a]), 0.0, 1.0);
    const double q = std::clamp((at - t.velocity_time[v]) / (t.velocity_time[v + 1] - t.velocity_time[v]), 0.0, 1.0);
    MotionNode node;
    node.time = at - from;
    node.slope = t.slope[a] + p * (t.slope[a + 1] - t.slope[a]);
    node.heading = t.heading[a] + p * (t.heading[a + 1] - t.heading[a]);
    node.lift = gravity - (t.vdot_down[v] + q * (t.vdot_down[v + 1] - t.vdot_down[v]));
    node.v_down = t.v_down[v] + q * (t.v_down[v + 1] - t.v_down[v]);
    course.push_back(node);
  }
  return course;
}

}  // namespace quadsonde::ingest
