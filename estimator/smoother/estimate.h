#pragma once
// From a flight and a vehicle to the wind along the flight.
#include "estimator/smoother/wind_series.h"
#include "ingest/flight/flight.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::estimator {

/// Defaults and meaning of every setting stand in describe(), which feeds flags, settings files and --help.
struct EstimateSettings {
  Mode mode = Mode::smoothed;
  double gate_nis = 18.4;
  double max_gap_s = 2.0;
  double velocity_sd_m_s = 0.1;
  double heading_sd_deg = 2.0;
  double turbulence_time_s = 10.0;
  std::optional<double> turbulence_sd_m_s;  ///< empty: maximum likelihood per flight
  double wind_time_psd = 1e-3;
  double wind_height_psd = 2e-3;
  double vertical_wind_sd_m_s = 0.25;
  double vertical_wind_time_s = 5.0;
  bool jump_test = true;
  bool estimate_climb_law = true;
  bool online_drag = false;
  std::optional<double> air_density_kg_m3;
  /// The take-off point's height, when the caller knows it; a flight's own height above take-off wins.
  std::optional<ingest::MslHeight> takeoff;
};

/// visit(name, value, low, high, sentence) for every setting a user may change. Units are part of the names.
template <class Visitor>
void describe(EstimateSettings& s, Visitor&& visit) {
  visit("gate_nis", s.gate_nis, 4.0, 100.0, "Chi-square(2) of an innovation; beyond it the sample is rejected.");
  visit("max_gap_s", s.max_gap_s, 0.1, 60.0, "After a longer gap in the velocity the filter restarts.");
  visit("velocity_sd_m_s", s.velocity_sd_m_s, 0.01, 10.0, "Noise of the ground velocity where the log states none (1 sigma).");
  visit("heading_sd_deg", s.heading_sd_deg, 0.0, 45.0, "Heading error of the vehicle, constant over the flight (1 sigma).");
  visit("turbulence_time_s", s.turbulence_time_s, 1.0, 100.0, "Correlation time of the turbulence.");
  visit("turbulence_sd_m_s", s.turbulence_sd_m_s, 0.01, 5.0, "Turbulence per axis (1 sigma); left out, it is found by maximum likelihood.");
  visit("wind_time_psd", s.wind_time_psd, 1e-6, 1.0, "Random walk of the slow wind in time [m2/s3].");
  visit("wind_height_psd", s.wind_height_psd, 1e-6, 1.0, "Random walk of the slow wind in height [m2/s2 per metre].");
  visit("vertical_wind_sd_m_s", s.vertical_wind_sd_m_s, 0.0, 5.0, "Vertical wind, which is not estimated but weighed (1 sigma).");
  visit("vertical_wind_time_s", s.vertical_wind_time_s, 0.5, 60.0, "Correlation time of the vertical wind.");
  visit("jump_test", s.jump_test, "Open the filter where the innovations say that the wind stepped.");
  visit("estimate_climb_law", s.estimate_climb_law, "Let the climb law join the estimate when ascent and descent are flown.");
  visit("online_drag", s.online_drag, "Learn a factor on the drag and the latency in flight, while the motion tells of them.");
  visit("air_density_kg_m3", s.air_density_kg_m3, 0.3, 2.0, "Air density; left out, it comes from the log or the standard atmosphere.");
}

/// The wind along one flight (one airborne segment, tidy). The vehicle is as calibrated; it is scaled to the air
/// density here (and must have been scaled to the mass flown by the caller).
/// Fails with Kind::missing when attitude or velocity is not there, Kind::no_answer when no instant has a wind.
/// Source: estimator/MODEL.md.
ingest::Result<WindSeries> estimate_wind(const ingest::Flight& flight, const ingest::Vehicle& vehicle,
                                         const EstimateSettings& settings = {});

}  // namespace quadsonde::estimator
