#pragma once
// Times. A log's own clock and UTC never mix: only a Clock converts, by name.
#include <chrono>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadsonde::ingest {

using Duration = std::chrono::nanoseconds;

/// Nearest nanosecond of a number of seconds; saturates beyond +-292 years, a NaN gives zero.
Duration seconds(double s);
/// Seconds as a double (exact to 1 ns below 104 days).
inline double to_seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }

/// An instant on the source's own clock [ns since an origin that the log chose, often boot].
struct LogTime {
  std::int64_t ns = 0;
  friend auto operator<=>(const LogTime&, const LogTime&) = default;
};
inline Duration operator-(LogTime a, LogTime b) {
  return Duration(static_cast<std::int64_t>(static_cast<std::uint64_t>(a.ns) - static_cast<std::uint64_t>(b.ns)));
}
inline LogTime operator+(LogTime t, Duration d) {
  return {static_cast<std::int64_t>(static_cast<std::uint64_t>(t.ns) + static_cast<std::uint64_t>(d.count()))};
}
inline LogTime operator-(LogTime t, Duration d) { return t + (-d); }

/// An instant of UTC [ns since 1970-01-01T00:00:00Z, leap seconds not counted (POSIX)].
struct UtcTime {
  std::int64_t ns = 0;
  friend auto operator<=>(const UtcTime&, const UtcTime&) = default;
};
inline Duration operator-(UtcTime a, UtcTime b) { return Duration(a.ns - b.ns); }
inline UtcTime operator+(UtcTime t, Duration d) { return {t.ns + d.count()}; }

/// "2026-11-23T12:00:00.250Z"; fractional digits 0, 3, 6 or 9.
std::string to_iso8601(UtcTime t, int fraction_digits = 3);
/// Reads YYYY-MM-DD[T or blank]hh:mm[:ss[.f]][Z or +hh:mm]; without a zone it is UTC. Empty if it is none of these.
std::optional<UtcTime> parse_iso8601(std::string_view text);

/// GPS minus UTC [s] at a GPS time given in seconds since 1980-01-06 (leap seconds up to 2017-01-01; none since).
int gps_minus_utc_s(std::int64_t gps_s);
/// UTC of a GPS week and time of week. Source: leap second table of the IERS (Bulletin C).
UtcTime utc_from_gps(int week, std::int64_t time_of_week_ms);

/// What is known of the relation of a log's clock to UTC: one constant offset per boot
/// (autopilot clocks drift below 50 ppm), empty while the log never saw UTC.
struct Clock {
  std::optional<Duration> utc_minus_log;
  double uncertainty_s = 0;  ///< 1-sigma of the offset; meaningless while it is empty
  std::string source;        ///< for people: "GPS week and time", "autopilot UTC", "column utc"

  std::optional<UtcTime> to_utc(LogTime t) const {
    if (!utc_minus_log) return std::nullopt;
    return UtcTime{(t + *utc_minus_log).ns};
  }
  std::optional<LogTime> to_log(UtcTime t) const {
    if (!utc_minus_log) return std::nullopt;
    return LogTime{t.ns - utc_minus_log->count()};
  }
};

/// How old samples are when the log stamps them.
struct Latency {
  double median_s = 0;
  /// Seen against UTC, whose offset comes from the same samples: only what is older than the quickest one shows.
  bool at_least = false;
};

/// Of ages [s], each the log's time of a sample minus the time it was measured, on one clock. Ages below zero or above
/// 10 s are none and do not count; empty when fewer than half are left.
std::optional<Latency> latency_of(std::vector<double> ages_s);

/// Collects (log time, UTC) pairs of one boot and gives the Clock: median of the offsets, robust to
/// wrong dates before the fix (pairs further than 1 s from the median do not count), uncertainty from their spread.
class ClockEstimator {
 public:
  void add(LogTime log, UtcTime utc);
  Clock estimate(std::string source) const;
  /// How much later than the quickest of its hundred neighbours a pair was logged, the median: clocks drift by less
  /// than the jitter meanwhile. Empty below 20 pairs. Always `at_least`.
  std::optional<Latency> latency() const;
  bool empty() const { return offsets_.empty(); }

 private:
  std::vector<Duration> offsets_;
};

}  // namespace quadsonde::ingest
