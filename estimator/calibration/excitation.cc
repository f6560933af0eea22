#include "estimator/calibration/excitation.h"

namespace quadsonde::estimator {

double excitation_index(const std::vector<Step>& steps) {
  ExcitationSums sums;
  for (const auto& step : steps)
    if (step.sound) sums.add(step.v.x(), step.v.y(), step.heading);
  return sums.weight() < 3 ? 0 : sums.index();
}

}  // namespace quadsonde::estimator
