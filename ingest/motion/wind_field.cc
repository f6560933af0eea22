#include "ingest/motion/wind_field.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadsonde::ingest {
namespace {

constexpr double degree = std::numbers::pi / 180;

Eigen::Vector2d direction(double degrees) { return {std::cos(degrees * degree), std::sin(degrees * degree)}; }

Eigen::Vector2d turned(const Eigen::Vector2d& v, double degrees) {
  return Eigen::Rotation2Dd(degrees * degree) * v;  // N to E, so clockwise from above
}

using Levels = std::vector<WindField::Level>::const_iterator;

/// One profile of the table: levels of one time, not empty.
Eigen::Vector2d in_profile(Levels begin, Levels end, double height) {
  if (height <= begin->height) return begin->toward;
  for (auto level = begin + 1; level != end; ++level) {
    if (height > level->height) continue;
    const double part = (height - (level - 1)->height) / (level->height - (level - 1)->height);
    return (level - 1)->toward + part * (level->toward - (level - 1)->toward);
  }
  return (end - 1)->toward;
}

Eigen::Vector2d from_table(const std::vector<WindField::Level>& levels, double height, double time) {
  if (levels.empty()) return Eigen::Vector2d::Zero();
  const auto profile_end = [&](Levels begin) {
    return std::find_if(begin, levels.end(), [&](const auto& level) { return level.time > begin->time; });
  };
  auto begin = levels.begin();
  auto end = profile_end(begin);
  // The profile at or before `time`, and the one after it.
  while (end != levels.end() && end->time <= time) begin = end, end = profile_end(begin);
  const Eigen::Vector2d before = in_profile(begin, end, height);
  if (end == levels.end() || time <= begin->time) return before;
  const double part = (time - begin->time) / (end->time - begin->time);
  return before + part * (in_profile(end, profile_end(end), height) - before);
}

Eigen::Vector2d in_jet(const WindField::Jet& jet, double z) {
  const double speed = jet.ground + jet.gain * (1 - std::exp(-z / jet.scale)) +
                       jet.excess * std::exp(-std::pow((z - jet.height) / jet.width, 2));
  return speed * direction(jet.toward_deg + jet.turn_deg * (1 - std::exp(-z / jet.turn_scale)));
}

}  // namespace

Eigen::Vector2d WindField::mean(double height, double time) const {
  if (!steps.empty() && time >= steps.front().time) {
    const auto after = std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.time > time; });
    return std::prev(after)->toward;
  }
  const double z = std::max(height, 0.0);
  Eigen::Vector2d wind = toward;
  switch (model) {
    case Model::constant:
      break;
    case Model::power_law:
      wind *= std::pow(std::max(z, 0.1) / reference_height, power_exponent);
      break;
    case Model::log_law:
      wind *= std::log(std::max(z, 1.001 * roughness) / roughness) / std::log(reference_height / roughness);
      break;
    case Model::jet:
      wind = in_jet(jet, z);
      break;
    case Model::table:
      wind = from_table(levels, z, time);
      break;
  }
  return veer_deg_per_m == 0 ? wind : turned(wind, veer_deg_per_m * (z - reference_height));
}

}  // namespace quadsonde::ingest
