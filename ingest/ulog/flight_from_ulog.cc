#include "ingest/ulog/flight_from_ulog.h"

#include <fmt/format.h>

#include <algorithm>

#include "ingest/ulog/topics.h"

namespace quadsonde::ingest {
namespace ulog {

bool is_wanted(std::string_view topic) {
  static constexpr std::string_view wanted[] = {"vehicle_attitude",
                                                "vehicle_local_position",
                                                "vehicle_global_position",
                                                "vehicle_gps_position",
                                                "sensor_gps",
                                                "vehicle_air_data",
                                                "sensor_baro",
                                                "sensor_combined",
                                                "vehicle_acceleration",
                                                "sensor_hygrometer",
                                                "esc_status",
                                                "wind",
                                                "wind_estimate",
                                                "estimator_wind",
                                                "airspeed_wind",
                                                "vehicle_land_detected",
                                                "vehicle_status"};
  return std::find(std::begin(wanted), std::end(wanted), topic) != std::end(wanted);
}

namespace {

void describe_container(const Log& log, LogContent& content) {
  content.details.emplace_back(
      "parameters", fmt::format("{} ({} changed later)", log.parameters.size(), log.parameter_changes.size()));
  if (log.appended > 0) content.details.emplace_back("appended data", fmt::format("{} runs", log.appended));
  if (log.given_up > 0) content.details.emplace_back("given up", fmt::format("{} bytes", log.given_up));
}

/// Something that flies shows itself by an attitude or a place.
bool has_flight(const Flight& flight) {
  return !flight.attitude.empty() || !flight.velocity.empty() || !flight.position.empty() ||
         !flight.local_position.empty();
}

}  // namespace
}  // namespace ulog

Result<LogContent> read_ulog(Bytes bytes, const std::string& file_name, const UlogReadSettings& settings) {
  auto log = ulog::read(bytes, file_name, {settings.mode, ulog::is_wanted});
  if (!log) return fail(std::move(log.error()));
  LogContent content;
  content.format = "ulog";
  content.messages = log->data_messages;
  content.salvaged = log->salvaged;
  for (const auto& topic : log->topics)
    content.topics.push_back({fmt::format("{}[{}]", topic.name, topic.multi_id), topic.messages});
  ulog::describe_container(*log, content);
  content.problems = std::move(log->problems);

  Flight flight;
  ulog::Mapping mapping{*log, flight, content.details};
  ulog::map_vehicle(mapping);
  ulog::map_attitude(mapping);
  ulog::map_navigation(mapping);
  ulog::map_accelerometer(mapping);
  ulog::map_barometer(mapping);
  ulog::map_air(mapping);
  ulog::map_rotors(mapping);
  ulog::map_wind(mapping);
  ulog::map_events(mapping);
  if (ulog::has_flight(flight)) content.flights.push_back(std::move(flight));
  return content;
}

}  // namespace quadsonde::ingest
