#include "ingest/motion/heading_offset.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "ingest/motion/telemetry.h"

namespace quadsonde::ingest {
namespace {

using Complex = std::complex<double>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double degree = std::numbers::pi / 180;
constexpr double window_s = 3;
constexpr double trim_sd = 3 * degree * standard_gravity;
constexpr double unsure_latency_s = 0.1;

/// Means over one window.
struct Window {
  Complex pull, vdot, v, nose;  ///< L s, acceleration, velocity, exp(i psi)
};

Complex as_complex(const Eigen::Vector2d& ne) { return {ne.x(), ne.y()}; }

/// Mean of the pull and of the nose from one time to another.
bool look_at_tilt(const Telemetry& t, double from, double to, double lift, Window& window) {
  Complex slope = 0, nose = 0;
  double count = 0;
  const auto first = std::lower_bound(t.attitude_time.begin(), t.attitude_time.end(), from);
  for (auto k = static_cast<std::size_t>(first - t.attitude_time.begin());
       k < t.attitude_time.size() && t.attitude_time[k] < to; ++k) {
    slope += as_complex(t.slope[k]), nose += std::polar(1.0, t.heading[k]);
    count += 1;
  }
  if (count < 3) return false;
  window.pull = lift * slope / count, window.nose = nose / count;
  return true;
}

std::vector<Window> windows_of(const Telemetry& t, double latency) {
  std::vector<Window> all;
  std::size_t i = 0;
  while (i + 2 < t.velocity_time.size()) {
    std::size_t j = i;
    Complex v = 0;
    double vdot_down = 0, widest = 0;
    while (j + 1 < t.velocity_time.size() && t.velocity_time[j + 1] - t.velocity_time[i] <= window_s + 1e-9) {
      widest = std::max(widest, t.velocity_time[j + 1] - t.velocity_time[j]);
      v += 0.5 * (as_complex(t.v[j]) + as_complex(t.v[j + 1]));
      vdot_down += 0.5 * (t.vdot_down[j] + t.vdot_down[j + 1]);
      ++j;
    }
    const double from = t.velocity_time[i], to = t.velocity_time[j], n = static_cast<double>(j - i);
    Window window;
    if (j > i + 1 && widest < 1 && to - from > 0.7 * window_s &&
        look_at_tilt(t, from - latency, to - latency, standard_gravity - vdot_down / n, window)) {
      window.vdot = (as_complex(t.v[j]) - as_complex(t.v[i])) / (to - from);
      window.v = v / n;
      all.push_back(window);
    }
    i = std::max(j, i + 1);
  }
  return all;
}

struct Fit {
  double phi = 0, sd = 0;
};

/// Gauss-Newton for phi, c, the constant that holds the wind, and b.
std::optional<Fit> fit(const std::vector<Window>& windows) {
  Vector6 x;
  x << 0, 0.2, 0, 0, 0, 0;
  Matrix6 information;
  std::vector<Complex> residuals(windows.size());
  double squares = 0;
  for (int round = 0; round < 30; ++round) {
    information.setZero();
    Vector6 gradient = Vector6::Zero();
    squares = 0;
    const Complex turn = std::polar(1.0, -x(0));
    for (std::size_t k = 0; k < windows.size(); ++k) {
      const auto& w = windows[k];
      const Complex along = turn * (w.vdot + x(1) * w.v);
      const Complex r = w.pull - along - Complex(x(2), x(3)) + w.nose * Complex(x(4), x(5));
      const Complex columns[6] = {Complex(0, -1) * along, turn * w.v, 1,
                                  Complex(0, 1),          -w.nose,    -w.nose * Complex(0, 1)};
      for (int i = 0; i < 6; ++i) {
        gradient(i) += std::real(std::conj(columns[i]) * r);
        for (int j = 0; j < 6; ++j) information(i, j) += std::real(std::conj(columns[i]) * columns[j]);
      }
      residuals[k] = r, squares += std::norm(r);
    }
    // A trim that the heading did not turn about is held by its prior, weighed by the residuals.
    const double variance = squares / (2 * static_cast<double>(windows.size()) - 6);
    for (int i = 4; i < 6; ++i)
      information(i, i) += variance / (trim_sd * trim_sd), gradient(i) -= variance / (trim_sd * trim_sd) * x(i);
    information.diagonal().array() += 1e-9;
    const Vector6 step = information.ldlt().solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    x += step;
    x(0) = std::remainder(x(0), 2 * std::numbers::pi);
    if (step.norm() < 1e-9) {
      Complex product = 0;
      for (std::size_t k = 0; k + 1 < residuals.size(); ++k) product += residuals[k + 1] * std::conj(residuals[k]);
      const double rho = std::clamp(std::real(product) / std::max(squares, 1e-12), 0.0, 0.9);
      const double sd = std::sqrt(information.inverse()(0, 0) * variance * (1 + rho) / (1 - rho));
      return Fit{x(0), sd};
    }
  }
  return std::nullopt;
}

}  // namespace

bool HeadingOffset::determined(double heading_sd_deg) const {
  return windows >= 20 && std::abs(deg) > 3 * sd_deg && std::abs(deg) > heading_sd_deg;
}

std::optional<HeadingOffset> estimate_heading_offset(const Flight& flight, double latency_s) {
  if (flight.attitude.empty() || flight.velocity.empty()) return std::nullopt;
  const auto telemetry = telemetry_of(flight);
  const auto windows = windows_of(telemetry, latency_s);
  if (windows.size() < 10) return std::nullopt;
  const auto middle = fit(windows);
  const auto early = fit(windows_of(telemetry, latency_s - unsure_latency_s));
  const auto late = fit(windows_of(telemetry, latency_s + unsure_latency_s));
  if (!middle || !early || !late) return std::nullopt;
  const double by_latency = 0.5 * std::remainder(late->phi - early->phi, 2 * std::numbers::pi);
  return HeadingOffset{middle->phi / degree, std::hypot(middle->sd, by_latency) / degree, windows.size()};
}

}  // namespace quadsonde::ingest
