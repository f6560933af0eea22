#include "export/csv/numbers.h"

#include <fmt/format.h>

namespace quadsonde::product {

std::string fixed(std::optional<double> value, int digits) {
  if (!value || !std::isfinite(*value)) return {};
  auto text = fmt::format("{:.{}f}", *value, digits);
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string seconds_text(ingest::LogTime time) {
  // Rounded to the microsecond without passing through a double: log clocks may count from 1970.
  const bool negative = time.ns < 0;
  const auto magnitude = negative ? 0 - static_cast<std::uint64_t>(time.ns) : static_cast<std::uint64_t>(time.ns);
  const auto micros = magnitude / 1000 + (magnitude % 1000 >= 500 ? 1 : 0);
  return fmt::format("{}{}.{:06}", negative && micros ? "-" : "", micros / 1'000'000, micros % 1'000'000);
}

std::string utc_text(std::optional<ingest::UtcTime> time) { return time ? ingest::to_iso8601(*time, 3) : ""; }

}  // namespace quadsonde::product
