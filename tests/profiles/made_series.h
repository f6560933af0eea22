#pragma once
// Wind series made by hand: each point says its time, height, climb rate and wind.
#include "estimator/smoother/wind_series.h"

namespace quadsonde::profiles {

inline ingest::LogTime at(double s) { return ingest::LogTime{} + ingest::seconds(s); }

class SeriesMaker {
 public:
  /// Flies from one height to another at 10 Hz (or stays, for `seconds`), with one wind.
  SeriesMaker& climb(double to, double rate, const Eigen::Vector2d& wind) {
    const double v_up = to > height_ ? rate : -rate;
    const double seconds = std::abs(to - height_) / rate;
    const double from = height_;
    for (int i = 0; i < static_cast<int>(std::lround(10 * seconds)); ++i)
      push(from + 0.1 * (i + 0.5) * v_up, v_up, wind);
    height_ = to;
    return *this;
  }
  SeriesMaker& stay(double seconds, const Eigen::Vector2d& wind) {
    for (int i = 0; i < static_cast<int>(std::lround(10 * seconds)); ++i) push(height_, 0, wind);
    return *this;
  }
  SeriesMaker& from(double height) {
    height_ = height;
    return *this;
  }
  void push(double height, double v_up, const Eigen::Vector2d& wind) {
    estimator::WindPoint p;
    p.time = at(0.1 * static_cast<double>(series.points.size()));
    p.height_agl = ingest::GroundHeight{height};
    p.height_msl = ingest::MslHeight{height + 150};
    p.v_up = v_up;
    p.wind = estimator::WindEstimate{wind, 0.04 * Eigen::Matrix2d::Identity(), true};
    p.quality = estimator::Quality::good;
    series.points.push_back(p);
  }

  estimator::WindSeries series;

 private:
  double height_ = 0;
};

}  // namespace quadsonde::profiles
