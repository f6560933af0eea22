#include <fmt/format.h>

#include <algorithm>

#include "ingest/ulog/topic_reader.h"
#include "ingest/ulog/topics.h"

namespace quadsonde::ingest::ulog {
namespace {

/// MAV_TYPE of the MAVLink common definitions.
struct VehicleType {
  int mav_type;
  Airframe airframe;
  int rotors;
};
constexpr VehicleType vehicle_types[] = {
    {1, Airframe::fixed_wing, 0},   {2, Airframe::multirotor, 4},  {3, Airframe::helicopter, 0},
    {4, Airframe::helicopter, 0},   {13, Airframe::multirotor, 6}, {14, Airframe::multirotor, 8},
    {15, Airframe::multirotor, 3},  {19, Airframe::vtol, 0},       {20, Airframe::vtol, 0},
    {21, Airframe::vtol, 0},        {22, Airframe::vtol, 0},       {23, Airframe::vtol, 0},
    {24, Airframe::vtol, 0},        {25, Airframe::vtol, 0},       {29, Airframe::multirotor, 12},
    {35, Airframe::multirotor, 10}, {10, Airframe::other, 0},      {11, Airframe::other, 0},
    {12, Airframe::other, 0}};

/// PX4 airframe numbers (ROMFS/px4fmu_common/init.d/airframes), where MAV_TYPE is not logged.
Airframe airframe_of_autostart(double number) {
  const auto thousand = static_cast<int>(number) / 1000;
  switch (thousand) {
    case 2:
    case 3:
      return Airframe::fixed_wing;
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
    case 9:
    case 12:
    case 14:
      return Airframe::multirotor;
    case 13:
      return Airframe::vtol;
    default:
      return Airframe::unknown;
  }
}

/// "1.9.0 beta" out of 0xMMmmppTT.
std::string version_text(std::uint32_t release) {
  const auto type = release & 0xFF;
  const char* name = type == 255 ? "" : type >= 192 ? " rc" : type >= 128 ? " beta" : type >= 64 ? " alpha" : " dev";
  return fmt::format("{}.{}.{}{}", release >> 24, release >> 16 & 0xFF, release >> 8 & 0xFF, name);
}

std::string mode_name(double nav_state) {
  // vehicle_status.nav_state of 1.6 to 1.15.
  static constexpr std::pair<int, const char*> names[] = {
      {0, "manual"}, {1, "altitude"}, {2, "position"},        {3, "mission"},   {4, "hold"},        {5, "return"},
      {10, "acro"},  {12, "descend"}, {13, "terminate"},      {14, "offboard"}, {15, "stabilized"}, {17, "take-off"},
      {18, "land"},  {19, "follow"},  {20, "precision land"}, {21, "orbit"}};
  for (const auto& [number, name] : names)
    if (number == nav_state) return name;
  return fmt::format("nav_state {}", nav_state);
}

void map_status(Mapping& m) {
  const auto* topic = find_topic(m.log, "vehicle_status");
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const auto arming = reader.column("arming_state"), mode = reader.column("nav_state");
  constexpr double armed = 2;  // ARMING_STATE_ARMED, all versions
  std::optional<bool> was_armed;
  double last_mode = -1;
  reader.for_each([&](LogTime t, Bytes row) {
    const bool now = real(row, arming) == armed;
    if (arming && was_armed != now && (was_armed || now))
      m.flight.events.push(t, {now ? Event::What::armed : Event::What::disarmed, {}});
    if (arming) was_armed = now;
    const double now_mode = real(row, mode);
    if (mode && now_mode != last_mode) m.flight.events.push(t, {Event::What::mode, mode_name(now_mode)});
    if (mode) last_mode = now_mode;
  });
}

void map_landed(Mapping& m) {
  const auto* topic = find_topic(m.log, "vehicle_land_detected");
  if (!topic) return;
  const TopicReader reader(m.log, *topic);
  const auto landed = reader.column("landed");
  if (!landed) return;
  auto& stream = m.flight.landed;
  stream.source = reader.name();
  reader.for_each([&](LogTime t, Bytes row) {
    const bool now = flag(row, landed, false);
    if (!stream.empty() && stream.value.back() != now)
      m.flight.events.push(t, {now ? Event::What::landed : Event::What::takeoff, {}});
    stream.push(t, now);
  });
}

void map_texts(Mapping& m) {
  constexpr std::uint64_t most_us = std::numeric_limits<std::int64_t>::max() / 1000;
  for (const auto& text : m.log.texts)
    if (text.timestamp_us <= most_us)
      m.flight.events.push(LogTime{static_cast<std::int64_t>(text.timestamp_us) * 1000},
                           {Event::What::text, text.text});
}

/// A dropout names its length only; it lies behind the data message before it.
void map_dropouts(Mapping& m) {
  std::uint64_t total_ms = 0;
  for (const auto& dropout : m.log.dropouts) {
    total_ms += dropout.duration_ms;
    if (dropout.after_payload_at == 0) continue;
    const TopicReader reader(m.log, m.log.topics[dropout.after_topic]);
    const auto column = reader.column("timestamp");
    if (!column) continue;
    const auto from = reader.time(m.log.payload_at(dropout.after_payload_at));
    if (from) m.flight.gaps.push_back({*from, *from + std::chrono::milliseconds(dropout.duration_ms)});
  }
  if (!m.log.dropouts.empty())
    m.details.emplace_back("dropouts", fmt::format("{} ({} ms)", m.log.dropouts.size(), total_ms));
}

/// The type that the vehicle itself told last, where the parameters do not say.
std::optional<double> last_value(const Log& log, std::string_view topic_name, std::string_view field) {
  const auto* topic = find_topic(log, topic_name);
  if (!topic) return std::nullopt;
  const TopicReader reader(log, *topic);
  const auto column = reader.column(field);
  if (!column || reader.size() == 0) return std::nullopt;
  return number(reader.row(reader.size() - 1), *column);
}

void map_airframe(Mapping& m) {
  auto& vehicle = m.flight.vehicle;
  auto type = m.log.parameter("MAV_TYPE");
  if (!type || *type == 0) type = last_value(m.log, "vehicle_status", "system_type");
  for (const auto& known : vehicle_types)
    if (type && known.mav_type == *type) {
      vehicle.airframe = known.airframe;
      vehicle.rotors = known.rotors;
    }
  if (const auto autostart = m.log.parameter("SYS_AUTOSTART")) {
    m.details.emplace_back("airframe", fmt::format("SYS_AUTOSTART {}", *autostart));
    if (vehicle.airframe == Airframe::unknown) vehicle.airframe = airframe_of_autostart(*autostart);
  }
  const auto rotors = m.log.parameter("CA_ROTOR_COUNT");
  if (rotors && *rotors > 0 && *rotors <= 16 && vehicle.airframe == Airframe::multirotor)
    vehicle.rotors = static_cast<int>(*rotors);
}

bool is_simulated(const Log& log) {
  const auto ends_with = [](const std::string& text, std::string_view end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
  };
  for (const auto& topic : log.topics)
    if (ends_with(topic.name, "_groundtruth")) return true;
  return log.info_text("ver_hw").find("SITL") != std::string::npos || log.parameter("SYS_HITL").value_or(0) > 0 ||
         last_value(log, "vehicle_status", "hil_state").value_or(0) == 1;
}

}  // namespace

void map_events(Mapping& m) {
  map_status(m);
  map_landed(m);
  map_texts(m);
  map_dropouts(m);
}

void map_vehicle(Mapping& m) {
  auto& vehicle = m.flight.vehicle;
  const auto hardware = m.log.info_text("ver_hw");
  const auto serial = m.log.info_text("sys_uuid");
  vehicle.name = serial.empty() ? hardware : serial;
  vehicle.autopilot = m.log.info_text("sys_name");
  if (const auto release = m.log.info.find("ver_sw_release"); release != m.log.info.end())
    vehicle.firmware = version_text(static_cast<std::uint32_t>(release->second.number().value_or(0)));
  if (const auto hash = m.log.info_text("ver_sw"); !hash.empty())
    vehicle.firmware += (vehicle.firmware.empty() ? "" : " ") + hash.substr(0, 10);
  if (!hardware.empty()) m.details.emplace_back("hardware", hardware);
  map_airframe(m);
  vehicle.simulated = is_simulated(m.log);
}

}  // namespace quadsonde::ingest::ulog
