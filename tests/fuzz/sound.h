#pragma once
// What must hold of any reader's answer, whatever the bytes were. Breaks with a trap, so that a fuzzer sees it.
#include <cstdlib>

#include "ingest/flight/flight.h"

namespace quadsonde::fuzz {

inline void require(bool claim) {
  if (!claim) std::abort();
}

template <class T>
void require_column(const ingest::Stream<T>& stream) {
  require(stream.time.size() == stream.value.size());
  for (std::size_t i = 1; i < stream.time.size(); ++i) require(stream.time[i - 1] <= stream.time[i]);
}

/// Columns of one length in time order, unit quaternions, finite velocities, and no more messages than bytes.
inline void require_sound(const ingest::Result<ingest::LogContent>& content, std::size_t bytes) {
  if (!content) {
    require(!content.error().what.empty());
    return;
  }
  require(content->messages <= bytes && content->salvaged <= content->messages);
  for (const auto& flight : content->flights) {
    require_column(flight.attitude);
    require_column(flight.velocity);
    require_column(flight.position);
    require_column(flight.local_position);
    require_column(flight.height_msl);
    require_column(flight.barometer);
    require_column(flight.autopilot_wind);
    require(flight.velocity.sd.empty() || flight.velocity.sd.size() == flight.velocity.size());
    require(flight.attitude.size() <= bytes && flight.velocity.size() <= bytes);
    for (const auto& q : flight.attitude.value) require(std::abs(q.norm() - 1) < 1e-6);
    for (const auto& v : flight.velocity.value) require(v.allFinite());
  }
}

}  // namespace quadsonde::fuzz
