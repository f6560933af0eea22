#pragma once
// How numbers are printed wherever people or programs read them: fixed digits, no locale, no minus zero, nothing
// for the unknown.
#include <cmath>
#include <optional>
#include <string>

#include "ingest/flight/time.h"

namespace quadsonde::product {

/// Fixed digits; empty for the unknown and for what is not finite.
std::string fixed(std::optional<double> value, int digits);
/// Seconds with six decimals, exact for every log time.
std::string seconds_text(ingest::LogTime time);
/// ISO 8601 with milliseconds and Z; empty while the clock is unknown.
std::string utc_text(std::optional<ingest::UtcTime> time);

namespace digits {
inline constexpr int degrees = 7, metres = 2, speed = 4, direction = 2, covariance = 6;
}

}  // namespace quadsonde::product
