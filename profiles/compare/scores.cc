#include "profiles/compare/scores.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace quadsonde::profiles {
namespace {

constexpr double normal975 = 1.959964;
constexpr double degree = std::numbers::pi / 180;

/// The reference vector nearest to ours within its range of speeds.
Eigen::Vector2d nearest_reference(const Pair& pair) {
  const double middle = pair.reference->norm();
  if (middle <= 0) return *pair.reference;
  return *pair.reference / middle * std::clamp(pair.ours.norm(), pair.speed_low, pair.speed_high);
}

/// Lag-1 autocorrelation of errors that follow each other, within 0 and .99.
double autocorrelation(const std::vector<double>& errors, double mean) {
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double d = errors[i] - mean;
    squares += d * d;
    if (i + 1 < errors.size()) products += d * (errors[i + 1] - mean);
  }
  return squares > 0 ? std::clamp(products / squares, 0.0, 0.99) : 0;
}

/// Circular mean, and the statistics of what is left around it.
ErrorStatistics direction_statistics(const std::vector<double>& errors) {
  if (errors.empty()) return {};
  double s = 0, c = 0, squares = 0;
  for (const double e : errors) s += std::sin(e * degree), c += std::cos(e * degree), squares += e * e;
  const double bias = std::atan2(s, c) / degree;
  std::vector<double> around;
  for (const double e : errors) around.push_back(turn_between(bias, e));
  auto statistics = error_statistics(around);
  statistics.bias = bias;
  statistics.rmse = std::sqrt(squares / static_cast<double>(errors.size()));
  return statistics;
}

}  // namespace

Pair pair_of(const Eigen::Vector2d& ours, const Eigen::Vector2d& reference, std::optional<Eigen::Matrix2d> covariance) {
  return {ours, reference.norm(), reference.norm(), reference, std::move(covariance)};
}

double turn_between(double from_deg, double to_deg) {
  const double turn = std::remainder(to_deg - from_deg, 360.0);
  return turn <= -180 ? turn + 360 : turn;
}

double speed_error(const Pair& pair) {
  const double speed = pair.ours.norm();
  return speed - std::clamp(speed, pair.speed_low, pair.speed_high);
}

double t_quantile(double degrees_of_freedom) {
  struct Known {
    double degrees, quantile;
  };
  static constexpr std::array<Known, 14> table{{{1, 12.7062},
                                                {1.5, 6.0167},
                                                {2, 4.3027},
                                                {2.5, 3.5747},
                                                {3, 3.1824},
                                                {4, 2.7764},
                                                {5, 2.5706},
                                                {6, 2.4469},
                                                {8, 2.3060},
                                                {10, 2.2281},
                                                {15, 2.1314},
                                                {20, 2.0860},
                                                {30, 2.0423},
                                                {60, 2.0003}}};
  if (degrees_of_freedom <= 1) return table.front().quantile;
  if (degrees_of_freedom >= 60) {
    const double part = 60 / degrees_of_freedom;
    return normal975 + part * (table.back().quantile - normal975);
  }
  std::size_t i = 1;
  while (table[i].degrees < degrees_of_freedom) ++i;
  const auto &a = table[i - 1], &b = table[i];
  const double part = (1 / a.degrees - 1 / degrees_of_freedom) / (1 / a.degrees - 1 / b.degrees);
  return a.quantile + part * (b.quantile - a.quantile);
}

ErrorStatistics error_statistics(const std::vector<double>& errors) {
  ErrorStatistics s;
  s.n = errors.size();
  if (errors.empty()) return s;
  const auto n = static_cast<double>(s.n);
  double sum = 0, squares = 0, around = 0;
  for (const double e : errors) sum += e, squares += e * e;
  s.bias = sum / n;
  s.rmse = std::sqrt(squares / n);
  if (s.n < 2) return s;
  for (const double e : errors) around += (e - s.bias) * (e - s.bias);
  s.sd = std::sqrt(around / (n - 1));
  const double r = autocorrelation(errors, s.bias);
  s.effective_samples = n * (1 - r) / (1 + r);
  if (*s.effective_samples >= 2)
    s.bias_half95 = t_quantile(*s.effective_samples - 1) * *s.sd / std::sqrt(*s.effective_samples);
  return s;
}

bool Scorer::add(const Pair& pair) {
  speed_.push_back(speed_error(pair));
  if (pair.speed_high > pair.speed_low) {
    ++ranges_;
    in_range_ += speed_.back() == 0;
  }
  add_direction(pair);
  if (!pair.reference) return true;
  const Eigen::Vector2d e = pair.ours - nearest_reference(pair);
  north_.push_back(e.x());
  east_.push_back(e.y());
  return pair.covariance ? add_interval(pair.ours - *pair.reference, *pair.covariance) : true;
}

void Scorer::add_direction(const Pair& pair) {
  if (!pair.reference) {
    ++no_direction_;
    return;
  }
  const auto& r = *pair.reference;
  const auto& w = pair.ours;
  if (r.norm() <= 0 || w.norm() <= 0 || r.norm() < direction_above_ || w.norm() < direction_above_) {
    ++slow_;
    return;
  }
  direction_.push_back(std::atan2(r.x() * w.y() - r.y() * w.x(), r.dot(w)) / degree);
}

bool Scorer::add_interval(const Eigen::Vector2d& e, const Eigen::Matrix2d& covariance) {
  if (!(covariance.determinant() > 0)) return true;
  ++intervals_;
  bool inside = true;
  for (int i = 0; i < 2; ++i) {
    const double sd = std::sqrt(covariance(i, i));
    inside68_ += std::abs(e(i)) <= sd;
    const bool within = std::abs(e(i)) <= normal975 * sd;
    inside95_ += within;
    inside = inside && within;
  }
  normalised_ += e.dot(covariance.inverse() * e);
  return inside;
}

Scores Scorer::scores() const {
  Scores s;
  s.n = speed_.size();
  s.east = error_statistics(east_);
  s.north = error_statistics(north_);
  s.speed = error_statistics(speed_);
  s.rmsve = std::hypot(s.east.rmse, s.north.rmse);
  s.direction = direction_statistics(direction_);
  s.n_slow = slow_, s.n_no_direction = no_direction_;
  s.n_in_range = in_range_, s.n_range = ranges_;
  if (!intervals_) return s;
  const auto components = static_cast<double>(2 * intervals_);
  s.inside68 = static_cast<double>(inside68_) / components;
  s.inside95 = static_cast<double>(inside95_) / components;
  s.normalised_error = normalised_ / components;
  return s;
}

}  // namespace quadsonde::profiles
