#pragma once
// Which messages and fields of ArduPilot a Flight is made of. Labels are alternatives joined by '|': the first that
// the log has. What a value is and which sign it has stands beside its row; scaling is the container's.
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "ingest/dataflash/dataflash_reader.h"

namespace quadsonde::ingest::dataflash {

enum class Row {
  none,
  attitude,
  gps,
  gps_accuracy,
  ekf_state,
  ekf_wind,
  ekf_primary,
  barometer,
  imu,
  parameter,
  text,
  mode,
  event,
  arming,
  origin,
  position,
  esc,
  hygrometer,
  simulator
};

constexpr std::size_t most_values = 10;

struct RowSpec {
  std::string_view message;
  Row row;
  int generation;  ///< of the EKF (1, 2, 3); 0 for other rows
  int instance;    ///< fixed by the name; -1: by the instance field, 0 without one
  std::array<std::string_view, most_values> labels;
};

// Source: ArduPilot libraries/AP_Logger/LogStructure.h, AP_NavEKF2/LogStructure.h, AP_NavEKF3/LogStructure.h;
// versions 3.2 to 4.5.
constexpr RowSpec rows[] = {
    // Vehicle attitude with the board trim applied: degrees, yaw 0 to 360. A "qw" field is PX4's old log.
    {"ATT", Row::attitude, 0, -1, {"Roll", "Pitch", "Yaw", "AEKF", "qw"}},
    // Status 3 and more is a 3D fix; degrees, m above mean sea level, m/s, degrees from north, VZ m/s down.
    {"GPS", Row::gps, 0, -1, {"Status", "GWk|Week", "GMS|TimeMS", "Lat", "Lng", "Alt", "Spd", "GCrs", "VZ", "U"}},
    {"GPS2", Row::gps, 0, 1, {"Status", "GWk|Week", "GMS|TimeMS", "Lat", "Lng", "Alt", "Spd", "GCrs", "VZ", "U"}},
    // m/s 1-sigma; VV 1: VZ is measured; AEl m above the ellipsoid; SMS ms since boot when the receiver's message came.
    {"GPA", Row::gps_accuracy, 0, -1, {"SAcc", "VV", "AEl", "SMS"}},
    {"GPA2", Row::gps_accuracy, 0, 1, {"SAcc", "VV", "AEl", "SMS"}},
    // v_NB_N m/s, p_NB_N m from the EKF origin, degrees (with part of the trim only).
    {"XKF1", Row::ekf_state, 3, -1, {"VN", "VE", "VD", "PN", "PE", "PD", "Roll", "Pitch", "Yaw"}},
    {"XKF6", Row::ekf_state, 3, 1, {"VN", "VE", "VD", "PN", "PE", "PD", "Roll", "Pitch", "Yaw"}},
    {"NKF1", Row::ekf_state, 2, -1, {"VN", "VE", "VD", "PN", "PE", "PD", "Roll", "Pitch", "Yaw"}},
    {"NKF6", Row::ekf_state, 2, 1, {"VN", "VE", "VD", "PN", "PE", "PD", "Roll", "Pitch", "Yaw"}},
    {"EKF1", Row::ekf_state, 1, -1, {"VN", "VE", "VD", "PN", "PE", "PD", "Roll", "Pitch", "Yaw"}},
    // v_NA_N m/s: where the air moves to.
    {"XKF2", Row::ekf_wind, 3, -1, {"VWN", "VWE"}},
    {"XKF7", Row::ekf_wind, 3, 1, {"VWN", "VWE"}},
    {"NKF2", Row::ekf_wind, 2, -1, {"VWN", "VWE"}},
    {"NKF7", Row::ekf_wind, 2, 1, {"VWN", "VWE"}},
    {"EKF2", Row::ekf_wind, 1, -1, {"VWN", "VWE"}},
    {"XKF4", Row::ekf_primary, 3, -1, {"PI"}},
    {"NKF4", Row::ekf_primary, 2, -1, {"PI"}},
    // Pa; m above the place of calibration; ms since boot of the measurement.
    {"BARO", Row::barometer, 0, -1, {"Press", "Alt", "SMS"}},
    // Specific force m/s2, forward right down.
    {"IMU", Row::imu, 0, -1, {"AccX", "AccY", "AccZ"}},
    {"PARM", Row::parameter, 0, -1, {"Name", "Value"}},
    {"MSG", Row::text, 0, -1, {"Message"}},
    {"MODE", Row::mode, 0, -1, {"ModeNum|Mode"}},
    {"EV", Row::event, 0, -1, {"Id"}},
    {"ARM", Row::arming, 0, -1, {"ArmState"}},
    // Type 0: where the EKF counts from, degrees and m above mean sea level.
    {"ORGN", Row::origin, 0, -1, {"Type", "Lat", "Lng", "Alt"}},
    // As fused: degrees, m above mean sea level, m above the place of take-off.
    {"POS", Row::position, 0, -1, {"Lat", "Lng", "Alt", "RelHomeAlt|RelAlt"}},
    {"ESC", Row::esc, 0, -1, {"RPM"}},
    {"ESC1", Row::esc, 0, 0, {"RPM"}},
    {"ESC2", Row::esc, 0, 1, {"RPM"}},
    {"ESC3", Row::esc, 0, 2, {"RPM"}},
    {"ESC4", Row::esc, 0, 3, {"RPM"}},
    {"ESC5", Row::esc, 0, 4, {"RPM"}},
    {"ESC6", Row::esc, 0, 5, {"RPM"}},
    {"ESC7", Row::esc, 0, 6, {"RPM"}},
    {"ESC8", Row::esc, 0, 7, {"RPM"}},
    // A sensor made for the air: degC, %.
    {"HYGR", Row::hygrometer, 0, -1, {"Temp", "Humidity"}},
    {"SIM", Row::simulator, 0, -1, {"Lat"}},
};

/// A row found in the layouts of one log: plain pointers into them, good for one generation of the layout.
struct Binding {
  std::uint32_t layout_generation = 0;
  Row row = Row::none;
  int ekf = 0, fixed_instance = -1;
  const DataflashField* time = nullptr;
  double time_unit_ns = 0;
  const DataflashField* instance = nullptr;
  std::array<const DataflashField*, most_values> fields{};

  /// In the unit of the row; NaN if the log has no such field.
  double value(const DataflashMessage& message, std::size_t i) const {
    return fields[i] == nullptr ? std::numeric_limits<double>::quiet_NaN() : message.scaled(*fields[i]);
  }
  /// The raw integer, or what there is if not.
  std::int64_t integer(const DataflashMessage& message, std::size_t i, std::int64_t missing) const {
    return fields[i] == nullptr ? missing : message.integer(*fields[i]);
  }
  std::string_view text(const DataflashMessage& message, std::size_t i) const {
    return fields[i] == nullptr ? std::string_view() : message.text(*fields[i]);
  }
  int instance_of(const DataflashMessage& message) const {
    if (fixed_instance >= 0) return fixed_instance;
    return instance == nullptr ? 0 : static_cast<int>(message.integer(*instance));
  }
};

Binding bind(const DataflashLayout& layout);

}  // namespace quadsonde::ingest::dataflash
