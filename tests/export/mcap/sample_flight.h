#pragma once
// A small flight that has something in every stream, and numbers that do not survive careless printing.
#include <cmath>
#include <limits>

#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"

namespace quadsonde::support {

inline ingest::LogTime at_ms(int ms) { return ingest::LogTime{ms * 1'000'000LL + 17}; }

inline void fill_motion(ingest::Flight& flight) {
  flight.attitude.source = "vehicle_attitude[0]";
  flight.velocity.source = "vehicle_gps_position[0]";
  flight.velocity.origin = ingest::VelocityOrigin::fused;
  for (int i = 0; i < 50; ++i) {
    const double a = 0.1 * i;
    flight.attitude.push(at_ms(20 * i), Eigen::Quaterniond(std::cos(a), std::sin(a) / 3, 0.1, -0.2).normalized());
    flight.accelerometer.push(at_ms(20 * i + 1), {0.1 / 3, std::sin(a), -9.81 + 1e-13 * i});
    if (i % 2) continue;
    flight.velocity.push(at_ms(20 * i + 3), {std::sin(a), std::cos(a) / 7, -1.0 / 3});
    flight.velocity.sd.push_back(0.3 + a / 11);
    flight.position.push(at_ms(20 * i + 3), {47.0 + a / 3e5, 8.5 - a / 7e5});
    flight.local_position.push(at_ms(20 * i + 4), {a, -a, -a / 3});
    flight.height_msl.push(at_ms(20 * i + 3), {430.1 + a});
    flight.height_ellipsoid.push(at_ms(20 * i + 3), {478.3 + a});
    flight.height_ground.push(at_ms(20 * i + 5), {a});
  }
}

inline void fill_sensors(ingest::Flight& flight) {
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 10; ++i) {
    flight.barometer.push(at_ms(100 * i), {96000.0 - i / 3.0, i % 2 ? std::optional(1.0 / (i + 2)) : std::nullopt});
    flight.rotors.push(at_ms(100 * i), {4000.0f + static_cast<float>(i), 4100.5f, unknown, 0.0f});
    flight.air.push(at_ms(100 * i + 7), {288.15 + i / 9.0, std::nullopt, i % 3 ? std::optional(95900.0) : std::nullopt});
    flight.autopilot_wind.push(at_ms(100 * i + 9),
                               {{-0.5 + i / 30.0, -1.7}, i % 2 ? std::optional(0.4) : std::nullopt});
    flight.landed.push(at_ms(100 * i), i == 0 || i == 9);
  }
}

/// @param utc  whether its clock is known
inline ingest::Flight sample_flight(bool utc = true) {
  ingest::Flight flight;
  flight.vehicle = {"quad-07", "PX4", "1.15.0", ingest::Airframe::multirotor, 4, true, 0.1 + 0.2};
  flight.origin = ingest::Origin{{47.0 + 1.0 / 3, 8.5}, ingest::MslHeight{428.9 / 7}};
  if (utc) flight.clock = {ingest::Duration(1'557'751'478'708'469'123LL), 0.0123 / 7, "GPS week and time"};
  fill_motion(flight);
  fill_sensors(flight);
  flight.events.push(at_ms(0), {ingest::Event::What::armed, ""});
  flight.events.push(at_ms(500), {ingest::Event::What::mode, "POSCTL, \"naïve\"\n"});
  flight.gaps.push_back({at_ms(300), at_ms(345)});
  flight.problems.push_back({ingest::Kind::doubtful, "one", {"a.ulg", 17, {}, "topic"}, "do this"});
  flight.problems.push_back({ingest::Kind::missing, "two", {"a.ulg", {}, 3, ""}, ""});
  return flight;
}

inline ingest::Truth sample_truth() {
  ingest::Truth truth;
  for (int i = 0; i < 20; ++i) truth.push_back({at_ms(50 * i), {i / 3.0}, {3.0 + i / 7.0, -2.0, 0.1 * i}});
  return truth;
}

}  // namespace quadsonde::support
