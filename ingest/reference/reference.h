#pragma once
// Winds that somebody else measured: METAR and plain tables, as records of one shape.
#include <optional>
#include <string>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

/// One report of the wind. What the report does not tell is empty.
struct ReferenceWind {
  UtcTime utc;                               ///< of the report; the mean over the minutes before it
  std::optional<double> speed_min, speed_max;  ///< [m/s]; equal where the source gives one value
  std::optional<double> gust;                ///< [m/s]
  std::optional<double> from_deg;            ///< true north, 0 < d <= 360; empty: variable, calm or missing
  std::optional<std::pair<double, double>> sector_deg;  ///< from, clockwise to
  bool calm = false;
  std::optional<GroundHeight> height;        ///< above ground there
  std::optional<GeoPoint> place;
  double speed_sd = 0, from_sd_deg = 0;      ///< by rounding alone
  std::string station;

  /// Middle of the speed range.
  std::optional<double> speed() const {
    if (!speed_min || !speed_max) return std::nullopt;
    return (*speed_min + *speed_max) / 2;
  }
};

struct Reference {
  std::string kind;    ///< "METAR", "table"
  std::string source;  ///< the file's name
  std::vector<ReferenceWind> records;  ///< in time order
  std::vector<Problem> problems;       ///< lines that could not be read
};

/// Whether these bytes are one of the layouts that read_reference knows, by their header or their first reports.
bool looks_like_reference(Bytes bytes);

/// A reference by its contents: raw METAR lists (with or without a leading "YYYY-MM-DD HH:MM"), IEM downloads (tab or
/// comma, `#DEBUG` lines), plain tables (utc,speed_min_m_s,speed_max_m_s,wind_from_deg[,height_agl_m,lat_deg,lon_deg]).
/// @param near  a METAR's own time has neither year nor month: the ones that bring it closest to this are taken
/// A report that stands there twice is kept once. Fails with Kind::not_a_log where it is none of these, Kind::missing
/// where no line has a wind or, with `near` empty, where reports tell the day of the month only.
Result<Reference> read_reference(Bytes bytes, const std::string& file_name, std::optional<UtcTime> near);

/// Where records that name no place or no height were measured (--reference-at LAT,LON,HEIGHT_M). The 10 m of a METAR
/// is what stations are meant to have, not what the report says, so this height wins over it.
void place_records(Reference& reference, GeoPoint place, GroundHeight height);

}  // namespace quadsonde::ingest
