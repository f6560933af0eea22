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
  std::string start_utc;
  std::string heading = "true";
  double heading_offset_deg = 0;
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
  visit("start_utc", s.start_utc, "2026-06-01T06:00:00Z",
        "When the log begins, where it does not tell; the clock of its autopilot counts on from there.");
  visit("heading", s.heading, {"true", "magnetic"},
        "Which north the log's headings count from; to magnetic ones the declination is added, once.");
  visit("heading_offset_deg", s.heading_offset_deg, -180.0, 180.0,
        "Added to every heading of the log: compass or autopilot mounted askew.");
}

/// Whose drag the wind rests on.
struct DragSettings {
  std::string vehicle = "auto";
  std::optional<double> mass_kg;
  std::optional<double> rotor_diameter_m = std::nullopt;
};
template <class Visitor>
void describe(DragSettings& s, Visitor&& visit) {
  visit("vehicle", s.vehicle, "FILE|class:NAME|auto",
        "The vehicle's drag; auto takes vehicle.toml beside the log, else the class prior.");
  visit("mass_kg", s.mass_kg, 0.01, 1000.0,
        "Mass as flown; the drag of the vehicle file is scaled to it, and without a file it tells the class.");
  visit("rotor_diameter_m", s.rotor_diameter_m, 0.01, 10.0,
        "Diameter of a rotor; without a vehicle file it tells the class, where the mass does not.");
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

/// Whether the telemetry is held against the equations of motion before its wind is believed.
struct TrustSetting {
  bool check = true;
};
template <class Visitor>
void describe(TrustSetting& s, Visitor&& visit) {
  visit("check", s.check, "Hold the telemetry against the equations of motion first, as `quadsonde check` does.");
}

struct LegSetting {
  std::string leg = "each", datum = "agl", method = "bins";
};
template <class Visitor>
void describe(LegSetting& s, Visitor&& visit) {
  visit("leg", s.leg, {"each", "up", "down", "all"}, "Which legs are given; each: up, then down, then all.");
  visit("datum", s.datum, {"agl", "msl"}, "Heights of bins above take-off or above sea level.");
  visit("method", s.method, {"bins", "optimal"},
        "Means over bins, or the profile estimated as such with its vertical resolution.");
}

/// Who observes, for products that are passed on.
struct StationSetting {
  std::string station = "auto";
};
template <class Visitor>
void describe(StationSetting& s, Visitor&& visit) {
  visit("station", s.station, "FILE|auto",
        "Identifiers, contact and licence for products; auto takes station.toml beside the log, if there is one.");
}

/// In which of its forms an output is written.
struct ProductSettings {
  std::string layout = "cf", bufr = "profiler";
  bool keep_bad = false;
};
template <class Visitor>
void describe(ProductSettings& s, Visitor&& visit) {
  visit("layout", s.layout, {"cf", "uasdc"},
        "netCDF by CF, or as the WMO UAS campaign wants it (-o FOLDER then lets the tool name the file).");
  visit("bufr", s.bufr, {"profiler", "uasdc", "own"},
        "BUFR as a wind profile with uncertainties (3 09 021), as the WMO UAS campaign has it, or our own archive form.");
  visit("keep_bad", s.keep_bad, "Also pass on values of quality bad, which UASDC, BUFR and .ascii2nc leave out.");
}

struct PipelineSettings {
  InputSettings input;
  StationSetting station;
  FlightChoice flight;
  DragSettings drag;
  TrustSetting trust;
  ModeSetting mode;
  estimator::EstimateSettings estimate;
  LegSetting leg;
  profiles::ProfileSettings profile;
  ProductSettings product;  ///< described by the verbs that write one product, not by describe() below
};
template <class Visitor>
void describe(PipelineSettings& s, Visitor&& visit) {
  describe(s.input, visit);
  describe(s.station, visit);
  describe(s.flight, visit);
  describe(s.drag, visit);
  describe(s.trust, visit);
  describe(s.mode, visit);
  describe(s.estimate, visit);
  describe(s.leg, visit);
  describe(s.profile, visit);
}

/// The words of ModeSetting and LegSetting as the stages know them.
void apply_words(PipelineSettings& settings);

}  // namespace quadsonde::product
