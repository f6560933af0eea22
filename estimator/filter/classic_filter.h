#pragma once
// The published four-state filter, exactly: two independent axes of [airspeed, wind].
// Source: Hattenberger, Bronz, Condomines, "Estimating wind using a quadrotor"; design notes, section 3.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "ingest/motion/drag.h"

namespace quadsonde::estimator {

/// Constants of the publication; they hold at 10 Hz and are never changed.
struct ClassicConstants {
  double mass = 0.896;       ///< [kg]
  double drag = 0.2303;      ///< D [N s/m]
  double step = 0.1;         ///< [s]
  double airspeed_noise = 0.05, wind_noise = 0.001;  ///< Q per step [m2/s2]
  double velocity_noise = 0.5;                       ///< R [m2/s2]
  bool exact = false;        ///< A = exp(-delta dt) instead of 1 - delta dt
};

class ClassicFilter {
 public:
  explicit ClassicFilter(const ClassicConstants& constants) : k_(constants) {
    const double rate = k_.drag / k_.mass * k_.step;
    decay_ = k_.exact ? std::exp(-rate) : 1 - rate;
    gain_ = k_.exact ? (1 - decay_) / k_.drag : k_.step / k_.mass;
  }
  /// @param n_N  body down axis in N      @param v  ground velocity, N and E [m/s]
  void step(const Eigen::Vector3d& n_N, const Eigen::Vector2d& v) {
    const double thrust = k_.mass * ingest::standard_gravity / std::max(n_N.z(), 0.5);
    for (int i = 0; i < 2; ++i) axis_[i].step(*this, -thrust * n_N(i), v(i));
  }
  Eigen::Vector2d wind() const { return {axis_[0].wind, axis_[1].wind}; }
  Eigen::Vector2d airspeed() const { return {axis_[0].airspeed, axis_[1].airspeed}; }

 private:
  struct Axis {
    double airspeed = 0, wind = 0;
    double p11 = 1, p12 = 0, p22 = 1;  // P, symmetric
    void step(const ClassicFilter& f, double force, double v) {
      airspeed = f.decay_ * airspeed + f.gain_ * force;
      p11 = f.decay_ * f.decay_ * p11 + f.k_.airspeed_noise;
      p12 = f.decay_ * p12;
      p22 = p22 + f.k_.wind_noise;
      const double s = p11 + 2 * p12 + p22 + f.k_.velocity_noise;
      const double k1 = (p11 + p12) / s, k2 = (p12 + p22) / s;
      const double innovation = v - (airspeed + wind);
      airspeed += k1 * innovation;
      wind += k2 * innovation;
      const double c1 = p11 + p12, c2 = p12 + p22;
      p11 -= k1 * c1;
      p12 -= k1 * c2;
      p22 -= k2 * c2;
    }
  };
  ClassicConstants k_;
  double decay_ = 0, gain_ = 0;
  Axis axis_[2];
};

}  // namespace quadsonde::estimator
