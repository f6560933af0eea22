#pragma once
// From PX4 topics to streams: one function per stream, each with the fields, units and firmware it relies on.
// Names and units: PX4-Autopilot msg/*.msg of 1.4 to 1.15. No version is trusted: the fields that are there decide.
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/ulog/container.h"

namespace quadsonde::ingest::ulog {

/// The topics that the mapping reads.
bool is_wanted(std::string_view topic);

/// What every mapping function gets and may add to.
struct Mapping {
  const Log& log;
  Flight& flight;
  std::vector<std::pair<std::string, std::string>>& details;  ///< which stream came from where
};

/// Receiver: velocity with its accuracy, position, heights, clock (topics_gps.cc). Where no receiver serves,
/// velocity and position of the autopilot's estimator.
void map_navigation(Mapping& m);
/// vehicle_attitude.q (w, x, y, z), body to NED; resets as events.
void map_attitude(Mapping& m);
void map_accelerometer(Mapping& m);
void map_barometer(Mapping& m);
void map_air(Mapping& m);
void map_rotors(Mapping& m);
void map_wind(Mapping& m);
/// Arming, modes, landing, messages, dropouts.
void map_events(Mapping& m);
/// MAV_TYPE, SYS_AUTOSTART, versions, simulation.
void map_vehicle(Mapping& m);

}  // namespace quadsonde::ingest::ulog
