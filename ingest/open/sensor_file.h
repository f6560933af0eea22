#pragma once
// --sensor: temperature, humidity and pressure of the air that are not in the log.
#include <filesystem>

#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct SensorRecord {
  std::string file;
  Stream<AirSample> air;
  Clock clock;                ///< known where the table has `utc`
  bool own_log_time = false;  ///< the table has time_s: it is the flight's log clock unless both know UTC
};

/// Reads a table with time_s or utc and any of temperature_k, relative_humidity_pct, pressure_pa.
/// Errors: those of read_csv; missing when none of the three is there.
Result<SensorRecord> read_sensor_file(const std::filesystem::path& path);

/// Puts the record into Flight::air on the flight's clock: through UTC where both know it, else by log time.
/// A record that does not overlap the flight, or cannot be placed, becomes a Problem of the flight.
void add_sensor(Flight& flight, const SensorRecord& record, double offset_s);

}  // namespace quadsonde::ingest
