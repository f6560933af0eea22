#pragma once
// Calibration in front of a wind generator, from RUNS.toml to VEHICLE.toml and its pictures.
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "estimator/calibration/tunnel.h"
#include "export/pipeline/control.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// One [[run]].
struct TunnelEntry {
  std::filesystem::path log;     ///< found from the folder of RUNS.toml
  std::string columns = "auto";  ///< MAP.toml of a table, found likewise
  double wind_speed_m_s = 0, wind_from_deg = 0;
  std::optional<double> wind_speed_sd_m_s, air_density_kg_m3, start_s, end_s;
  std::string title() const;  ///< "run2.ulg", or "run2.ulg, 10 to 70 s"
};

/// RUNS.toml of design/CLI.md. Beside its keys there may be `id` and `name` of the vehicle, and `trim_roll_deg`,
/// `trim_pitch_deg`, `trim_sd_deg`: the trim of a calm hover, with which a run needs no full turn.
struct TunnelFile {
  double mass_kg = 0;
  std::string id, name;
  std::optional<estimator::TunnelTrim> trim;
  std::vector<TunnelEntry> runs;
};

/// Fails with Kind::usage, file and line for what is missing, misspelt or of the wrong type.
ingest::Result<TunnelFile> parse_tunnel_file(std::string_view toml, const std::filesystem::path& file);
ingest::Result<TunnelFile> read_tunnel_file(const std::filesystem::path& file);

struct TunnelRequest {
  std::filesystem::path runs;                   ///< RUNS.toml
  std::optional<std::filesystem::path> output;  ///< VEHICLE.toml; none: nothing is written
  std::optional<double> mass_kg;                ///< wins over the file's
  bool overwrite = false;
};

struct TunnelResult {
  estimator::TunnelCalibration calibration;  ///< with logs, creation time and version in its vehicle
  std::vector<ingest::Problem> problems;     ///< of the logs, then the calibration's notes
  std::vector<std::filesystem::path> files;  ///< written: the vehicle, <stem>_tilt.svg, <stem>_drag.svg
};

/// The whole job. A run uses the stated part of its log, or else what is in the air of the boot with
/// the longest flight. The vehicle's creation time
/// is SOURCE_DATE_EPOCH if set, else the end of the newest log. Fails as the readers and calibrate_tunnel do, and when
/// an output is there already (unless overwrite), cannot be written, or the work is stopped.
ingest::Result<TunnelResult> run_tunnel(const TunnelRequest& request, const Control& control = {});

/// When a vehicle file is said to be made: SOURCE_DATE_EPOCH if set, else the end of the newest log. Kind::usage for a
/// SOURCE_DATE_EPOCH that is no number.
ingest::Result<std::optional<ingest::UtcTime>> creation_time(const std::optional<ingest::UtcTime>& newest);

}  // namespace quadsonde::product
