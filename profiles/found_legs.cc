#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "estimator/smoother/passes.h"
#include "profiles/legs.h"

namespace quadsonde::profiles {
namespace {

constexpr double hovering = 0.5;      // m/s
constexpr double shortest_leg = 5;    // s
constexpr double straight = 0.8;      // share of the way that leads on

ingest::Problem not_read(const std::string& text, const std::string& item) {
  return {ingest::Kind::usage,
          fmt::format("--leg-times {}: \"{}\" is no leg", text, item),
          {},
          "name legs as in \"up 10-130, down 150-270\", in seconds of time_s as `estimate` prints them"};
}

struct NamedLeg {
  Part part;
  double from, to;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<NamedLeg> parse_leg(std::string_view item) {
  NamedLeg leg{Part::level, 0, 0};
  if (item.starts_with("up "))
    leg.part = Part::up, item.remove_prefix(3);
  else if (item.starts_with("down "))
    leg.part = Part::down, item.remove_prefix(5);
  else
    return std::nullopt;
  item = trimmed(item);
  const char* end = item.data() + item.size();
  const auto first = std::from_chars(item.data(), end, leg.from);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != '-') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, leg.to);
  if (second.ec != std::errc{} || second.ptr != end || leg.to <= leg.from) return std::nullopt;
  return leg;
}

/// Points [first, last) of one kind.
struct Stretch {
  FoundLeg::Kind kind;
  std::size_t first, last;
};

/// Speed over ground, averaged over 4 s; empty without the smoother's steps.
std::vector<double> averaged_speed(const estimator::WindSeries& series) {
  if (!series.trace || series.trace->input.size() != series.points.size()) return {};
  const auto& steps = series.trace->input;
  std::vector<double> speed(steps.size());
  std::size_t begin = 0, end = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    for (; end < steps.size() && steps[end].seconds <= steps[i].seconds + 2; ++end) sum += steps[end].v;
    for (; steps[begin].seconds < steps[i].seconds - 2; ++begin) sum -= steps[begin].v;
    speed[i] = (sum / static_cast<double>(end - begin)).norm();
  }
  return speed;
}

std::vector<Stretch> stretches(const std::vector<Part>& parts, const std::vector<double>& speed) {
  std::vector<Stretch> all;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    auto kind = parts[i] == Part::up ? FoundLeg::Kind::ascent : FoundLeg::Kind::descent;
    if (parts[i] == Part::level)
      kind = speed.empty() || speed[i] < hovering ? FoundLeg::Kind::hover : FoundLeg::Kind::level;
    if (all.empty() || all.back().kind != kind)
      all.push_back({kind, i, i + 1});
    else
      all.back().last = i + 1;
  }
  return all;
}

/// The way that leads on over the whole way.
double straightness(const std::vector<estimator::Step>& steps, const Stretch& s) {
  Eigen::Vector2d on = Eigen::Vector2d::Zero();
  double way = 0;
  for (std::size_t i = s.first + 1; i < s.last; ++i) {
    const double h = std::min(2.0, steps[i].seconds - steps[i - 1].seconds);
    on += h * steps[i].v;
    way += h * steps[i].v.norm();
  }
  return way > 0 ? on.norm() / way : 0;
}

FoundLeg describe_leg(const estimator::WindSeries& series, const std::vector<std::optional<double>>& heights,
                      const std::vector<double>& speed, const Stretch& s) {
  const auto &first = series.points[s.first], &last = series.points[s.last - 1];
  FoundLeg leg{s.kind, first.time, last.time, ingest::to_seconds(last.time - first.time), {}, {}, 0, 0};
  for (std::size_t i = s.first; i < s.last; ++i) {
    if (heights[i]) {
      leg.lowest = leg.lowest ? std::min(*leg.lowest, *heights[i]) : *heights[i];
      leg.highest = leg.highest ? std::max(*leg.highest, *heights[i]) : *heights[i];
    }
    leg.climb += series.points[i].v_up / static_cast<double>(s.last - s.first);
    if (!speed.empty()) leg.speed += speed[i] / static_cast<double>(s.last - s.first);
  }
  if (s.kind == FoundLeg::Kind::level && straightness(series.trace->input, s) > straight)
    leg.kind = FoundLeg::Kind::transit;
  return leg;
}

}  // namespace

ingest::Result<std::vector<Part>> named_parts(const std::vector<estimator::WindPoint>& points,
                                              const std::string& text) {
  std::vector<Part> parts(points.size(), Part::level);
  std::string_view rest = text;
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    const auto item = trimmed(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    const auto leg = parse_leg(item);
    if (!leg) return ingest::fail(not_read(text, std::string(item)));
    bool any = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = ingest::to_seconds(points[i].time - ingest::LogTime{0});
      if (t < leg->from || t > leg->to) continue;
      parts[i] = leg->part;
      any = true;
    }
    if (!any)
      return ingest::fail(ingest::Kind::usage, fmt::format("--leg-times: the flight has no instant in \"{}\"", item), {},
                          "give seconds of time_s as `estimate` prints them");
  }
  return parts;
}

std::optional<ingest::Problem> note_no_climb(const std::vector<Part>& parts,
                                             const std::vector<std::optional<double>>& heights, double bin_m) {
  if (std::any_of(parts.begin(), parts.end(), [](Part part) { return part != Part::level; })) return std::nullopt;
  double low = 1e9, high = -1e9;
  for (const auto& h : heights)
    if (h) low = std::min(low, *h), high = std::max(high, *h);
  const auto stays = high - low >= 2 ? fmt::format("stays between {:.0f} and {:.0f} m", low, high)
                                     : fmt::format("stays near {:.0f} m", (low + high) / 2);
  const double smaller = std::max(1.0, std::floor((high - low) / 2));
  return ingest::Problem{
      ingest::Kind::missing,
      fmt::format("the flight has no climb or descent of one bin ({} m) that leads on: it {}, so its rows are of those "
                  "heights only and `up` and `down` are not told apart",
                  bin_m, stays),
      {},
      high - low >= 4 && smaller < bin_m
          ? fmt::format("for a profile, climb higher, or take smaller bins with --bin-m {:.0f}", smaller)
          : "for a profile, climb 100 m and more at 1 to 3 m/s, then descend as slowly"};
}

std::vector<FoundLeg> found_legs(const estimator::WindSeries& series, const std::vector<Part>& parts,
                                 const std::vector<std::optional<double>>& heights) {
  std::vector<FoundLeg> legs;
  const auto speed = averaged_speed(series);
  for (const auto& stretch : stretches(parts, speed)) {
    auto leg = describe_leg(series, heights, speed, stretch);
    if (leg.seconds >= shortest_leg) legs.push_back(std::move(leg));
  }
  return legs;
}

}  // namespace quadsonde::profiles
