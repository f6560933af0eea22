#pragma once
// The mean wind of a scenario, and how strong and of what kind the turbulence upon it is.
#include <Eigen/Core>
#include <optional>
#include <vector>

namespace quadsonde::ingest {

/// Mean wind as a function of height and time; turbulence is added to it.
struct WindField {
  enum class Model { constant, power_law, log_law, jet, table };
  struct Level {
    double height = 0;                                 ///< above take-off [m]
    Eigen::Vector2d toward = Eigen::Vector2d::Zero();  ///< N, E [m/s]
    double time = 0;                                   ///< of the profile that this level belongs to [s]
  };
  struct Step {
    double time = 0;  ///< from this time on [s] the mean wind is this one instead
    Eigen::Vector2d toward = Eigen::Vector2d::Zero();
  };
  /// A sheared boundary layer with a low-level jet in it: speed ground + gain (1 - exp(-z/scale))
  /// + excess exp(-((z-height)/width)^2) m/s toward direction + turn (1 - exp(-z/turn_scale)) degrees.
  /// Source: the profile of the gates, design notes, section 10; its figures are the defaults.
  struct Jet {
    double ground = 2, gain = 5, scale = 120;       ///< [m/s], [m/s], [m]
    double excess = 2.5, height = 180, width = 50;  ///< [m/s], [m], [m]
    double toward_deg = 70, turn_deg = 40, turn_scale = 300;
  };
  enum class Turbulence {
    ornstein_uhlenbeck,  ///< per axis, exponential in time
    dryden               ///< turbulence.h
  };

  Model model = Model::constant;
  Eigen::Vector2d toward = Eigen::Vector2d::Zero();  ///< constant; and at reference_height for the laws [m/s]
  double reference_height = 10;
  double power_exponent = 0.143;  ///< 1/7, the neutral surface layer
  double roughness = 0.03;        ///< [m], short grass
  double veer_deg_per_m = 0;      ///< clockwise with height
  Jet jet;
  std::vector<Level> levels;  ///< table: by time, then by height; linear between, constant beyond
  std::vector<Step> steps;

  Turbulence turbulence = Turbulence::ornstein_uhlenbeck;
  double sigma_u = 0.5, time_u = 10;  ///< horizontal turbulence per axis, Ornstein-Uhlenbeck
  double sigma_w = 0.25, time_w = 5;  ///< vertical
  /// Ornstein-Uhlenbeck: sigma(z) = sigma (z / reference_height)^exponent, from 1 m upward; 0 = the same everywhere.
  double sigma_exponent = 0;
  /// Dryden: the wind at 6 m that sets its strength [m/s]; empty = of the mean wind.
  std::optional<double> wind_at_6m;

  /// N, E [m/s] at a height above take-off [m] and a time [s].
  Eigen::Vector2d mean(double height, double time) const;
};

}  // namespace quadsonde::ingest
