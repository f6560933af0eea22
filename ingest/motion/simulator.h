#pragma once
// A point mass in the wind, flown by a position controller and measured by imperfect sensors: the minimum that the
// estimator's gates ask for. Source: design notes, section 10.
#include <cstdint>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"
#include "ingest/motion/drag.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::ingest {

/// Mean wind as a function of height and time; turbulence is added to it.
struct WindField {
  enum class Model { constant, power_law, log_law, jet, table };
  struct Level {
    double height = 0;          ///< above take-off [m]
    Eigen::Vector2d toward = Eigen::Vector2d::Zero();  ///< N, E [m/s]
  };
  struct Step {
    double time = 0;            ///< from this time on [s] the mean wind is this one instead
    Eigen::Vector2d toward = Eigen::Vector2d::Zero();
  };
  Model model = Model::constant;
  Eigen::Vector2d toward = Eigen::Vector2d::Zero();  ///< constant; and at reference_height for the laws [m/s]
  double reference_height = 10;
  double power_exponent = 0.143;  ///< 1/7, the neutral surface layer
  double roughness = 0.03;        ///< [m], short grass
  double veer_deg_per_m = 0;      ///< clockwise with height
  std::vector<Level> levels;      ///< table, by height, linear between
  std::vector<Step> steps;
  double sigma_u = 0.5, time_u = 10;     ///< horizontal turbulence per axis, Ornstein-Uhlenbeck
  double sigma_w = 0.25, time_w = 5;     ///< vertical
  /// jet: the sheared profile of the gates, speed 2 + 5 (1 - exp(-z/120)) + 2.5 exp(-((z-180)/50)^2) m/s
  /// toward 70 + 40 (1 - exp(-z/300)) degrees.
  Eigen::Vector2d mean(double height, double time) const;
};

/// How the nose is held.
struct HeadingRule {
  enum class Kind { fixed, turning, along_track };
  Kind kind = Kind::fixed;
  double degrees = 0;            ///< fixed: the heading; turning: the first heading
  double rate_deg_s = 0;         ///< turning
};

struct PathLeg {
  enum class Kind { hover, climb, line, square, circle };
  Kind kind = Kind::hover;
  double duration = 0;           ///< [s]; climbs and lines may give it by their end instead
  double speed = 0;              ///< horizontal [m/s]; climb: vertical, up or down as `to_height` tells
  double to_height = 0;          ///< climb [m above take-off]
  double course_deg = 0;         ///< line: where it goes; square: of its first side
  double side_duration = 10;     ///< square [s]
  bool back_and_forth = false;   ///< line: turn back every side_duration
  double radius = 20;            ///< circle [m]
  double pause_every = 0;        ///< climb: pause each time so many metres are done; 0 = none
  double pause = 0;              ///< [s]
  HeadingRule heading;
};

struct SensorModel {
  double output_rate = 10;       ///< attitude and velocity [Hz]; a divisor of 100
  double attitude_rate = 0;      ///< [Hz]; 0 = as output_rate
  double tilt_sd_deg = 0.5, tilt_correlation = 0;  ///< per sample and white when the correlation time [s] is 0
  double heading_error_deg = 0;  ///< constant
  double trim_roll_deg = 0.5, trim_pitch_deg = -0.3;  ///< what the log shows in a calm hover
  double velocity_sd = 0.1;
  double height_sd = 0.3;
  double position_sd = 0.5;
  double latency = 0;            ///< the velocity is this old when it is logged [s]
  bool controller_flies_on_measured = false;
};

struct Site {
  GeoPoint point{43.5657, 1.4815};  ///< somewhere in Toulouse
  MslHeight height{150};
  UtcTime start{1'750'000'000'000'000'000};
};

struct Scenario {
  std::string name = "scenario";
  Vehicle vehicle;               ///< its drag law is the truth of this flight
  Site site;
  WindField wind;
  double start_height = 10;      ///< above take-off [m]; the flight begins there, already in the air unless from_ground
  bool from_ground = false;      ///< lift off from the ground and land at the end
  std::vector<PathLeg> path;
  SensorModel sensors;
  std::uint64_t seed = 1;
};

struct Simulation {
  Flight flight;
  Truth truth;      ///< at the times of the velocity samples, at the vehicle
  Vehicle vehicle;  ///< as flown
};

/// Flies a scenario. Same scenario, same numbers. Fails with Kind::usage if nothing is flown or it lasts over a day.
Result<Simulation> simulate(const Scenario& scenario);

/// The vehicle of the published experiments: 0.896 kg, D 0.2303 N s/m, so delta 0.2570 1/s; no climb law.
Vehicle published_vehicle();

}  // namespace quadsonde::ingest
