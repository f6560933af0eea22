#pragma once
// Where in a log the vehicle flies.
#include <vector>

#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct SegmentSettings {
  double min_duration = 10;       ///< shorter hops are not flights [s]
  double height_in_air = 1.0;     ///< above the lowest height around [m]
  double speed_in_air = 1.0;      ///< a ground speed that no parked vehicle shows [m/s]
  double min_ground_time = 5;     ///< shorter touches of the ground do not end a flight [s]
  double max_gap = 10;            ///< a longer gap in the data ends a flight [s]
};

/// One airborne part of a flight.
struct Segment {
  LogTime from, to;
  bool starts_in_air = false;  ///< the log begins in flight: take-off was not seen
  bool ends_in_air = false;
};

/// Airborne segments in time order: by the log's own word (`landed`) where it has one, else by height over the
/// lowest height and by speed; never where the log says that the motors are disarmed. Empty if it never flies.
std::vector<Segment> airborne_segments(const Flight& flight, const SegmentSettings& settings = {});

/// MSL height of the take-off point of a segment: the last height before lift-off, else at the landing, else empty.
std::optional<MslHeight> takeoff_height(const Flight& flight, const Segment& segment);

}  // namespace quadsonde::ingest
