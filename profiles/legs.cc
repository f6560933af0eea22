#include "profiles/legs.h"

#include <algorithm>
#include <cmath>

namespace quadsonde::profiles {
namespace {

struct Run {
  Part part;
  std::size_t first, last;  // inclusive
};

std::vector<double> averaged_climb(const std::vector<estimator::WindPoint>& points, double window) {
  std::vector<double> mean(points.size());
  const auto half = ingest::seconds(window / 2);
  std::size_t begin = 0, end = 0;
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (; end < points.size() && points[end].time <= points[i].time + half; ++end) sum += points[end].v_up;
    for (; points[begin].time < points[i].time - half; ++begin) sum -= points[begin].v_up;
    mean[i] = sum / static_cast<double>(end - begin);
  }
  return mean;
}

std::vector<Run> runs_of(const std::vector<Part>& parts) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (runs.empty() || runs.back().part != parts[i])
      runs.push_back({parts[i], i, i});
    else
      runs.back().last = i;
  }
  return runs;
}

void paint(std::vector<Part>& parts, const Run& run, Part part) {
  std::fill(parts.begin() + static_cast<std::ptrdiff_t>(run.first), parts.begin() + static_cast<std::ptrdiff_t>(run.last) + 1,
            part);
}

double extent(const Run& run, const std::vector<std::optional<double>>& heights) {
  double low = 1e300, high = -1e300;
  for (std::size_t i = run.first; i <= run.last; ++i)
    if (heights[i]) low = std::min(low, *heights[i]), high = std::max(high, *heights[i]);
  return std::max(0.0, high - low);
}

}  // namespace

void add_climb_rates(std::vector<estimator::WindPoint>& points, const std::vector<std::optional<double>>& heights) {
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double span = ingest::to_seconds(points[i + 1].time - points[i - 1].time);
    if (heights[i - 1] && heights[i + 1] && span > 0) points[i].v_up = (*heights[i + 1] - *heights[i - 1]) / span;
  }
}

std::vector<Part> find_parts(const std::vector<estimator::WindPoint>& points,
                             const std::vector<std::optional<double>>& heights, double least_extent,
                             const LegSettings& settings) {
  std::vector<Part> parts(points.size(), Part::level);
  const auto climb = averaged_climb(points, settings.smoothing);
  for (std::size_t i = 0; i < points.size(); ++i)
    parts[i] = climb[i] > settings.climb_rate ? Part::up : climb[i] < -settings.climb_rate ? Part::down : Part::level;
  const auto pause = ingest::seconds(settings.longest_pause);
  // Pauses first, so that a climb in steps is one leg before its extent is judged.
  auto runs = runs_of(parts);
  for (std::size_t r = 1; r + 1 < runs.size(); ++r)
    if (runs[r].part == Part::level && runs[r - 1].part == runs[r + 1].part &&
        points[runs[r].last].time - points[runs[r].first].time < pause)
      paint(parts, runs[r], runs[r - 1].part);
  for (const auto& run : runs_of(parts))
    if (run.part != Part::level && extent(run, heights) < least_extent) paint(parts, run, Part::level);
  return parts;
}

}  // namespace quadsonde::profiles
