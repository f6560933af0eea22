#pragma once
// What people ask of a profile next: wind at given heights, shear and veer, power and log law, the low-level jet,
// stability. Nothing is extrapolated. Source: formats of the field in MET.md section 5; estimator/MODEL.md section 13.
#include <optional>
#include <string>
#include <vector>

#include "profiles/profile.h"

namespace quadsonde::profiles {

struct LevelSettings {
  std::vector<double> heights{10, 50, 100};  ///< [m] above take-off; the profile's hub height joins them
};

/// A value with its 1-sigma.
struct Uncertain {
  double value = 0, sd = 0;
};

/// Wind at one height, between the middles of two bins (components linear), never beyond the outer bins' middles by
/// more than half a bin.
struct LevelWind {
  double height = 0;
  std::optional<estimator::WindEstimate> wind;  ///< empty: the profile does not reach there
  /// Of the speed by drag and its law, as a share: it is the same at all heights, so it scales a shear and leaves a veer.
  double shared = 0;
};
/// @param heights  in the datum of the leg's bins [m]
std::vector<LevelWind> winds_at(const Leg& leg, const std::vector<double>& heights);

/// Between two heights: |dw| / dz [1/s], and the turn of the direction [deg], positive clockwise with height.
struct Shear {
  double lower = 0, upper = 0;
  Uncertain shear;
  std::optional<Uncertain> veer;  ///< empty where one of the winds has no direction
};
std::optional<Shear> shear_between(const LevelWind& lower, const LevelWind& upper);

/// Speed = reference speed x (z / 10 m)^exponent, fitted over bins between 5 m and 150 m above take-off.
struct PowerLaw {
  Uncertain exponent, speed_10m;
  std::size_t bins = 0;
};
/// Speed = (u* / k) ln(z / z0), k = 0.40, neutral; over bins between 5 m and 100 m.
struct LogLaw {
  Uncertain friction_velocity, log_roughness;  ///< [m/s]; natural logarithm of z0 in metres
  double roughness = 0;                        ///< z0 [m]
  std::size_t bins = 0;
};
/// Empty with fewer than 3 bins, a range below a factor 2 in height, or a speed that does not grow (log law).
std::optional<PowerLaw> power_law(const Leg& leg);
std::optional<LogLaw> log_law(const Leg& leg);

/// A maximum of the speed at least 2 m/s and 25 % above the minimum over it (Baas et al. 2009, J. Appl. Meteor.
/// Climatol. 48). `probability`: share of 1000 profiles drawn from the uncertainties that have one within 30 m.
struct Jet {
  double height = 0;
  Uncertain speed;
  double drop_above = 0;  ///< [m/s]
  double probability = 0;
};
std::optional<Jet> low_level_jet(const Leg& leg);

/// Ri = (g / theta) (d theta / dz) / (|dw| / dz)^2 between the lowest and highest bin with temperature and pressure.
struct BulkRichardson {
  double lower = 0, upper = 0;
  Uncertain number;
};
std::optional<BulkRichardson> bulk_richardson(const Leg& leg);

/// Everything above for the leg that stands for the flight.
struct ProfileLevels {
  std::vector<LevelWind> winds;  ///< rising in height above take-off; none where the take-off point's height is not known
  std::vector<Shear> shears;  ///< between neighbouring heights that have a wind
  std::optional<PowerLaw> power;
  std::optional<LogLaw> log;
  std::optional<Jet> jet;
  std::optional<BulkRichardson> richardson;
};
/// Laws, jet and Richardson number are made of heights above take-off only.
ProfileLevels describe_levels(const WindProfile& profile, const LevelSettings& settings = {});

}  // namespace quadsonde::profiles
