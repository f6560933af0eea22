#pragma once
// What is known of a vehicle's drag: a file that a person can read (design/CLI.md, VEHICLE.toml).
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/flight/time.h"
#include "ingest/motion/drag.h"

namespace quadsonde::ingest {

/// The seven parameters in the order of the file's covariance.
enum DragParameter { p_linear, p_quadratic, p_climb_linear, p_climb_quadratic, p_latency, p_trim_roll, p_trim_pitch };
using DragCovariance = Eigen::Matrix<double, 7, 7>;

struct VehicleLog {
  std::string name, sha256;
};

struct Vehicle {
  std::string id, name;
  std::optional<double> mass_kg, rotor_diameter_m;
  int rotors = 0;

  DragLaw<double> drag;
  double latency_s = 0;
  double trim_roll_deg = 0, trim_pitch_deg = 0;
  DragCovariance covariance = DragCovariance::Zero();  ///< units of the file: 1/s, 1/m, s/m, s2/m2, s, deg, deg
  double between_flights_rel_sd = 0.06;  ///< one vehicle's drag moves by this from flight to flight (1 sigma)
  double air_density_kg_m3 = sea_level_air_density;
  double density_exponent = 0.5;
  Eigen::Vector2d airspeed_range_m_s{0, 0};  ///< seen while calibrating

  double tilt_sd_deg = 0.5, tilt_correlation_s = 1.0;

  std::string method = "prior";  ///< tunnel, free-flight or prior
  std::optional<double> excitation_m_s, residual_rms_m_s2, leave_one_out_m_s;
  std::vector<VehicleLog> logs;
  std::optional<UtcTime> created;
  std::string version;

  /// No trim was ever measured: its sd is that of the class.
  bool is_prior() const { return method == "prior"; }
  double parameter_sd(DragParameter p) const { return std::sqrt(covariance(p, p)); }
};

/// What may be assumed of a multirotor nobody measured: ln c normal, median 0.20 1/s, sd 0.35; kappa 0 +- 0.004 1/m
/// (spread of the drags fitted on recorded flights); climb law alpha .03 +- .05, g2 0 +- .03; trim 0 +- 3 deg;
/// latency 0.05 +- 0.08 s.
Vehicle class_prior();

/// Priors by name: "generic", or one of class_priors.toml. Fails with Kind::usage, naming those that there are.
Result<Vehicle> class_prior(std::string_view name);

/// The parameters at the prior's mean and sd that a calibration did not determine.
void set_climb_prior(Vehicle& vehicle);

Result<Vehicle> parse_vehicle(std::string_view toml, const std::string& file_name);
Result<Vehicle> read_vehicle(const std::filesystem::path& file);
/// The file's text; what parse_vehicle reads back bit for bit.
std::string to_toml(const Vehicle& vehicle);

/// The vehicle at another mass and air density, covariance scaled with it.
/// Kind::usage if a mass is given and the file has none.
Result<Vehicle> flown_at(const Vehicle& vehicle, std::optional<double> mass_kg, double air_density_kg_m3);

/// Density of the standard atmosphere (ISO 2533) at a height above sea level [m], and that of moist air.
double standard_air_density(double height_msl);
double air_density(double pressure_pa, double temperature_k, double relative_humidity_pct);

}  // namespace quadsonde::ingest
