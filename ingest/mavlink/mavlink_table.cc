// Which messages and fields a Flight is made of. Units and signs stand beside each row.
#include <algorithm>
#include <map>

#include "ingest/mavlink/mavlink_vehicle.h"

namespace quadsonde::ingest::mavlink {
namespace {

struct RowSpec {
  std::string_view message;
  Row row;
  int variant;
  std::string_view time;  ///< empty: only the ground station's clock
  std::array<std::string_view, most_values> fields;
};

// Source: mavlink/mavlink message_definitions (common.xml, ardupilotmega.xml); signs of WIND from ArduPilot's sender.
constexpr RowSpec rows[] = {
    {"HEARTBEAT", Row::heartbeat, 0, "", {"type", "autopilot", "base_mode", "custom_mode"}},
    // us since 1970, 0 before GPS; ms since boot.
    {"SYSTEM_TIME", Row::system_time, 0, "time_boot_ms", {"time_unix_usec"}},
    // rad, yaw pitch roll order, NED to forward right down.
    {"ATTITUDE", Row::attitude, 0, "time_boot_ms", {"roll", "pitch", "yaw"}},
    // w x y z, body to NED.
    {"ATTITUDE_QUATERNION", Row::attitude_quaternion, 0, "time_boot_ms", {"q1", "q2", "q3", "q4"}},
    // m and m/s, NED.
    {"LOCAL_POSITION_NED", Row::local_position, 0, "time_boot_ms", {"x", "y", "z", "vx", "vy", "vz"}},
    // 1e-7 deg, mm above mean sea level and above home, cm/s NED.
    {"GLOBAL_POSITION_INT",
     Row::global_position,
     0,
     "time_boot_ms",
     {"lat", "lon", "alt", "relative_alt", "vx", "vy", "vz"}},
    // 1e-7 deg, mm above mean sea level, cm/s and 0.01 deg over ground, mm above the ellipsoid, mm/s 1-sigma.
    {"GPS_RAW_INT",
     Row::gps_raw,
     0,
     "time_usec",
     {"fix_type", "lat", "lon", "alt", "vel", "cog", "alt_ellipsoid", "vel_acc"}},
    // hPa.
    {"SCALED_PRESSURE", Row::pressure, 0, "time_boot_ms", {"press_abs"}},
    // 0.001 g; forward right down.
    {"SCALED_IMU", Row::imu_scaled, 0, "time_boot_ms", {"xacc", "yacc", "zacc"}},
    // Raw by definition; ArduPilot sends 0.001 g.
    {"RAW_IMU", Row::imu_raw, 0, "time_usec", {"xacc", "yacc", "zacc"}},
    // m/s2; hPa.
    {"HIGHRES_IMU", Row::imu_highres, 0, "time_usec", {"xacc", "yacc", "zacc", "abs_pressure", "fields_updated"}},
    // deg the wind comes FROM, m/s.
    {"WIND", Row::wind, 0, "", {"direction", "speed", "speed_z"}},
    // m/s NED, TOWARD; var_horiz is a 1-sigma in m/s in spite of its name.
    {"WIND_COV", Row::wind_cov, 0, "time_usec", {"wind_x", "wind_y", "var_horiz"}},
    {"EXTENDED_SYS_STATE", Row::landed, 0, "", {"landed_state"}},
    {"ESC_STATUS", Row::esc_status, 0, "time_usec", {"rpm", "index"}},
    {"ESC_TELEMETRY_1_TO_4", Row::esc_telemetry, 0, "", {"rpm"}},
    {"ESC_TELEMETRY_5_TO_8", Row::esc_telemetry, 4, "", {"rpm"}},
    {"ESC_TELEMETRY_9_TO_12", Row::esc_telemetry, 8, "", {"rpm"}},
    // 0.01 degC, 0.01 %.
    {"HYGROMETER_SENSOR", Row::hygrometer, 0, "", {"temperature", "humidity"}},
    {"STATUSTEXT", Row::text, 0, "", {"text", "id", "chunk_seq"}},
    {"AUTOPILOT_VERSION", Row::version, 0, "", {"flight_sw_version"}},
    {"PARAM_VALUE", Row::parameter, 0, "", {"param_id", "param_value"}},
    // 1e-7 deg, mm above mean sea level.
    {"GPS_GLOBAL_ORIGIN", Row::origin, 0, "", {"latitude", "longitude", "altitude"}},
    {"SIMSTATE", Row::simulator, 0, "", {}},
    {"SIM_STATE", Row::simulator, 0, "", {}},
};

struct Bindings {
  std::vector<std::vector<MavlinkField>> fields;
  std::vector<Binding> by_row;  ///< beside mavlink_messages()

  Bindings() : by_row(mavlink_messages().size()) {
    fields.reserve(std::size(rows));
    for (const auto& spec : rows) {
      const auto* info = find_mavlink_message(spec.message);
      fields.push_back(mavlink_fields(*info));
      auto& binding = by_row[static_cast<std::size_t>(info - mavlink_messages().data())];
      binding.row = spec.row;
      binding.variant = spec.variant;
      binding.time = find(spec.time);
      binding.time_is_ms = spec.time == "time_boot_ms";
      for (std::size_t i = 0; i < most_values; ++i) binding.fields[i] = find(spec.fields[i]);
    }
  }
  const MavlinkField* find(std::string_view name) const {
    for (const auto& field : fields.back())
      if (field.name == name) return &field;
    return nullptr;
  }
};

}  // namespace

const Binding& binding_of(const MavlinkMessageInfo& info) {
  static const Bindings bindings;
  return bindings.by_row[static_cast<std::size_t>(&info - mavlink_messages().data())];
}

}  // namespace quadsonde::ingest::mavlink
