#pragma once
// Random numbers that are the same on every machine and library.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace quadsonde::ingest {

/// Standard normal numbers by Box and Muller (1958) from a Mersenne twister: std::normal_distribution differs
/// between standard libraries, this does not.
class Gaussian {
 public:
  explicit Gaussian(std::uint64_t seed) : engine_(seed) {}
  double operator()() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2 * std::log(uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }
  /// In (0, 1).
  double uniform() { return (static_cast<double>(engine_() >> 11) + 0.5) * 0x1.0p-53; }

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// A seed of its own for each purpose (splitmix64 of Steele, Lea and Flood, 2014), so that one kind of noise may come
/// or go without moving the others.
inline std::uint64_t seed_for(std::uint64_t seed, std::uint64_t purpose) {
  std::uint64_t z = seed + (purpose + 1) * 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

/// Ornstein-Uhlenbeck process, exact at its step.
class OrnsteinUhlenbeck {
 public:
  OrnsteinUhlenbeck(double sd, double correlation_time, double step, Gaussian& noise)
      : decay_(correlation_time > 0 ? std::exp(-step / correlation_time) : 0),
        drive_(sd * std::sqrt(1 - decay_ * decay_)),
        noise_(noise),
        value_(sd * noise()) {}
  double next() { return value_ = decay_ * value_ + drive_ * noise_(); }
  double value() const { return value_; }

 private:
  double decay_, drive_;
  Gaussian& noise_;
  double value_;
};

}  // namespace quadsonde::ingest
