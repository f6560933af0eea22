#include "ingest/motion/simulator.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "ingest/motion/controller.h"
#include "ingest/motion/navigation.h"
#include "ingest/motion/point_mass.h"
#include "ingest/motion/turbulence.h"

namespace quadsonde::ingest {
namespace {

constexpr double step = 0.01;   // [s], 100 Hz
constexpr int inner_steps = 5;  // of the rigid body: 500 Hz
constexpr double longest = 86400;
constexpr double touching = 0.02;  // [m]: this low, and not meant to rise, is standing on the ground

const Eigen::Vector3d gravity_N(0, 0, standard_gravity);

/// What flies. It starts in steady flight, or standing on the ground.
class Aircraft {
 public:
  virtual ~Aircraft() = default;
  virtual Motion motion(const Wish& wish, const Eigen::Vector3d& wind) const = 0;
  virtual Eigen::Vector3d velocity() const = 0;
  virtual double height() const = 0;
  /// One tick of 10 ms, after the sensors have looked.
  virtual void fly(const Wish& wish, const Eigen::Vector3d& wind, Sensors& sensors) = 0;
};

/// May it stand on the ground now? A scenario that starts in the air knows no ground.
bool stands(const Scenario& scenario, double p_down, const Wish& wish) {
  return scenario.from_ground && p_down >= -touching && wish.velocity.z() >= 0;
}

class FlyingPointMass : public Aircraft {
 public:
  FlyingPointMass(const Scenario& scenario, const Eigen::Vector2d& wind)
      : scenario_(scenario), controller_(scenario.from_ground ? Eigen::Vector2d(0, 0) : lean(scenario, wind), step) {
    if (scenario.from_ground) return;
    body_.p.z() = -scenario.start_height;
    body_.s = lean(scenario, wind) / standard_gravity;
  }
  Motion motion(const Wish& wish, const Eigen::Vector3d&) const override {
    return {body_.p,
            body_.v,
            body_.vdot - gravity_N,
            attitude_of(body_.s, wish.heading),
            {},
            stands(scenario_, body_.p.z(), wish)};
  }
  Eigen::Vector3d velocity() const override { return body_.v; }
  double height() const override { return 0 - body_.p.z(); }
  void fly(const Wish& wish, const Eigen::Vector3d& wind, Sensors& sensors) override {
    const bool measured = scenario_.sensors.controller_flies_on_measured;
    const Eigen::Vector3d v = measured ? sensors.measured_velocity(body_.v) : body_.v;
    if (stands(scenario_, body_.p.z(), wish)) {
      body_.v = body_.vdot = Eigen::Vector3d::Zero();
      body_.s.setZero();
      body_.p.z() = std::min(body_.p.z(), 0.0);
      controller_.forget();
      return;
    }
    advance(body_, controller_.acceleration(wish, body_.p, v), wind, scenario_.vehicle.drag, step);
  }

 private:
  /// Static balance of drag: g s = c a.
  static Eigen::Vector2d lean(const Scenario& scenario, const Eigen::Vector2d& wind) {
    return -drag_coefficient(scenario.vehicle.drag, wind.norm(), 0.0) * wind;
  }
  const Scenario& scenario_;
  PointMass body_;
  PointMassController controller_;
};

class FlyingRigidBody : public Aircraft {
 public:
  FlyingRigidBody(const Scenario& scenario, const RigidTrim& hover, const RigidTrim& start, double heading)
      : scenario_(scenario),
        vehicle_(scenario.rigid),
        controller_(vehicle_, hover, step, step / inner_steps),
        navigation_({0, 0, scenario.from_ground ? 0 : -scenario.start_height}, Eigen::Vector3d::Zero(),
                    scenario.sensors.latency, receiver_interval(scenario.sensors), step) {
    if (scenario.from_ground) {
      stand(heading);
      return;
    }
    state_ = start.state;
    state_.p = navigation_.position();
    state_.v.setZero();
    controller_.settle(start, heading);
  }
  Motion motion(const Wish& wish, const Eigen::Vector3d& wind) const override {
    const bool ground = standing_ && stands(scenario_, state_.p.z(), wish);
    Motion m{state_.p, state_.v, {}, euler_from_q_NB(state_.q_NB), {}, ground};
    m.force_N = standing_ ? Eigen::Vector3d(-gravity_N) : specific_force_N(vehicle_, state_, wind, density());
    for (int i = 0; i < vehicle_.rotors; ++i)
      m.rotors_rpm.push_back(static_cast<float>(state_.speed(i) * 30 / std::numbers::pi));
    return m;
  }
  Eigen::Vector3d velocity() const override { return state_.v; }
  double height() const override { return 0 - state_.p.z(); }
  void fly(const Wish& wish, const Eigen::Vector3d& wind, Sensors& sensors) override {
    if (stands(scenario_, state_.p.z(), wish)) {
      stand(wish.heading);
      return;
    }
    const EulerAngles attitude = sensors.measured(euler_from_q_NB(state_.q_NB));
    navigation_.update(sensors.seen(), attitude);
    const double tilt_cosine = std::cos(attitude.roll) * std::cos(attitude.pitch);
    controller_.steer(wish, navigation_.position(), navigation_.velocity(), tilt_cosine);
    for (int i = 0; i < inner_steps; ++i) {
      const auto q_seen = q_NB_from_euler(sensors.measured(euler_from_q_NB(state_.q_NB)));
      const PerRotor command = controller_.motors(q_seen, sensors.measured_rate(state_.omega_B));
      advance(vehicle_, state_, command, wind, density(), step / inner_steps);
      if (standing_) lift_off();
    }
  }

 private:
  static double receiver_interval(const SensorModel& m) {
    return 1 / (m.velocity_rate > 0 ? m.velocity_rate : m.output_rate);
  }
  double density() const { return standard_air_density(scenario_.site.height.m - state_.p.z()); }

  /// At rest and level, the motors idling.
  void stand(double heading) {
    standing_ = true;
    state_.p.z() = 0;
    state_.v.setZero();
    state_.omega_B.setZero();
    state_.q_NB = q_NB_from_euler({0, 0, heading});
    state_.speed.head(vehicle_.rotors).setConstant(vehicle_.least_speed);
    navigation_.rest(state_.p);
    controller_.forget();
  }
  /// The ground carries the vehicle, upright and in place, until the rotors do.
  void lift_off() {
    standing_ = state_.v.z() >= 0;
    if (!standing_) return;
    const PerRotor speed = state_.speed;
    const double heading = euler_from_q_NB(state_.q_NB).yaw;
    const Eigen::Vector3d p(state_.p.x(), state_.p.y(), 0);
    state_ = {p, Eigen::Vector3d::Zero(), q_NB_from_euler({0, 0, heading}), Eigen::Vector3d::Zero(), speed};
    navigation_.rest(p);
    controller_.forget();
  }

  const Scenario& scenario_;
  RigidVehicle vehicle_;
  RigidState state_;
  RigidController controller_;
  Navigation navigation_;
  bool standing_ = false;
};

Result<std::unique_ptr<Aircraft>> rigid_body(const Scenario& scenario, const Eigen::Vector2d& wind, double heading) {
  const double rho = standard_air_density(scenario.site.height.m + (scenario.from_ground ? 0 : scenario.start_height));
  const auto hover = trim(scenario.rigid, Eigen::Vector3d::Zero(), heading, rho);
  if (!hover)
    return fail(Kind::usage, "this rigid body cannot hover", {},
                "give it less mass, or rotors that lift more: see max_rotor_rpm, rotor_diameter_m and pitch_deg");
  const auto start = trim(scenario.rigid, {-wind.x(), -wind.y(), 0}, heading, rho);
  return std::make_unique<FlyingRigidBody>(scenario, *hover, start.value_or(*hover), heading);
}

Result<std::unique_ptr<Aircraft>> make_aircraft(const Scenario& scenario, double heading) {
  const Eigen::Vector2d wind = scenario.wind.mean(scenario.from_ground ? 0 : scenario.start_height, 0);
  if (scenario.model == Scenario::Model::rigid_body) return rigid_body(scenario, wind, heading);
  return std::make_unique<FlyingPointMass>(scenario, wind);
}

/// As a good calibration would know it: with the latency, and one tilt noise of the same power and low-frequency
/// density as the white and the wandering part together.
Result<Vehicle> calibrated_rigid_body(const Scenario& scenario) {
  auto vehicle = equivalent_vehicle(scenario.rigid, standard_air_density(scenario.site.height.m));
  if (!vehicle) return vehicle;
  const SensorModel& m = scenario.sensors;
  vehicle->latency_s = m.latency;
  vehicle->tilt_sd_deg = std::hypot(m.tilt_sd_deg, m.tilt_wander_deg);
  vehicle->tilt_correlation_s = m.tilt_correlation;
  if (m.tilt_wander_deg <= 0) return vehicle;
  // Density at zero frequency: sd^2 times the interval if white, 2 sd^2 times the correlation time if not.
  const double interval = 1 / (m.attitude_rate > 0 ? m.attitude_rate : m.output_rate);
  const double time = m.tilt_correlation > 0 ? m.tilt_correlation : interval / 2;
  const double density =
      m.tilt_sd_deg * m.tilt_sd_deg * time + m.tilt_wander_deg * m.tilt_wander_deg * m.tilt_wander_time;
  vehicle->tilt_correlation_s = density / (vehicle->tilt_sd_deg * vehicle->tilt_sd_deg);
  return vehicle;
}

Flight empty_flight(const Scenario& scenario, const Vehicle& vehicle) {
  Flight flight;
  flight.vehicle.name = vehicle.name;
  flight.vehicle.airframe = Airframe::multirotor;
  flight.vehicle.rotors = vehicle.rotors;
  flight.vehicle.simulated = true;
  flight.vehicle.mass_kg = vehicle.mass_kg;
  flight.clock = {Duration(scenario.site.start.ns), 1e-9, "simulated clock"};
  flight.origin = Origin{scenario.site.point, scenario.site.height};
  flight.attitude.source = flight.velocity.source = flight.position.source = flight.height_msl.source = "simulator";
  flight.barometer.source = flight.accelerometer.source = flight.rotors.source = flight.landed.source = "simulator";
  return flight;
}

/// The landing goes on until the ground is reached, wherever the path has come to.
Wish towards_ground(Wish wish, const Aircraft& aircraft, const Scenario& scenario) {
  const bool landing = scenario.from_ground && wish.position.z() > -0.05 && wish.velocity.z() >= 0;
  if (!landing || aircraft.height() <= touching) return wish;
  wish.velocity.z() = std::max(wish.velocity.z(), 0.3);
  wish.position.z() = std::max(wish.position.z(), 0.5 - aircraft.height());
  return wish;
}

}  // namespace

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
  const auto legs =
      scenario.from_ground ? with_take_off_and_landing(scenario.path, scenario.start_height) : scenario.path;
  if (legs.empty()) return fail(Kind::usage, "the scenario flies nothing", {}, "give [[path]] at least one leg");
  Vehicle vehicle = scenario.vehicle;
  if (scenario.model == Scenario::Model::rigid_body) {
    auto calibrated = calibrated_rigid_body(scenario);
    if (!calibrated) return fail(calibrated.error());
    vehicle = *calibrated;
  }
  Gaussian noise(scenario.seed);
  const auto gusts = make_gusts(scenario.wind, step, noise);
  Simulation out{empty_flight(scenario, vehicle), {}, vehicle};
  Sensors sensors(scenario.sensors, scenario.site.point, scenario.site.height, step, scenario.seed, noise);
  Path path(legs, scenario.from_ground ? 0 : scenario.start_height, step);
  auto aircraft = make_aircraft(scenario, legs.front().heading.degrees * std::numbers::pi / 180);
  if (!aircraft) return fail(aircraft.error());
  Aircraft& flown = **aircraft;
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();
  for (int tick = 0; !path.done(); ++tick) {
    if (tick * step > longest) return fail(Kind::usage, "the scenario lasts more than a day", {}, "shorten its path");
    const Eigen::Vector2d mean = scenario.wind.mean(flown.height(), tick * step);
    const double airspeed = (flown.velocity().head<2>() - mean).norm();
    wind = Eigen::Vector3d(mean.x(), mean.y(), 0) + gusts->next(flown.height(), mean, airspeed);
    const Wish wish = towards_ground(path.next(), flown, scenario);
    if (sensors.observe(tick, flown.motion(wish, wind), out.flight))
      out.truth.push_back({LogTime{static_cast<std::int64_t>(tick) * 10'000'000}, GroundHeight{flown.height()}, wind});
    flown.fly(wish, wind, sensors);
  }
  return out;
}

}  // namespace quadsonde::ingest
