#include "tests/gates/scores.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace quadsonde::gates {
namespace {

using estimator::WindEstimate;

struct Pair {
  double seconds, height, climb;
  Eigen::Vector2d estimate, truth;
  Eigen::Matrix2d covariance;
  bool has_covariance;
};

/// True wind at the instant that an estimate claims, by linear interpolation.
Eigen::Vector2d truth_at(const ingest::Truth& truth, ingest::LogTime t) {
  auto after = std::lower_bound(truth.begin(), truth.end(), t, [](const auto& a, ingest::LogTime b) { return a.time < b; });
  if (after == truth.begin()) return after->v_NA_N.head<2>();
  if (after == truth.end()) return truth.back().v_NA_N.head<2>();
  const auto before = std::prev(after);
  const double part = ingest::to_seconds(t - before->time) / ingest::to_seconds(after->time - before->time);
  return (before->v_NA_N + part * (after->v_NA_N - before->v_NA_N)).head<2>();
}

double height_at(const ingest::Truth& truth, ingest::LogTime t) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), t, [](const auto& a, ingest::LogTime b) { return a.time < b; });
  return after == truth.end() ? truth.back().height.m : after->height.m;
}

std::vector<Pair> pairs(const estimator::WindSeries& series, const ingest::Truth& truth, double from_s) {
  std::vector<Pair> all;
  for (const auto& p : series.points) {
    const double t = ingest::to_seconds(p.time - truth.front().time);
    const auto* wind = std::get_if<WindEstimate>(&p.wind);
    if (!wind || t < from_s) continue;
    all.push_back({t, height_at(truth, p.time), p.v_up, wind->v_NA_N, truth_at(truth, p.time), wind->covariance,
                   wind->has_covariance});
  }
  return all;
}

/// Groups pairs by a key and gives the mean estimate and truth of each group.
template <class Key>
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> means(const std::vector<Pair>& all, Key&& key, std::size_t least) {
  std::map<std::pair<int, int>, std::vector<const Pair*>> groups;
  for (const auto& p : all) groups[key(p)].push_back(&p);
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> out;
  for (const auto& [k, group] : groups) {
    if (group.size() < least) continue;
    Eigen::Vector2d e = Eigen::Vector2d::Zero(), t = e;
    for (const auto* p : group) e += p->estimate, t += p->truth;
    out.emplace_back(e / static_cast<double>(group.size()), t / static_cast<double>(group.size()));
  }
  return out;
}

double rms(const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& groups) {
  double sum = 0;
  for (const auto& [e, t] : groups) sum += (e - t).squaredNorm();
  return groups.empty() ? 0 : std::sqrt(sum / (2 * static_cast<double>(groups.size())));
}

double angle(const Eigen::Vector2d& v) { return std::atan2(v.y(), v.x()); }

double height_lag(const std::vector<Pair>& all) {
  // dw/dz of the mean profile, from the truth averaged in 10 m bins over both legs.
  std::map<int, std::pair<Eigen::Vector2d, int>> profile;
  for (const auto& p : all) {
    auto& [sum, n] = profile.try_emplace(static_cast<int>(p.height / 10), Eigen::Vector2d::Zero(), 0).first->second;
    sum += p.truth, ++n;
  }
  double above = 0, below = 0;
  for (const auto& p : all) {
    const int bin = static_cast<int>(p.height / 10);
    const auto up = profile.find(bin + 1), down = profile.find(bin - 1);
    if (up == profile.end() || down == profile.end() || std::abs(p.climb) < 0.2) continue;
    const Eigen::Vector2d shear = (up->second.first / up->second.second - down->second.first / down->second.second) / 20;
    above -= (p.climb > 0 ? 1 : -1) * (p.estimate - p.truth).dot(shear);
    below += shear.squaredNorm();
  }
  return below > 0 ? above / below : 0;
}

}  // namespace

Score score(const estimator::WindSeries& series, const ingest::Truth& truth, double from_s) {
  Score s;
  const auto all = pairs(series, truth, from_s);
  if (all.empty()) return s;
  double sum = 0, inside = 0, sd = 0;
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  for (const auto& p : all) {
    const Eigen::Vector2d e = p.estimate - p.truth;
    sum += e.squaredNorm();
    bias += e;
    for (int i = 0; i < 2; ++i) inside += std::abs(e(i)) <= 1.96 * std::sqrt(p.covariance(i, i));
    sd += std::sqrt(p.covariance.trace() / 2);
  }
  const double n = static_cast<double>(all.size());
  s.rmse = std::sqrt(sum / (2 * n));
  s.mean_error = (bias / n).norm();
  s.coverage = inside / (2 * n);
  s.mean_sd = sd / n;
  const auto ten = means(all, [](const Pair& p) { return std::pair(static_cast<int>(p.seconds / 10), 0); }, 50);
  s.rmse_10s = rms(ten);
  double turned = 0;
  for (const auto& [e, t] : ten) turned += std::pow(std::remainder(angle(e) - angle(t), 2 * std::numbers::pi), 2);
  s.direction = ten.empty() ? 0 : std::sqrt(turned / static_cast<double>(ten.size())) * 180 / std::numbers::pi;
  s.rmse_bin = rms(means(all, [](const Pair& p) { return std::pair(static_cast<int>(p.height / 10), p.climb > 0 ? 1 : 0); }, 5));
  s.lag = height_lag(all);
  return s;
}

}  // namespace quadsonde::gates
