#pragma once
// How often something was measured.
#include <algorithm>
#include <vector>

#include "ingest/flight/time.h"

namespace quadsonde::ingest {

/// Median time between samples [s]; 0 with fewer than two.
inline double median_interval(const std::vector<LogTime>& time) {
  if (time.size() < 2) return 0;
  std::vector<double> steps;
  steps.reserve(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(to_seconds(time[i] - time[i - 1]));
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Whether a receiver is fast enough to be preferred to a filter: 4 Hz, a tenth of an interval left for jitter.
inline bool is_fast_receiver(const std::vector<LogTime>& time) {
  const double step = median_interval(time);
  return step > 0 && step <= 1.1 / 4;
}

}  // namespace quadsonde::ingest
