#pragma once
// How much a vehicle's own motion can tell of its drag: over a whole flight, or over the recent past on board.
// Fixed sizes, no allocation. Source: design notes, section 5, "Identifiability report"; estimator/MODEL.md section 16.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace quadsonde::estimator {

inline constexpr double enough_excitation = 1.5;  ///< from here on a flight may calibrate [m/s]
inline constexpr double some_excitation = 0.5;    ///< from here on what it says is shown, but not used

/// The sums behind X = rms of v minus its projection on span{1, exp(i psi)}, v as N + iE [m/s]: what neither a constant
/// wind nor a trim could have caused.
class ExcitationSums {
 public:
  /// @param north, east  ground velocity [m/s]   @param heading  [rad]   @param weight  the same for every sample, or
  /// [s]
  void add(double north, double east, double heading, double weight = 1) {
    const std::complex<double> v(north, east), e = std::polar(1.0, heading);
    v_ += weight * v, e_ += weight * e, ve_ += weight * v * std::conj(e), vv_ += weight * std::norm(v), n_ += weight;
  }
  void add(const ExcitationSums& o) { v_ += o.v_, e_ += o.e_, ve_ += o.ve_, vv_ += o.vv_, n_ += o.n_; }
  double weight() const { return n_; }

  /// X [m/s]; 0 without samples.
  double index() const {
    if (n_ <= 0) return 0;
    // Least squares of v = p + q e, by the normal equations with |e| = 1.
    const double determinant = n_ * n_ - std::norm(e_);
    std::complex<double> p = v_ / n_, q = 0;
    if (determinant > 1e-9 * n_ * n_) {
      q = (n_ * ve_ - v_ * std::conj(e_)) / determinant;
      p = (v_ - q * e_) / n_;
    }
    const double explained = (p * std::conj(v_) + q * std::conj(ve_)).real();
    return std::sqrt(std::max(0.0, vv_ - explained) / n_);
  }

 private:
  std::complex<double> v_ = 0, e_ = 0, ve_ = 0;
  double vv_ = 0, n_ = 0;
};

/// X over the past minute, in blocks of a second. Nothing is said before half a minute has been seen: a vehicle that
/// has just set off moves in a straight line, which a change of the wind explains as well.
class RecentExcitation {
 public:
  void add(double time, double north, double east, double heading, double step) {
    const double second = std::floor(time);
    if (second != second_) {
      // What lies between two samples that are further apart than a block has not been seen.
      const int passed = second_ < -1e299 ? 1 : static_cast<int>(std::clamp(second - second_, 1.0, double(blocks)));
      for (int i = 0; i < passed; ++i) ring_[static_cast<std::size_t>(at_ = (at_ + 1) % blocks)] = {};
      second_ = second;
      sums_ = {};
      for (const auto& block : ring_) sums_.add(block);
    }
    ring_[static_cast<std::size_t>(at_)].add(north, east, heading, step);
    sums_.add(north, east, heading, step);
  }
  double index() const { return sums_.weight() < least_seconds ? 0 : sums_.index(); }
  bool enough() const { return index() >= enough_excitation; }
  void clear() { *this = {}; }

 private:
  static constexpr int blocks = 60;
  static constexpr double least_seconds = 30;
  std::array<ExcitationSums, blocks> ring_{};
  ExcitationSums sums_;
  double second_ = -1e300;
  int at_ = 0;
};

}  // namespace quadsonde::estimator
