// What a log must have before anybody asks it for a wind.
#include <fmt/format.h>

#include "ingest/open/open_log.h"

namespace quadsonde::ingest {
namespace {

struct LoggingHint {
  std::string_view format;
  const char* attitude;
  const char* velocity;
};

/// Which message or column to log, per format.
constexpr LoggingHint hints[] = {
    {"ulog", "log the topic vehicle_attitude (SDLOG_PROFILE, bit 0)",
     "log vehicle_gps_position or vehicle_local_position (SDLOG_PROFILE, bit 0), and fly with a GPS fix"},
    {"dataflash", "log ATT (LOG_BITMASK with ATTITUDE_MED or ATTITUDE_FAST)",
     "log GPS or XKF1 (LOG_BITMASK with GPS, NTUN), and fly with a fix"},
    {"mavlink", "stream ATTITUDE (SRx_EXTRA1 of 10 Hz or more)",
     "stream GLOBAL_POSITION_INT or GPS_RAW_INT (SRx_POSITION of 5 Hz or more)"},
    {"paparazzi", "send ROTORCRAFT_FP or ATTITUDE, and keep the .log beside the .data",
     "send ROTORCRAFT_FP, INS or GPS_INT"},
    {"csv", "add qw, qx, qy, qz or roll_deg, pitch_deg, yaw_deg, or give --columns MAP.toml",
     "add vn_m_s, ve_m_s, vd_m_s or lat_deg, lon_deg, or give --columns MAP.toml"},
    {"mcap", "name the attitude's topic in --topics MAP.toml",
     "name a velocity or position topic in --topics MAP.toml"}};

const LoggingHint& hint_for(const std::string& format) {
  for (const auto& hint : hints)
    if (hint.format == format) return hint;
  return hints[4];
}

const char* refused_as(Airframe airframe) {
  switch (airframe) {
    case Airframe::fixed_wing:
      return "a fixed-wing aircraft";
    case Airframe::vtol:
      return "a VTOL aircraft with wings";
    case Airframe::other:
      return "a ground vehicle, a boat or a submarine";
    default:
      return nullptr;
  }
}

/// What the reader itself said about something missing is closer to the file than what can be said here.
const Problem* told_missing(const Flight& flight) {
  for (const auto& problem : flight.problems)
    if (problem.kind == Kind::missing) return &problem;
  return nullptr;
}

}  // namespace

std::optional<Problem> why_unusable(const Flight& flight, const std::string& format) {
  const auto& hint = hint_for(format);
  if (const auto* refused = refused_as(flight.vehicle.airframe))
    return Problem{Kind::unsupported,
                   fmt::format("the log is of {}{}{}; only a multirotor's tilt tells the wind", refused,
                               flight.vehicle.name.empty() ? "" : ", ", flight.vehicle.name),
                   {},
                   "give the log of a multirotor"};
  const bool placed = flight.position.size() >= 3 || flight.local_position.size() >= 3;
  const bool moving = !flight.velocity.empty() || placed;
  if (!flight.attitude.empty() && moving) return std::nullopt;
  if (const auto* told = told_missing(flight)) return *told;
  if (flight.attitude.empty()) return Problem{Kind::missing, "the log has no attitude", {}, hint.attitude};
  return Problem{Kind::missing, "the log has neither a valid velocity nor a valid position", {}, hint.velocity};
}

std::optional<Problem> why_no_flight(const LogContent& content) {
  std::optional<Problem> first;
  for (const auto& flight : content.flights) {
    auto problem = why_unusable(flight, content.format);
    if (!problem) return std::nullopt;
    if (!first) first = std::move(problem);
  }
  if (first) return first;
  for (const auto& problem : content.problems)
    if (problem.kind == Kind::missing) return problem;
  return Problem{Kind::missing,
                 fmt::format("there is no flight in this log: none of its {} topics ({} messages) tells of one",
                             content.topics.size(), content.messages),
                 {},
                 hint_for(content.format).attitude};
}

}  // namespace quadsonde::ingest
