#pragma once
// A vertical wind profile: bins from the ground up, empty ones included.
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "estimator/smoother/wind_series.h"

namespace quadsonde::profiles {

using estimator::MaybeWind;
using estimator::Quality;
using estimator::Reasons;

enum class LegName { up, down, all };
std::string_view name(LegName leg);
enum class Datum { agl, msl };
std::string_view name(Datum datum);

/// One row of a profile. Heights, place and time are means over the samples of the bin; an empty bin has none of them
/// but its edges and, where the datum allows, the heights of its middle.
struct Bin {
  double bottom = 0, top = 0;  ///< in the profile's datum [m]
  std::optional<ingest::GroundHeight> height_agl;
  std::optional<ingest::MslHeight> height_msl;
  std::optional<ingest::UtcTime> utc;
  std::optional<ingest::GeoPoint> place;
  MaybeWind wind = estimator::NoEstimate{estimator::Reason::no_samples};  ///< mean over that time in the bin
  std::optional<Eigen::Vector2d> sigma;      ///< turbulence N, E [m/s]; empty for short bins
  std::size_t samples = 0;
  std::optional<double> effective_samples;
  Quality quality = Quality::none;
  Reasons reasons;
  std::optional<double> sd_sampling;     ///< what turbulence adds if the bin stands for the mean state [m/s]
  std::optional<double> sd_calibration;  ///< drag, latency, climb law, heading [m/s]
  std::optional<double> sd_trim;         ///< [m/s]
  std::optional<double> sd_noise;        ///< sensors and gusts alone [m/s]
  std::optional<double> sd_climb_law;    ///< the climb law's part of sd_calibration [m/s]
  std::optional<double> spread_from_deg; ///< Yamartino spread of the samples' direction
  std::optional<double> resolution_m;    ///< method optimal: over which height the row is an average
  std::optional<double> freedom;         ///< method optimal: 1 = measured, 0 = prior
  std::optional<double> pressure_pa, temperature_k, relative_humidity_pct;  ///< of the air, where a sensor was logged
};

struct Leg {
  LegName name = LegName::all;
  std::vector<Bin> bins;  ///< from the lowest to the highest bin touched by any leg, the same for every leg
  std::optional<ingest::UtcTime> utc_from = std::nullopt, utc_to = std::nullopt;  ///< of its first and last sample
};

/// What a vehicle did for a while: legs as found in the flight or named by the user.
struct FoundLeg {
  enum class Kind { ascent, descent, hover, level, transit };
  Kind kind = Kind::hover;
  ingest::LogTime from, to;
  double seconds = 0;
  std::optional<double> lowest, highest;  ///< in the profile's datum [m]
  double climb = 0;                       ///< mean climb rate [m/s]
  double speed = 0;                       ///< mean speed over ground [m/s]
};
/// "ascent", "descent", "hover", "level leg", "transit"
std::string_view name(FoundLeg::Kind kind);

/// How a profile was made of the wind along the flight.
enum class Method { bins, optimal };
std::string_view name(Method method);

/// What an optimal-estimation profile says of itself. Rodgers (2000), Inverse Methods for Atmospheric Sounding.
struct OptimalDetails {
  std::vector<double> height;      ///< of the nodes, in the profile's datum [m]
  Eigen::MatrixXd kernel;          ///< averaging kernel A, mean of both components, a row per node
  double degrees_of_freedom = 0;   ///< trace of A, per component
};

/// Up against down at equal heights.
struct UpDownTest {
  double chi2 = 0;
  int degrees_of_freedom = 0;
  double p_value = 1;
};

struct WindProfile {
  Datum datum = Datum::agl;
  double bin_m = 10;
  Method method = Method::bins;
  std::optional<double> hub_height;  ///< above take-off, if one was asked for [m]
  std::vector<Leg> legs;
  std::vector<Leg> flown;  ///< each ascent and descent apart, in the order of time, with the bins of `legs`; names repeat
  std::vector<FoundLeg> found;  ///< in the order of time
  std::optional<UpDownTest> up_down;
  std::optional<OptimalDetails> optimal;
  std::vector<ingest::Problem> problems;
  std::vector<ingest::Problem> notes;  ///< what the flight is no profile of, and what would be: told, not a doubt
};

}  // namespace quadsonde::profiles
