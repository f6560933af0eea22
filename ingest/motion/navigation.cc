#include "ingest/motion/navigation.h"

#include <algorithm>
#include <cmath>

#include "ingest/motion/drag.h"

namespace quadsonde::ingest {

Navigation::Navigation(const Eigen::Vector3d& p, const Eigen::Vector3d& v, double latency, double interval, double step)
    : p_(p),
      v_(v),
      step_(step),
      gain_(1 - std::exp(-interval / std::max(0.5, 3 * interval))),
      behind_(static_cast<std::size_t>(std::lround(latency / step))),
      past_{v} {}

void Navigation::update(const Seen& seen, const EulerAngles& attitude) {
  const Eigen::Vector3d vdot = q_NB_from_euler(attitude) * seen.force + Eigen::Vector3d(0, 0, standard_gravity);
  p_ += v_ * step_;
  v_ += vdot * step_;
  past_.push_back(v_);
  while (past_.size() > behind_ + 1) past_.pop_front();
  if (seen.velocity_is_new) {
    const Eigen::Vector3d correction = gain_ * (seen.velocity - past_.front());
    v_ += correction;
    for (auto& v : past_) v += correction;
  }
  if (seen.position_is_new) p_ += 0.5 * gain_ * (seen.position - p_);
}

void Navigation::rest(const Eigen::Vector3d& p) {
  p_ = p;
  v_.setZero();
  for (auto& v : past_) v.setZero();
}

}  // namespace quadsonde::ingest
