#pragma once
// What is asked of an archive.
#include <optional>
#include <string>

#include "export/archive/index.h"

namespace quadsonde::product {

/// Everything that is set must hold. Heights, speeds and quality are those of the bins that have a wind.
struct ArchiveQuery {
  std::string from, to;  ///< UTC, ISO 8601; profiles that lie at least partly between
  std::string box;       ///< W,S,E,N [deg]; W > E goes across the date line
  std::string near;      ///< LAT,LON [deg]
  double within_km = 10;
  std::optional<double> min_height_m, max_height_m;
  std::string datum = "agl";
  std::optional<double> min_speed_m_s, max_speed_m_s;
  std::string vehicle_id, station_id;
  std::string least_quality = "bad";
  bool all_versions = false;
};
template <class Visitor>
void describe(ArchiveQuery& q, Visitor&& visit) {
  visit("from", q.from, "UTC", "Only profiles that end at or after it, as 2026-06-01 or 2026-06-01T05:30Z.");
  visit("to", q.to, "UTC", "Only profiles that begin before it.");
  visit("box", q.box, "W,S,E,N",
        "Only launch sites between these longitudes and latitudes in degrees; W greater than E spans the date line.");
  visit("near", q.near, "LAT,LON", "Only launch sites around this place, in degrees; how far: --within-km.");
  visit("within_km", q.within_km, 0.0, 20100.0, "Distance from --near over the ellipsoid.");
  visit("min_height_m", q.min_height_m, -1000.0, 100000.0, "Only profiles that reach at least up to it.");
  visit("max_height_m", q.max_height_m, -1000.0, 100000.0, "Only profiles that begin at or below it.");
  visit("datum", q.datum, {"agl", "msl"}, "Heights above take-off or above sea level.");
  visit("min_speed_m_s", q.min_speed_m_s, 0.0, 200.0, "Only profiles with a bin whose wind is at least so strong.");
  visit("max_speed_m_s", q.max_speed_m_s, 0.0, 200.0, "Only profiles with a bin whose wind is at most so strong.");
  visit("vehicle_id", q.vehicle_id, "NAME", "Only profiles of this vehicle, as the listing names it.");
  visit("station_id", q.station_id, "NAME", "Only profiles of this station.");
  visit("least_quality", q.least_quality, {"good", "doubtful", "bad"},
        "Only profiles of which at least half of the bins are so good, or better.");
  visit("all_versions", q.all_versions, "Also versions that a better one of the same flight has superseded.");
}

/// As a condition over the index. Fails with Kind::usage for what cannot be read.
ingest::Result<IndexCondition> condition_of(const ArchiveQuery& query);

/// The answer, in the order of the starts. Fails as condition_of and the index do.
ingest::Result<std::vector<ArchiveEntry>> query_index(ArchiveIndex& index, const ArchiveQuery& query);

}  // namespace quadsonde::product
