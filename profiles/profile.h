#pragma once
// A vertical wind profile: bins from the ground up, empty ones included.
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
  std::optional<double> spread_from_deg; ///< Yamartino spread of the samples' direction
};

struct Leg {
  LegName name = LegName::all;
  std::vector<Bin> bins;  ///< from the lowest to the highest bin touched by any leg, the same for every leg
  std::optional<ingest::UtcTime> utc_from = std::nullopt, utc_to = std::nullopt;  ///< of its first and last sample
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
  std::vector<Leg> legs;
  std::optional<UpDownTest> up_down;
  std::vector<ingest::Problem> problems;
};

}  // namespace quadsonde::profiles
