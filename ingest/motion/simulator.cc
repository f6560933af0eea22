#include "ingest/motion/simulator.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "ingest/flight/local_frame.h"
#include "ingest/flight/rotation.h"
#include "ingest/motion/random.h"

namespace quadsonde::ingest {
namespace {

constexpr double step = 0.01;  // [s], 100 Hz
constexpr double degree = std::numbers::pi / 180;
constexpr double longest = 86400;

Eigen::Vector2d direction(double degrees) { return {std::cos(degrees * degree), std::sin(degrees * degree)}; }

Eigen::Vector2d turned(const Eigen::Vector2d& v, double degrees) {
  return Eigen::Rotation2Dd(degrees * degree) * v;  // N to E, so clockwise from above
}

Eigen::Vector2d from_table(const std::vector<WindField::Level>& levels, double height) {
  if (levels.empty()) return Eigen::Vector2d::Zero();
  if (height <= levels.front().height) return levels.front().toward;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (height > levels[i].height) continue;
    const double part = (height - levels[i - 1].height) / (levels[i].height - levels[i - 1].height);
    return levels[i - 1].toward + part * (levels[i].toward - levels[i - 1].toward);
  }
  return levels.back().toward;
}

/// What the pilot asks for at one instant.
struct Wish {
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();  // NED
  double heading = 0;
};

/// Walks the path legs at the simulator's step.
class Path {
 public:
  Path(const Scenario& scenario) : legs_(scenario.path) {
    wish_.position.z() = -(scenario.from_ground ? 0 : scenario.start_height);
  }
  bool done() const { return leg_ >= legs_.size(); }
  const Wish& next() {
    const PathLeg& leg = legs_[leg_];
    wish_.velocity = velocity(leg);
    wish_.position += wish_.velocity * step;
    time_in_leg_ += step;
    turn(leg);
    if (finished(leg)) begin_next();
    return wish_;
  }

 private:
  Eigen::Vector3d velocity(const PathLeg& leg) {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    const double sides = std::floor(time_in_leg_ / std::max(leg.side_duration, step));
    switch (leg.kind) {
      case PathLeg::Kind::hover: break;
      case PathLeg::Kind::climb: v.z() = climb(leg); break;
      case PathLeg::Kind::line:
        v.head<2>() = leg.speed * direction(leg.course_deg + (leg.back_and_forth && std::fmod(sides, 2) > 0 ? 180 : 0));
        break;
      case PathLeg::Kind::square: v.head<2>() = leg.speed * direction(leg.course_deg + 90 * std::fmod(sides, 4)); break;
      case PathLeg::Kind::circle:
        v.head<2>() = leg.speed * direction(leg.course_deg + leg.speed / leg.radius * time_in_leg_ / degree);
        break;
    }
    return v;
  }
  double climb(const PathLeg& leg) {
    if (pause_left_ > 0) {
      pause_left_ -= step;
      return 0;
    }
    if (leg.pause_every > 0 && climbed_ >= leg.pause_every) {
      climbed_ = 0;
      pause_left_ = leg.pause;
      return 0;
    }
    climbed_ += leg.speed * step;
    return -wish_.position.z() < leg.to_height ? -leg.speed : leg.speed;
  }
  bool finished(const PathLeg& leg) const {
    if (leg.kind == PathLeg::Kind::climb) return std::abs(-wish_.position.z() - leg.to_height) <= leg.speed * step;
    return time_in_leg_ >= leg.duration - step / 2;
  }
  void turn(const PathLeg& leg) {
    switch (leg.heading.kind) {
      case HeadingRule::Kind::fixed: wish_.heading = leg.heading.degrees * degree; break;
      case HeadingRule::Kind::turning:
        if (time_in_leg_ <= step && leg_ == 0) wish_.heading = leg.heading.degrees * degree;
        wish_.heading += leg.heading.rate_deg_s * degree * step;
        break;
      case HeadingRule::Kind::along_track: {
        if (wish_.velocity.head<2>().norm() < 0.1) break;
        const double ahead = std::atan2(wish_.velocity.y(), wish_.velocity.x());
        // A nose does not jump at a corner: 90 deg/s at most.
        const double most = 90 * degree * step;
        wish_.heading += std::clamp(wrap_angle(ahead - wish_.heading), -most, most);
        break;
      }
    }
    wish_.heading = wrap_angle(wish_.heading);
  }
  void begin_next() {
    ++leg_;
    time_in_leg_ = climbed_ = pause_left_ = 0;
  }

  const std::vector<PathLeg>& legs_;
  std::size_t leg_ = 0;
  double time_in_leg_ = 0, climbed_ = 0, pause_left_ = 0;
  Wish wish_;
};

/// The point mass: position, velocity, thrust slope behind its command.
struct Body {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
  Eigen::Vector2d s = Eigen::Vector2d::Zero();
  double vdot_d = 0;
};

/// Position and velocity loops of the gates' simulator: 2.0 on velocity, 1.2 on position, an integral.
class Controller {
 public:
  /// Starts leaning into the wind that it finds, as a vehicle that has been flying does.
  Controller(const Eigen::Vector2d& integral) : integral_(integral) {}
  Eigen::Vector3d acceleration(const Wish& wish, const Eigen::Vector3d& p, const Eigen::Vector3d& v) {
    const Eigen::Vector3d aim = wish.velocity + 1.2 * (wish.position - p);
    const Eigen::Vector3d error = aim - v;
    integral_ += 0.5 * error.head<2>() * step;
    Eigen::Vector3d a = 2.0 * error;
    a.head<2>() += integral_;
    constexpr double limit = 7;  // [m/s2]
    if (const double size = a.head<2>().norm(); size > limit) a.head<2>() *= limit / size;
    a.z() = std::clamp(a.z(), -3.0, 3.0);
    return a;
  }

 private:
  Eigen::Vector2d integral_;
};

void advance(Body& body, const Eigen::Vector3d& a_wanted, const Eigen::Vector3d& wind, const DragLaw<double>& law) {
  constexpr double tilt_lag = 0.15;  // [s]
  body.s += (a_wanted.head<2>() / standard_gravity - body.s) * (step / tilt_lag);
  body.vdot_d = a_wanted.z();
  const Eigen::Vector3d air = body.v - wind;
  const Eigen::Vector2d acc = horizontal_acceleration<double>(law, body.s, standard_gravity - body.vdot_d, air,
                                                              Eigen::Vector2d::Zero());
  const Eigen::Vector3d vdot(acc.x(), acc.y(), body.vdot_d);
  body.p += body.v * step + 0.5 * vdot * step * step;
  body.v += vdot * step;
}

EulerAngles attitude_of(const Eigen::Vector2d& s, double yaw) {
  // n is along (-s, 1); in heading axes n = (sin theta cos phi, -sin phi, cos theta cos phi).
  const Eigen::Vector2d ahead = Eigen::Rotation2Dd(-yaw) * s;
  const Eigen::Vector3d n = Eigen::Vector3d(-ahead.x(), -ahead.y(), 1).normalized();
  return {std::asin(-n.y()), std::atan2(n.x(), n.z()), yaw};
}

/// Turns the true motion into what a log would hold.
class Sensors {
 public:
  Sensors(const Scenario& scenario, Gaussian& noise)
      : model_(scenario.sensors), noise_(noise), site_(scenario.site), frame_(scenario.site.point, scenario.site.height.m),
        attitude_every_(every(model_.attitude_rate > 0 ? model_.attitude_rate : model_.output_rate)),
        output_every_(every(model_.output_rate)),
        roll_error_(model_.tilt_sd_deg, model_.tilt_correlation, attitude_every_ * step, noise),
        pitch_error_(model_.tilt_sd_deg, model_.tilt_correlation, attitude_every_ * step, noise) {}

  void observe(int tick, const Body& body, double yaw, const Eigen::Vector3d& wind, Simulation& out) {
    past_.push_back(body.v);
    const auto behind = static_cast<std::size_t>(std::lround(model_.latency / step));
    while (past_.size() > behind + 1) past_.pop_front();
    const LogTime time{static_cast<std::int64_t>(tick) * 10'000'000};
    if (tick % attitude_every_ == 0) observe_attitude(time, body, yaw, out.flight);
    if (tick % output_every_ != 0) return;
    observe_motion(time, body, out.flight);
    out.truth.push_back({time, GroundHeight{-body.p.z()}, wind});
  }
  Eigen::Vector3d measured_velocity(const Body& body) {
    return body.v + model_.velocity_sd * Eigen::Vector3d(noise_(), noise_(), noise_());
  }

 private:
  static int every(double rate) { return std::max(1, static_cast<int>(std::lround(1 / (rate * step)))); }

  void observe_attitude(LogTime time, const Body& body, double yaw, Flight& flight) {
    EulerAngles seen = attitude_of(body.s, yaw);
    seen.roll += (model_.trim_roll_deg + roll_error_.next()) * degree;
    seen.pitch += (model_.trim_pitch_deg + pitch_error_.next()) * degree;
    seen.yaw += model_.heading_error_deg * degree;
    flight.attitude.push(time, q_NB_from_euler(seen));
  }
  void observe_motion(LogTime time, const Body& body, Flight& flight) {
    const Eigen::Vector3d v_seen =
        past_.front() + model_.velocity_sd * Eigen::Vector3d(noise_(), noise_(), noise_());
    flight.velocity.push(time, v_seen);
    flight.velocity.sd.push_back(model_.velocity_sd);
    Eigen::Vector3d p_seen = body.p;
    p_seen.head<2>() += model_.position_sd * Eigen::Vector2d(noise_(), noise_());
    flight.position.push(time, frame_.from_ned(p_seen).first);
    flight.height_msl.push(time, MslHeight{site_.height.m - body.p.z() + model_.height_sd * noise_()});
  }

  const SensorModel& model_;
  Gaussian& noise_;
  const Site& site_;
  LocalFrame frame_;
  int attitude_every_, output_every_;
  OrnsteinUhlenbeck roll_error_, pitch_error_;
  std::deque<Eigen::Vector3d> past_;
};

std::vector<PathLeg> with_take_off_and_landing(const Scenario& scenario) {
  auto path = scenario.path;
  if (!scenario.from_ground || path.empty()) return path;
  PathLeg wait;
  wait.duration = 3;
  wait.heading = path.front().heading;
  wait.heading.rate_deg_s = 0;
  PathLeg up = path.front();
  up.kind = PathLeg::Kind::climb;
  up.speed = 1;
  up.to_height = scenario.start_height;
  PathLeg down = up;
  down.heading = path.back().heading;
  down.to_height = 0;
  wait.heading.kind = HeadingRule::Kind::fixed;
  path.insert(path.begin(), {wait, up});
  wait.heading = path.back().heading;
  path.push_back(down);
  wait.heading.kind = HeadingRule::Kind::turning;
  wait.heading.rate_deg_s = 0;
  path.push_back(wait);
  return path;
}

Flight empty_flight(const Scenario& scenario) {
  Flight flight;
  flight.vehicle.name = scenario.vehicle.name;
  flight.vehicle.airframe = Airframe::multirotor;
  flight.vehicle.rotors = scenario.vehicle.rotors;
  flight.vehicle.simulated = true;
  flight.vehicle.mass_kg = scenario.vehicle.mass_kg;
  flight.clock = {Duration(scenario.site.start.ns), 1e-9, "simulated clock"};
  flight.origin = Origin{scenario.site.point, scenario.site.height};
  flight.attitude.source = flight.velocity.source = flight.position.source = flight.height_msl.source = "simulator";
  return flight;
}

}  // namespace

Eigen::Vector2d WindField::mean(double height, double time) const {
  if (!steps.empty() && time >= steps.front().time) {
    const auto after = std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.time > time; });
    return std::prev(after)->toward;
  }
  const double z = std::max(height, 0.0);
  Eigen::Vector2d wind = toward;
  switch (model) {
    case Model::constant: break;
    case Model::power_law: wind *= std::pow(std::max(z, 0.1) / reference_height, power_exponent); break;
    case Model::log_law:
      wind *= std::log(std::max(z, 1.001 * roughness) / roughness) / std::log(reference_height / roughness);
      break;
    case Model::jet: {
      const double speed = 2 + 5 * (1 - std::exp(-z / 120)) + 2.5 * std::exp(-std::pow((z - 180) / 50, 2));
      return speed * direction(70 + 40 * (1 - std::exp(-z / 300)));
    }
    case Model::table: wind = from_table(levels, z); break;
  }
  return veer_deg_per_m == 0 ? wind : turned(wind, veer_deg_per_m * (z - reference_height));
}

Vehicle published_vehicle() {
  Vehicle v;
  v.id = "published";
  v.name = "the quadrotor of the published experiments";
  v.mass_kg = 0.896;
  v.rotors = 4;
  v.rotor_diameter_m = 0.13;
  v.drag.linear = 0.2303 / 0.896;
  v.between_flights_rel_sd = 0;
  v.air_density_kg_m3 = 1.19;
  v.airspeed_range_m_s = {0, 15};
  v.tilt_correlation_s = 0;
  v.method = "given";
  v.covariance(p_trim_roll, p_trim_roll) = v.covariance(p_trim_pitch, p_trim_pitch) = 9;
  return v;
}

Result<Simulation> simulate(const Scenario& scenario) {
  Scenario flown = scenario;
  flown.path = with_take_off_and_landing(scenario);
  if (flown.path.empty())
    return fail(Kind::usage, "the scenario flies nothing", {}, "give [[path]] at least one leg");
  Gaussian noise(scenario.seed);
  const auto& w = scenario.wind;
  OrnsteinUhlenbeck gust_n(w.sigma_u, w.time_u, step, noise), gust_e(w.sigma_u, w.time_u, step, noise);
  OrnsteinUhlenbeck gust_d(w.sigma_w, w.time_w, step, noise);
  Simulation out{empty_flight(scenario), {}, scenario.vehicle};
  Sensors sensors(flown, noise);
  Path path(flown);
  Body body;
  body.p.z() = scenario.from_ground ? 0 : -scenario.start_height;
  const Eigen::Vector2d first_wind = w.mean(-body.p.z(), 0);
  // Static balance of drag: g s = c a.
  const Eigen::Vector2d lean = -drag_coefficient(scenario.vehicle.drag, first_wind.norm(), 0.0) * first_wind;
  body.s = lean / standard_gravity;
  Controller controller(lean);
  for (int tick = 0; !path.done(); ++tick) {
    if (tick * step > longest) return fail(Kind::usage, "the scenario lasts more than a day", {}, "shorten its path");
    const Eigen::Vector2d mean = w.mean(-body.p.z(), tick * step);
    const Eigen::Vector3d wind(mean.x() + gust_n.next(), mean.y() + gust_e.next(), gust_d.next());
    const Wish& wish = path.next();
    sensors.observe(tick, body, wish.heading, wind, out);
    const Eigen::Vector3d v_flown = scenario.sensors.controller_flies_on_measured ? sensors.measured_velocity(body) : body.v;
    advance(body, controller.acceleration(wish, body.p, v_flown), wind, scenario.vehicle.drag);
  }
  return out;
}

}  // namespace quadsonde::ingest
