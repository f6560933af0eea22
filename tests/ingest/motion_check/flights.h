#pragma once
// Simulated flights, and the ways to spoil them.
#include <functional>
#include <string>
#include <vector>

#include "ingest/flight/rotation.h"
#include "ingest/motion/consistency.h"
#include "ingest/motion/simulator.h"

namespace quadsonde::ingest {

enum class Manoeuvre { hover, circle, line, square, ascent };

/// The published vehicle in 3 m/s of wind and ordinary turbulence.
Scenario scenario_of(Manoeuvre manoeuvre, HeadingRule heading, double duration, std::uint64_t seed);
/// The square with a nose that turns by itself: the flight that shows most.
Scenario telling_square(double duration, std::uint64_t seed, double latency = 0);
Flight flown(const Scenario& scenario);

Flight with_angles(Flight flight, const std::function<void(EulerAngles&)>& change);
Flight with_velocity(Flight flight, const std::function<void(Eigen::Vector3d&)>& change);
Flight in_heading_axes(Flight flight);
Flight without_position(Flight flight);

/// A spoilt flight and the class that it belongs to.
struct Spoilt {
  std::string name;
  FaultClass fault;
  std::function<Flight(std::uint64_t seed)> fly;
};
std::vector<Spoilt> spoilt_flights(double duration);

/// Does a report blame this class, decisively or not?
const Finding* blamed(const ConsistencyReport& report, FaultClass fault);
/// For a failing test to show.
std::string described(const ConsistencyReport& report);

}  // namespace quadsonde::ingest
