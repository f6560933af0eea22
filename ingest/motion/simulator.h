#pragma once
// A multirotor in the wind, flown by a position controller and measured by imperfect sensors: the point mass that the
// estimator's gates ask for, or a rigid body that knows more than the estimator's model does.
// Source: design notes, section 10.
#include <cstdint>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"
#include "ingest/motion/drag.h"
#include "ingest/motion/path.h"
#include "ingest/motion/rigid_body.h"
#include "ingest/motion/sensors.h"
#include "ingest/motion/vehicle.h"
#include "ingest/motion/wind_field.h"

namespace quadsonde::ingest {

struct Site {
  GeoPoint point{43.5657, 1.4815};  ///< somewhere in Toulouse
  MslHeight height{150};
  UtcTime start{1'750'000'000'000'000'000};
};

struct Scenario {
  enum class Model {
    point_mass,  ///< 100 Hz, equation (1) with the vehicle's own drag law
    rigid_body   ///< 500 Hz, rigid_body.h, in the standard atmosphere's density; flies on what it measures
  };
  std::string name = "scenario";
  Model model = Model::point_mass;
  Vehicle vehicle;     ///< point mass: its drag law is the truth of this flight
  RigidVehicle rigid;  ///< rigid body
  Site site;
  WindField wind;
  double start_height = 10;  ///< above take-off [m]; the flight begins there, already in the air unless from_ground
  bool from_ground = false;  ///< lift off from the ground and land at the end; level while it stands there
  std::vector<PathLeg> path;
  SensorModel sensors;
  std::uint64_t seed = 1;
};

struct Simulation {
  Flight flight;
  Truth truth;  ///< at the times of the velocity samples, logged or dropped out, at the vehicle
  Vehicle
      vehicle;  ///< as flown; of a rigid body equivalent_vehicle() at the site's density, with latency and tilt noise
};

/// Flies a scenario. Same scenario, same numbers. Fails with Kind::usage if nothing is flown, it lasts over a day, or
/// the rigid body cannot hover.
Result<Simulation> simulate(const Scenario& scenario);

/// The vehicle of the published experiments: 0.896 kg, D 0.2303 N s/m, so delta 0.2570 1/s; no climb law.
Vehicle published_vehicle();

}  // namespace quadsonde::ingest
