#include "tests/ingest/motion_check/flights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quadsonde::ingest {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

}  // namespace

Scenario scenario_of(Manoeuvre manoeuvre, HeadingRule heading, double duration, std::uint64_t seed) {
  Scenario s;
  s.vehicle = published_vehicle();
  s.wind.toward = 3 * Eigen::Vector2d(std::cos(110 / degrees), std::sin(110 / degrees));
  s.start_height = 20;
  s.seed = seed;
  PathLeg leg;
  leg.duration = duration;
  leg.speed = 3;
  leg.heading = heading;
  switch (manoeuvre) {
    case Manoeuvre::hover:
      leg.kind = PathLeg::Kind::hover;
      break;
    case Manoeuvre::circle:
      leg.kind = PathLeg::Kind::circle;
      break;
    case Manoeuvre::square:
      leg.kind = PathLeg::Kind::square;
      break;
    case Manoeuvre::line:
      leg.kind = PathLeg::Kind::line;
      leg.back_and_forth = true;
      leg.course_deg = 35;
      break;
    case Manoeuvre::ascent: {
      leg.kind = PathLeg::Kind::climb;
      leg.speed = 2;
      leg.to_height = 20 + duration;
      PathLeg down = leg;
      down.to_height = 20;
      s.path = {leg, down};
      return s;
    }
  }
  s.path = {leg};
  return s;
}

Scenario telling_square(double duration, std::uint64_t seed, double latency) {
  auto s = scenario_of(Manoeuvre::square, {HeadingRule::Kind::turning, 0, 17}, duration, seed);
  s.sensors.latency = latency;
  return s;
}

Flight flown(const Scenario& scenario) { return simulate(scenario).value().flight; }

Flight with_angles(Flight flight, const std::function<void(EulerAngles&)>& change) {
  for (auto& q : flight.attitude.value) {
    auto angles = euler_from_q_NB(q);
    change(angles);
    q = q_NB_from_euler(angles);
  }
  return flight;
}

Flight with_velocity(Flight flight, const std::function<void(Eigen::Vector3d&)>& change) {
  for (auto& v : flight.velocity.value) change(v);
  return flight;
}

Flight in_heading_axes(Flight flight) {
  for (std::size_t i = 0; i < flight.velocity.size(); ++i) {
    auto& v = flight.velocity.value[i];
    const Eigen::Vector2d turned = Eigen::Rotation2Dd(-heading(flight.attitude.value[i])) * v.head<2>();
    v.head<2>() = turned;
  }
  return flight;
}

Flight without_position(Flight flight) {
  flight.position = {};
  flight.local_position = {};
  return flight;
}

std::vector<Spoilt> spoilt_flights(double duration) {
  const auto square = [duration](std::uint64_t seed, double latency = 0) {
    return without_position(flown(telling_square(duration, seed, latency)));
  };
  const auto angles = [square](std::function<void(EulerAngles&)> change) {
    return [=](std::uint64_t seed) { return with_angles(square(seed), change); };
  };
  const auto velocity = [square](std::function<void(Eigen::Vector3d&)> change) {
    return [=](std::uint64_t seed) { return with_velocity(square(seed), change); };
  };
  using enum FaultClass;
  return {
      {"TiltSignReversed", rotation, angles([](auto& e) { e.roll = -e.roll, e.pitch = -e.pitch; })},
      {"HeadingOffBy25Degrees", rotation, angles([](auto& e) { e.yaw += 25 / degrees; })},
      {"HeadingOffBy90Degrees", rotation, angles([](auto& e) { e.yaw -= 90 / degrees; })},
      {"RollAndPitchExchanged", reflection, angles([](auto& e) { std::swap(e.roll, e.pitch); })},
      {"PitchReversed", reflection, angles([](auto& e) { e.pitch = -e.pitch; })},
      {"RollReversed", reflection, angles([](auto& e) { e.roll = -e.roll; })},
      {"HeadingCounterClockwise", reflection, angles([](auto& e) { e.yaw = -e.yaw; })},
      {"NorthAndEastExchanged", reflection, velocity([](auto& v) { std::swap(v.x(), v.y()); })},
      {"EastReversed", reflection, velocity([](auto& v) { v.y() = -v.y(); })},
      {"KnotsReadAsMetresPerSecond", velocity_scale, velocity([](auto& v) { v /= 0.514444; })},
      {"MilesPerHourReadAsMetresPerSecond", velocity_scale, velocity([](auto& v) { v /= 0.44704; })},
      {"CentimetresReadAsMetres", velocity_scale, velocity([](auto& v) { v *= 100; })},
      {"RadiansReadAsDegrees", tilt_scale,
       angles([](auto& e) { e.roll /= degrees, e.pitch /= degrees, e.yaw /= degrees; })},
      {"DegreesReadAsRadians", tilt_scale,
       angles([](auto& e) { e.roll *= degrees, e.pitch *= degrees, e.yaw *= degrees; })},
      {"YawMissing", yaw_not_applied, angles([](auto& e) { e.yaw = 0; })},
      {"VelocityInHeadingAxes", yaw_not_applied, [=](std::uint64_t seed) { return in_heading_axes(square(seed)); }},
      {"LatencyIgnored", latency, [=](std::uint64_t seed) { return square(seed, 0.2); }},
      {"UpReadAsDown", vertical_velocity,
       [=](std::uint64_t seed) {
         return with_velocity(
             flown(scenario_of(Manoeuvre::ascent, {HeadingRule::Kind::turning, 0, 17}, duration / 2, seed)),
             [](auto& v) { v.z() = -v.z(); });
       }},
  };
}

const Finding* blamed(const ConsistencyReport& report, FaultClass fault) {
  for (const auto& finding : report.findings)
    if (finding.fault == fault) return &finding;
  return nullptr;
}

std::string described(const ConsistencyReport& report) { return to_text(report); }

}  // namespace quadsonde::ingest
