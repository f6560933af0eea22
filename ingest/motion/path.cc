#include "ingest/motion/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ingest/flight/rotation.h"

namespace quadsonde::ingest {
namespace {

constexpr double degree = std::numbers::pi / 180;

Eigen::Vector2d direction(double degrees) { return {std::cos(degrees * degree), std::sin(degrees * degree)}; }

}  // namespace

std::vector<PathLeg> with_take_off_and_landing(std::vector<PathLeg> path, double start_height) {
  if (path.empty()) return path;
  PathLeg wait;
  wait.duration = 3;
  wait.heading = path.front().heading;
  wait.heading.rate_deg_s = 0;
  PathLeg up = path.front();
  up.kind = PathLeg::Kind::climb;
  up.speed = 1;
  up.to_height = start_height;
  PathLeg down = up;
  down.heading = path.back().heading;
  down.to_height = 0;
  wait.heading.kind = HeadingRule::Kind::fixed;
  path.insert(path.begin(), {wait, up});
  wait.heading = path.back().heading;
  path.push_back(down);
  wait.heading.kind = HeadingRule::Kind::turning;
  wait.heading.rate_deg_s = 0;
  path.push_back(wait);
  return path;
}

Path::Path(const std::vector<PathLeg>& legs, double first_height, double step) : legs_(legs), step_(step) {
  wish_.position.z() = -first_height;
}

const Wish& Path::next() {
  const PathLeg& leg = legs_[leg_];
  wish_.velocity = velocity(leg);
  wish_.position += wish_.velocity * step_;
  time_in_leg_ += step_;
  turn(leg);
  if (finished(leg)) begin_next();
  return wish_;
}

Eigen::Vector3d Path::velocity(const PathLeg& leg) {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  const double sides = std::floor(time_in_leg_ / std::max(leg.side_duration, step_));
  switch (leg.kind) {
    case PathLeg::Kind::hover:
      break;
    case PathLeg::Kind::climb:
      v.z() = climb(leg);
      break;
    case PathLeg::Kind::line:
      v.head<2>() = leg.speed * direction(leg.course_deg + (leg.back_and_forth && std::fmod(sides, 2) > 0 ? 180 : 0));
      break;
    case PathLeg::Kind::square:
      v.head<2>() = leg.speed * direction(leg.course_deg + 90 * std::fmod(sides, 4));
      break;
    case PathLeg::Kind::circle:
      v.head<2>() = leg.speed * direction(leg.course_deg + leg.speed / leg.radius * time_in_leg_ / degree);
      break;
  }
  return v;
}

double Path::climb(const PathLeg& leg) {
  if (pause_left_ > 0) {
    pause_left_ -= step_;
    return 0;
  }
  if (leg.pause_every > 0 && climbed_ >= leg.pause_every) {
    climbed_ = 0;
    pause_left_ = leg.pause;
    return 0;
  }
  climbed_ += leg.speed * step_;
  return -wish_.position.z() < leg.to_height ? -leg.speed : leg.speed;
}

bool Path::finished(const PathLeg& leg) const {
  if (leg.kind == PathLeg::Kind::climb) return std::abs(-wish_.position.z() - leg.to_height) <= leg.speed * step_;
  return time_in_leg_ >= leg.duration - step_ / 2;
}

void Path::turn(const PathLeg& leg) {
  switch (leg.heading.kind) {
    case HeadingRule::Kind::fixed:
      wish_.heading = leg.heading.degrees * degree;
      break;
    case HeadingRule::Kind::turning:
      if (time_in_leg_ <= step_ && leg_ == 0) wish_.heading = leg.heading.degrees * degree;
      wish_.heading += leg.heading.rate_deg_s * degree * step_;
      break;
    case HeadingRule::Kind::along_track: {
      if (wish_.velocity.head<2>().norm() < 0.1) break;
      const double ahead = std::atan2(wish_.velocity.y(), wish_.velocity.x());
      // A nose does not jump at a corner: 90 deg/s at most.
      const double most = 90 * degree * step_;
      wish_.heading += std::clamp(wrap_angle(ahead - wish_.heading), -most, most);
      break;
    }
  }
  wish_.heading = wrap_angle(wish_.heading);
}

void Path::begin_next() {
  ++leg_;
  time_in_leg_ = climbed_ = pause_left_ = 0;
}

}  // namespace quadsonde::ingest
