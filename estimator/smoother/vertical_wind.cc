#include "estimator/smoother/vertical_wind.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "estimator/smoother/window_means.h"

namespace quadsonde::estimator {
namespace {

using Vector1 = Eigen::Matrix<double, 1, 1>;

constexpr double window = 2;       // [s] over which speeds and forces are averaged
constexpr double correlation = 5;  // [s] of the vertical wind: what its samples share
constexpr double level_sd = 0.2;   // [m/s] of the mean over a flight: what no log can show
// c_z v_i / g: 0.26 to 0.43 by blade elements and momentum, 0.5 with a frame in the wash, 0.2 fitted on a recorded
// climb.
constexpr double usual_share = 0.35, share_rel_sd = 0.4;
constexpr double worthless = 1;      // [m/s]
constexpr double fastest_climb = 2;  // [m/s] either way: beyond it the answer of the thrust is not linear
constexpr double shortest = 60;      // [s]; in less, turbulence and manoeuvres pass for each other

/// One window in which everything is known.
struct Window {
  std::size_t step = 0;
  double speed2 = 0;     // sum of squared rotor speeds, over its mean over the flight
  double needed = 0;     // specific force along the thrust [m/s2]
  double v_down = 0;     // [m/s]
  double airspeed2 = 0;  // horizontal, squared [m2/s2]
  double noise = 0;      // of `needed` [m/s2]
};

double seconds_of(const Window& w, const std::vector<Step>& steps) { return steps[w.step].seconds; }

Vector1 sum_of_squares(const ingest::RotorSpeeds& speeds) {
  double sum = 0;
  for (const float rpm : speeds) sum += 1e-6 * static_cast<double>(rpm) * static_cast<double>(rpm);
  return Vector1(speeds.empty() ? std::nan("") : sum);
}
Vector1 thrust_force(const Eigen::Vector3d& f_B) { return Vector1(-f_B.z()); }

std::vector<Window> windows_of(const ingest::Flight& flight, const std::vector<Step>& steps, const WindSeries& series) {
  WindowMeans<ingest::RotorSpeeds, Vector1> speeds(flight.rotors, sum_of_squares);
  WindowMeans<Eigen::Vector3d, Vector1> forces(flight.accelerometer, thrust_force);
  std::vector<Window> out;
  const auto half = ingest::seconds(window / 2);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const auto& point = series.points[k];
    if (!steps[k].sound || !point.v_AB_N || std::abs(steps[k].input.v_down) > fastest_climb) continue;
    const auto speed2 = speeds.over(point.time - half, point.time + half, 3);
    if (!speed2 || (*speed2)(0) <= 0) continue;
    Window w;
    w.step = k;
    w.speed2 = (*speed2)(0);
    w.airspeed2 = point.v_AB_N->squaredNorm();
    const double n_d = std::cos(steps[k].tilt);
    if (const auto force = forces.over(point.time - half, point.time + half, 5)) {
      w.needed = (*force)(0);
      w.noise = 0.05;  // offset and vibration that two seconds do not average away
    } else {
      w.needed = steps[k].input.lift / n_d;
      // The slope of a second of down velocities, averaged over two.
      const double rate = steps[k].input.step > 0 ? 1 / steps[k].input.step : 10;
      w.noise = std::sqrt(12 * steps[k].variance / std::max(3.0, rate)) / window;
    }
    w.v_down = steps[k].input.v_down;
    out.push_back(w);
  }
  if (out.empty()) return out;
  const double mean =
      std::accumulate(out.begin(), out.end(), 0.0, [](double s, const Window& w) { return s + w.speed2; }) /
      static_cast<double>(out.size());
  for (auto& w : out) w.speed2 /= mean;
  return out;
}

/// needed = K speed2 + B |a_h|^2 + c_z v_d - c_z w_d.
struct ThrustModel {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // K, B, c_z
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

Eigen::Vector3d row_of(const Window& w) { return {w.speed2, w.airspeed2, w.v_down}; }

/// Least squares with a prior on B and c_z; neighbours share their vertical wind, so only every tenth second counts.
ThrustModel fit(const std::vector<Window>& windows, double interval, double axial, double axial_sd) {
  const Eigen::Vector3d prior(9.8, 0.02, axial), prior_sd(5, 0.02, axial_sd);
  ThrustModel model;
  double variance = 0.25;
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix3d information = prior_sd.cwiseAbs2().cwiseInverse().asDiagonal();
    Eigen::Vector3d right = information * prior;
    const double weight = std::min(1.0, interval / (2 * correlation)) / variance;
    for (const auto& w : windows) {
      const Eigen::Vector3d row = row_of(w);
      information += weight * row * row.transpose();
      right += weight * w.needed * row;
    }
    model.covariance = information.inverse();
    model.at = model.covariance * right;
    double sum = 0;
    for (const auto& w : windows) sum += std::pow(w.needed - row_of(w).dot(model.at), 2);
    variance = std::max(1e-4, sum / static_cast<double>(windows.size()));
  }
  return model;
}

/// c_z of a hovering rotor: g / v_i times what blade elements and momentum leave of it.
std::optional<double> axial_of_class(const ingest::Vehicle& v, double air_density) {
  if (!v.mass_kg || !v.rotor_diameter_m || v.rotors == 0) return std::nullopt;
  const double area = v.rotors * std::numbers::pi / 4 * std::pow(*v.rotor_diameter_m, 2);
  const double induced = std::sqrt(*v.mass_kg * ingest::standard_gravity / (2 * air_density * area));
  return usual_share * ingest::standard_gravity / induced;
}

VerticalWind none(std::string why, bool logged = true) {
  VerticalWind out;
  out.rotors_logged = logged;
  out.none = NoEstimate{Reason::no_thrust_model};
  out.why = std::move(why);
  return out;
}

}  // namespace

VerticalWind estimate_vertical_wind(const ingest::Flight& flight, const ingest::Vehicle& vehicle, double air_density,
                                    const std::vector<Step>& steps, WindSeries& series) {
  if (flight.rotors.empty()) return none("the log has no rotor speeds", false);
  const auto windows = windows_of(flight, steps, series);
  if (windows.size() < 100 || 2 * windows.size() < steps.size())
    return none(
        "for most of the flight rotor speeds or horizontal wind are missing, or it climbs or sinks faster than 2 m/s");
  const auto n = static_cast<double>(windows.size());
  const double flown = seconds_of(windows.back(), steps) - seconds_of(windows.front(), steps);
  if (flown < shortest) return none("the flight is shorter than a minute");
  double climbing = 0, slowest = 1e9, fastest = 0;
  for (const auto& w : windows) {
    climbing += w.v_down * w.v_down / n;
    slowest = std::min(slowest, w.speed2), fastest = std::max(fastest, w.speed2);
  }
  if (fastest - slowest < 1e-3) return none("the rotor speeds never change");
  const auto of_class = axial_of_class(vehicle, air_density);
  const bool moves = std::sqrt(climbing) >= 0.5;
  if (!moves && !of_class)
    return none(
        "the flight never climbs, and the vehicle file has no mass and rotor diameter to tell how the thrust "
        "answers to vertical wind");
  const double axial = of_class.value_or(0.6), prior_sd = of_class ? share_rel_sd * axial : 0.5;
  const auto model = fit(windows, flown / n, axial, prior_sd);
  VerticalWind out;
  out.rotors_logged = true;
  out.thrust_per_speed2 = model.at(0);
  out.axial = model.at(2);
  out.axial_sd = std::sqrt(model.covariance(2, 2));
  out.axial_from_flight = out.axial_sd < 0.5 * prior_sd;
  out.level_sd = level_sd;
  if (out.axial < 2 * out.axial_sd) {
    out.none = NoEstimate{Reason::no_thrust_model};
    out.why = fmt::format("the thrust's answer to vertical wind is not known well enough: {:.2f} +- {:.2f} 1/s",
                          out.axial, out.axial_sd);
    return out;
  }
  std::vector<float> sds;
  std::vector<WindPoint::Vertical> values;
  for (const auto& w : windows) {
    const double up = (w.needed - row_of(w).dot(model.at)) / out.axial;
    // K and B err against the flight's mean only where speed and airspeed differ from theirs; the level has its own sd.
    Eigen::Vector3d lever = row_of(w);
    lever(0) = 0, lever(2) += -up;
    const double from_model = lever.dot(model.covariance * lever) / (out.axial * out.axial);
    const double sd = std::sqrt(w.noise * w.noise / (out.axial * out.axial) + from_model + level_sd * level_sd);
    values.push_back({static_cast<float>(up), static_cast<float>(sd)});
    sds.push_back(static_cast<float>(sd));
  }
  std::nth_element(sds.begin(), sds.begin() + static_cast<std::ptrdiff_t>(sds.size() / 2), sds.end());
  if (sds[sds.size() / 2] > worthless) {
    out.none = NoEstimate{Reason::no_thrust_model};
    out.why = fmt::format("the vertical wind would be uncertain by {:.1f} m/s", sds[sds.size() / 2]);
    return out;
  }
  for (std::size_t i = 0; i < windows.size(); ++i) series.points[windows[i].step].vertical = values[i];
  return out;
}

}  // namespace quadsonde::estimator
