#pragma once
#include <optional>

namespace quadsonde::profiles {

/// How winds of others are brought beside ours.
struct CompareSettings {
  double match_window_s = 600;
  double direction_above_m_s = 2;
  std::optional<double> representativeness_m_s;
};
template <class Visitor>
void describe(CompareSettings& s, Visitor&& visit) {
  visit("match_window_s", s.match_window_s, 0.0, 10800.0,
        "A report counts when the flight was so near to the ten minutes of its mean; if none was, the nearest counts.");
  visit("direction_above_m_s", s.direction_above_m_s, 0.5, 20.0, "Directions are scored where both speeds reach this.");
  visit("representativeness_m_s", s.representativeness_m_s, 0.0, 20.0,
        "1-sigma of what place and time add per component; left out, it follows from distance and time.");
}

/// Beyond these nothing is scored (design/CLI.md).
inline constexpr double longest_gap_s = 3 * 3600.0, longest_distance_m = 50e3;

}  // namespace quadsonde::profiles
