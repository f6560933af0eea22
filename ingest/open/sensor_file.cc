#include "ingest/open/sensor_file.h"

#include <map>

#include "ingest/csv/flight_from_csv.h"
#include "ingest/open/mapped_file.h"

namespace quadsonde::ingest {

Result<SensorRecord> read_sensor_file(const std::filesystem::path& path) {
  const auto mapped = MappedFile::open(path);
  if (!mapped) return fail(mapped.error());
  auto content = read_csv(mapped->bytes(), path.string());
  if (!content) return fail(std::move(content.error()));
  auto& table = content->flights.front();
  tidy(table);
  SensorRecord record;
  record.file = path.string();
  record.clock = table.clock;
  for (const auto& topic : content->topics) record.own_log_time = record.own_log_time || topic.name == "time_s";
  record.air.source = "sensor file " + path.filename().string();
  // Pressure and humidity may come in cells of their own rows.
  std::map<LogTime, AirSample> rows;
  for (std::size_t i = 0; i < table.air.size(); ++i) rows[table.air.time[i]] = table.air.value[i];
  for (std::size_t i = 0; i < table.barometer.size(); ++i)
    rows[table.barometer.time[i]].pressure_pa = table.barometer.value[i].pressure_pa;
  for (const auto& [t, sample] : rows)
    if (sample.temperature_k || sample.relative_humidity_pct || sample.pressure_pa) record.air.push(t, sample);
  if (record.air.empty())
    return fail(Kind::missing, "the sensor file has no temperature_k, relative_humidity_pct or pressure_pa",
                {path.string(), {}, {}, {}}, "name its columns so");
  return record;
}

void add_sensor(Flight& flight, const SensorRecord& record, double offset_s) {
  const bool by_utc = record.clock.utc_minus_log && flight.clock.utc_minus_log;
  const auto complain = [&](const char* what, const char* hint) {
    flight.problems.push_back({Kind::doubtful, what, {record.file, {}, {}, {}}, hint});
  };
  if (!by_utc && !record.own_log_time)
    return complain("the sensor file is in UTC and the log knows no UTC, so it cannot be placed",
                    "give it a time_s on the log's clock");
  Stream<AirSample> air;
  air.source = record.air.source;
  const auto span = time_span(flight);
  bool overlaps = !span;
  for (std::size_t i = 0; i < record.air.size(); ++i) {
    auto t = record.air.time[i];
    if (by_utc) t = *flight.clock.to_log(*record.clock.to_utc(t));
    t = t + seconds(offset_s);
    overlaps = overlaps || (t >= span->first && t <= span->second);
    air.push(t, record.air.value[i]);
  }
  if (!overlaps)
    return complain("no time of the sensor file lies in the flight", "check its clock, or give --sensor-offset-s");
  flight.air = std::move(air);
}

}  // namespace quadsonde::ingest
