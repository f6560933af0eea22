#pragma once
// A profile or a series as single observations, as products of aircraft hold them: one time, place and height each.
#include <string>
#include <vector>

#include "export/cf_netcdf/cf_netcdf.h"

namespace quadsonde::product {

/// What sensors of the air said. What no sensor measured is empty; the last two are made of the others (humidity.h).
struct AirState {
  std::optional<double> temperature_k, relative_humidity_pct, pressure_pa, dew_point_k, mixing_ratio;
};

struct Observation {
  ingest::UtcTime utc;
  ingest::GeoPoint place;
  ingest::MslHeight altitude;
  profiles::LegName leg = profiles::LegName::all;
  estimator::MaybeWind wind = estimator::NoEstimate{};
  estimator::Quality quality = estimator::Quality::none;
  AirState air;
};

/// Speed and direction as coded products have them: both, or neither, or a speed whose direction is not known.
/// Speeds that round to 0 at steps of 0.1 m/s are calm, which is speed 0 and direction 0; a wind from north is 360.
struct CodedWind {
  std::optional<double> speed_m_s, from_deg;
};
CodedWind coded_wind(const estimator::MaybeWind& wind);

/// A share of the flight's own sensors, on the log's clock.
struct AirRecord {
  const ingest::Stream<ingest::AirSample>* air = nullptr;  ///< made for it; null or empty: none
  /// The autopilot's: its pressure serves where no other was measured. Its temperature never does.
  const ingest::Stream<ingest::BarometerSample>* barometer = nullptr;
};

struct Observations {
  std::vector<Observation> all;  ///< in the order of time
  std::size_t bad_left_out = 0;
  std::size_t unplaced = 0;             ///< with a wind, but without a time, a place or a height above the sea
  std::string air_from, pressure_from;  ///< streams, for people; empty where nothing was measured
};

/// One observation per bin with samples: of the ascent and the descent where the profile has them, else of the merged
/// leg. What sensors measured is averaged over the instants that the bin holds.
/// @param keep_bad  also those of quality bad
/// @param product   what cannot be made where this fails, for people: "UASDC netCDF"
/// Fails as profile_records does, and with Kind::no_answer when nothing is left.
ingest::Result<Observations> profile_observations(const profiles::WindProfile& profile,
                                                  const estimator::WindSeries& series, const AirRecord& record,
                                                  const NetcdfMetadata& metadata, bool keep_bad,
                                                  std::string_view product);

/// One observation per filter step that has UTC, a place and a height above the sea; the last sample of a sensor that
/// is no more than 2 s old counts. Fails as profile_observations does.
ingest::Result<Observations> series_observations(const estimator::WindSeries& series, const AirRecord& record,
                                                 bool keep_bad, std::string_view product);

}  // namespace quadsonde::product
