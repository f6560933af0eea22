#pragma once
// Every setting of the way from a log to a profile. Each struct's describe() feeds flags, settings files, --help and
// what products say about how they were made.
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "estimator/smoother/estimate.h"
#include "profiles/make_profile.h"

namespace quadsonde::product {

/// How a log is read.
struct InputSettings {
  std::string columns = "auto";
  std::string topics;
  bool recover = false;
  double height_offset_m = 0;
  std::optional<double> takeoff_msl_m;
  std::string sensor;
  double sensor_offset_s = 0;
};
template <class Visitor>
void describe(InputSettings& s, Visitor&& visit) {
  visit("columns", s.columns, "MAP.toml", "Names of a table's columns; auto finds the map that fits the header.");
  visit("topics", s.topics, "MAP.toml", "Names of the streams of a foreign MCAP log; left out, its schemas tell.");
  visit("recover", s.recover, "Also search for sound data behind lost structure.");
  visit("height_offset_m", s.height_offset_m, -1000.0, 1000.0, "Added to every height above sea level of the log.");
  visit("takeoff_msl", s.takeoff_msl_m, -500.0, 9000.0,
        "Height of the take-off point above sea level, where the log shows no take-off and no landing.");
  visit("sensor", s.sensor, "FILE.csv", "Temperature, humidity and pressure of the air that are not in the log.");
  visit("sensor_offset_s", s.sensor_offset_s, -86400.0, 86400.0, "Added to the times of the sensor's record.");
}

/// Whose drag the wind rests on.
struct DragSettings {
  std::string vehicle = "auto";
  std::optional<double> mass_kg;
};
template <class Visitor>
void describe(DragSettings& s, Visitor&& visit) {
  visit("vehicle", s.vehicle, "FILE|class:NAME|auto",
        "The vehicle's drag; auto takes vehicle.toml beside the log, else the class prior.");
  visit("mass_kg", s.mass_kg, 0.01, 1000.0, "Mass as flown; the drag of the vehicle file is scaled to it.");
}

/// Which of the flights in a log.
struct FlightChoice {
  std::string flight;  ///< a number from 1, "all", "longest"; empty: what the verb takes by itself
};
template <class Visitor>
void describe(FlightChoice& s, Visitor&& visit) {
  visit("flight", s.flight, "N|all|longest",
        "Which flight of a log with several; left out, run takes all, the others the longest.");
}

struct ModeSetting {
  std::string mode = "smoothed";
  bool causal = false;
};
template <class Visitor>
void describe(ModeSetting& s, Visitor&& visit) {
  visit("mode", s.mode, {"smoothed", "causal", "classic"},
        "Both-sided, past only, or the published four-state filter.");
  visit("causal", s.causal, "Short for --mode causal.");
}

struct LegSetting {
  std::string leg = "each", datum = "agl";
};
template <class Visitor>
void describe(LegSetting& s, Visitor&& visit) {
  visit("leg", s.leg, {"each", "up", "down", "all"}, "Which legs are given; each: up, then down, then all.");
  visit("datum", s.datum, {"agl", "msl"}, "Heights of bins above take-off or above sea level.");
}

struct PipelineSettings {
  InputSettings input;
  FlightChoice flight;
  DragSettings drag;
  ModeSetting mode;
  estimator::EstimateSettings estimate;
  LegSetting leg;
  profiles::ProfileSettings profile;
};
template <class Visitor>
void describe(PipelineSettings& s, Visitor&& visit) {
  describe(s.input, visit);
  describe(s.flight, visit);
  describe(s.drag, visit);
  describe(s.mode, visit);
  describe(s.estimate, visit);
  describe(s.leg, visit);
  describe(s.profile, visit);
}

/// The words of ModeSetting and LegSetting as the stages know them.
void apply_words(PipelineSettings& settings);

}  // namespace quadsonde::product
