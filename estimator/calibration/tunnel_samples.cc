#include "estimator/calibration/tunnel_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::estimator {
namespace {

using ingest::LogTime;

constexpr double block = 0.1;  // [s]
constexpr double tilt_limit = std::numbers::pi / 4;

bool inside(const TunnelRun& run, LogTime t) { return !(run.start && t < *run.start) && !(run.end && *run.end < t); }

/// Mean and slope of the velocity around each of its samples.
struct Motion {
  std::vector<double> time, speed, acceleration;
};

Motion motion_of(const TunnelRun& run, LogTime origin) {
  std::vector<double> time;
  std::vector<Eigen::Vector3d> v;
  for (std::size_t i = 0; i < run.flight.velocity.size(); ++i) {
    if (!inside(run, run.flight.velocity.time[i])) continue;
    const double t = ingest::to_seconds(run.flight.velocity.time[i] - origin);
    if (!time.empty() && t <= time.back()) continue;
    time.push_back(t);
    v.push_back(run.flight.velocity.value[i]);
  }
  Motion motion;
  if (time.size() < 5) return motion;
  const double interval = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  const double half = std::max(1.0, 2.5 * interval) + 1e-4;
  std::size_t first = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    while (time[first] < time[i] - half) ++first;
    double n = 0, st = 0, stt = 0;
    Eigen::Vector3d sv = Eigen::Vector3d::Zero(), stv = Eigen::Vector3d::Zero();
    for (std::size_t k = first; k < time.size() && time[k] <= time[i] + half; ++k) {
      const double t = time[k] - time[i];
      n += 1, st += t, stt += t * t, sv += v[k], stv += t * v[k];
    }
    const double spread = stt - st * st / n;
    if (n < 4 || spread < 1e-9) continue;
    motion.time.push_back(time[i]);
    motion.speed.push_back((sv / n).norm());
    motion.acceleration.push_back(((stv - st * sv / n) / spread).norm());
  }
  return motion;
}

/// Collects the attitude of one block.
struct Block {
  double time = 0, pitch = 0, roll = 0, cosine = 0, sine = 0, tilt = 0;
  int count = 0;

  void add(double t, const Eigen::Quaterniond& q_NB) {
    const Eigen::Vector3d n = q_NB * Eigen::Vector3d::UnitZ();
    const double psi = ingest::heading(q_NB);
    tilt = std::max(tilt, std::acos(std::clamp(n.z(), -1.0, 1.0)));
    // n in heading axes is (sin theta cos phi, -sin phi, cos theta cos phi): both tangents without an angle.
    const double ahead = n.x() * std::cos(psi) + n.y() * std::sin(psi),
                 right = n.y() * std::cos(psi) - n.x() * std::sin(psi);
    const double down = std::max(n.z(), 0.17);
    time += t, pitch += ahead / down, roll -= right / down;
    cosine += std::cos(psi), sine += std::sin(psi);
    ++count;
  }
  TunnelSample mean() const { return {time / count, std::atan2(sine, cosine), pitch / count, roll / count}; }
};

std::vector<Block> blocks_of(const TunnelRun& run, LogTime origin) {
  std::vector<Block> blocks;
  long current = 0;
  for (std::size_t i = 0; i < run.flight.attitude.size(); ++i) {
    if (!inside(run, run.flight.attitude.time[i])) continue;
    const double t = ingest::to_seconds(run.flight.attitude.time[i] - origin);
    // Sampled at 10 Hz exactly, each sample falls in the middle of a block of its own.
    const long index = std::lround(t / block);
    if (blocks.empty() || index != current) blocks.emplace_back();
    current = index;
    blocks.back().add(t, run.flight.attitude.value[i]);
  }
  return blocks;
}

/// The motion nearest to a time; -1 if there is none within a second.
std::ptrdiff_t nearest(const Motion& motion, double t) {
  const auto after = std::lower_bound(motion.time.begin(), motion.time.end(), t);
  std::ptrdiff_t best = -1;
  double distance = 1.0;
  for (const auto candidate : {after - motion.time.begin() - 1, after - motion.time.begin()}) {
    if (candidate < 0 || candidate >= static_cast<std::ptrdiff_t>(motion.time.size())) continue;
    const double d = std::abs(motion.time[static_cast<std::size_t>(candidate)] - t);
    if (d < distance) best = candidate, distance = d;
  }
  return best;
}

}  // namespace

SteadySamples steady_samples(const TunnelRun& run, const TunnelSettings& settings) {
  SteadySamples out;
  if (run.flight.attitude.empty() || run.flight.velocity.empty()) return out;
  const LogTime origin = run.start ? *run.start : run.flight.attitude.time.front();
  const Motion motion = motion_of(run, origin);
  std::vector<double> speeds;
  for (const auto& b : blocks_of(run, origin)) {
    const TunnelSample sample = b.mean();
    const auto at = nearest(motion, sample.seconds);
    if (at < 0) continue;
    const auto k = static_cast<std::size_t>(at);
    ++out.seen;
    speeds.push_back(motion.speed[k]);
    if (b.tilt < tilt_limit && motion.speed[k] < settings.steady_speed &&
        motion.acceleration[k] < settings.steady_acceleration)
      out.samples.push_back(sample);
  }
  if (speeds.empty()) return out;
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  out.median_speed = *middle;
  return out;
}

double turn_covered_deg(const std::vector<TunnelSample>& samples) {
  constexpr int sectors = 36;
  std::array<bool, sectors> seen{};
  for (const auto& s : samples) {
    const double turn = s.heading / (2 * std::numbers::pi);
    seen[static_cast<std::size_t>((turn - std::floor(turn)) * sectors) % sectors] = true;
  }
  return 360.0 / sectors * static_cast<double>(std::count(seen.begin(), seen.end(), true));
}

}  // namespace quadsonde::estimator
