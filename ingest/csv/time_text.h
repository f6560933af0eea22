#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "ingest/flight/time.h"

namespace quadsonde::ingest::csv {

/// Seconds east of UTC of "Z", "UTC", "+02:00", "-0700", "+2"; empty if it is none.
std::optional<int> parse_zone(std::string_view text);

/// One way in which a table writes its time.
/// format: "iso" (YYYY-MM-DD or YYYY/MM/DD, then the time), "unix", "unix_ms", "unix_us" (numbers since 1970), or a
/// pattern of %Y %y %m %d %H %I %M %S (with a fraction) %p %z and plain characters.
struct TimeFormat {
  std::string format = "iso";
  int zone_s = 0;  ///< of a text that names no zone itself
};

/// Is it a format that parse_time knows?
bool is_time_format(std::string_view format);
std::optional<UtcTime> parse_time(std::string_view text, const TimeFormat& format);

}  // namespace quadsonde::ingest::csv
