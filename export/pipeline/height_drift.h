#pragma once
// Barometers wander by metres within a flight; landing where one took off, or a satellite height, shows by how much.
#include <optional>
#include <string>

#include "ingest/flight/flight.h"
#include "ingest/flight/segments.h"

namespace quadsonde::product {

struct HeightDrift {
  double metres = 0;            ///< what the height gained by itself from `from` to `to`
  ingest::LogTime from, to;
  std::string by;               ///< what shows it: "the landing", "the satellite height"
};

/// Take-off against landing within 30 m of it (means over up to 5 s on the ground); else, where the log has a height
/// above the ellipsoid beside the one used, the difference of both at the beginning and at the end of the flight (means
/// over 20 s). Empty below 1 m or three times the scatter, or where nothing shows it.
std::optional<HeightDrift> find_height_drift(const ingest::Flight& boot, const ingest::Segment& segment);

/// Takes the drift off heights above the sea and above take-off, evenly in time.
void take_off_drift(ingest::Flight& flight, const HeightDrift& drift);

/// "height drift of +2.3 m by the landing, taken off evenly in time"
std::string drift_words(const HeightDrift& drift);

}  // namespace quadsonde::product
