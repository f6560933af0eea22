#include "ingest/mavlink/mavlink_messages.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace quadsonde::ingest {
namespace {

// Facts of the public definitions: id, CRC_EXTRA, payload length without and with extensions, name, and for the
// messages that are read their fields. One row a message, so this file is long and says nothing else.
constexpr MavlinkMessageInfo table[] = {
    {0, 50, 9, 9, "HEARTBEAT", "custom_mode:u32 type:u8 autopilot:u8 base_mode:u8 system_status:u8 mavlink_version:u8"},
    {1, 124, 31, 43, "SYS_STATUS", {}},
    {2, 137, 12, 12, "SYSTEM_TIME", "time_unix_usec:u64 time_boot_ms:u32"},
    {4, 237, 14, 14, "PING", {}},
    {5, 217, 28, 28, "CHANGE_OPERATOR_CONTROL", {}},
    {6, 104, 3, 3, "CHANGE_OPERATOR_CONTROL_ACK", {}},
    {7, 119, 32, 32, "AUTH_KEY", {}},
    {8, 117, 36, 36, "LINK_NODE_STATUS", {}},
    {11, 89, 6, 6, "SET_MODE", {}},
    {20, 214, 20, 20, "PARAM_REQUEST_READ", {}},
    {21, 159, 2, 2, "PARAM_REQUEST_LIST", {}},
    {22, 220, 25, 25, "PARAM_VALUE", "param_value:f32 param_count:u16 param_index:u16 param_id[16]:char param_type:u8"},
    {23, 168, 23, 23, "PARAM_SET", {}},
    {24, 24, 30, 52, "GPS_RAW_INT",
     "time_usec:u64 lat:i32 lon:i32 alt:i32 eph:u16 epv:u16 vel:u16 cog:u16 fix_type:u8 "
     "satellites_visible:u8 + alt_ellipsoid:i32 h_acc:u32 v_acc:u32 vel_acc:u32 hdg_acc:u32 yaw:u16"},
    {25, 23, 101, 101, "GPS_STATUS", {}},
    {26, 170, 22, 24, "SCALED_IMU",
     "time_boot_ms:u32 xacc:i16 yacc:i16 zacc:i16 xgyro:i16 ygyro:i16 zgyro:i16 xmag:i16 ymag:i16 "
     "zmag:i16 + temperature:i16"},
    {27, 144, 26, 29, "RAW_IMU",
     "time_usec:u64 xacc:i16 yacc:i16 zacc:i16 xgyro:i16 ygyro:i16 zgyro:i16 xmag:i16 ymag:i16 zmag:i16 "
     "+ id:u8 temperature:i16"},
    {28, 67, 16, 16, "RAW_PRESSURE", {}},
    {29, 115, 14, 16, "SCALED_PRESSURE",
     "time_boot_ms:u32 press_abs:f32 press_diff:f32 temperature:i16 + temperature_press_diff:i16"},
    {30, 39, 28, 28, "ATTITUDE",
     "time_boot_ms:u32 roll:f32 pitch:f32 yaw:f32 rollspeed:f32 pitchspeed:f32 yawspeed:f32"},
    {31, 246, 32, 48, "ATTITUDE_QUATERNION",
     "time_boot_ms:u32 q1:f32 q2:f32 q3:f32 q4:f32 rollspeed:f32 pitchspeed:f32 yawspeed:f32 + "
     "repr_offset_q[4]:f32"},
    {32, 185, 28, 28, "LOCAL_POSITION_NED", "time_boot_ms:u32 x:f32 y:f32 z:f32 vx:f32 vy:f32 vz:f32"},
    {33, 104, 28, 28, "GLOBAL_POSITION_INT",
     "time_boot_ms:u32 lat:i32 lon:i32 alt:i32 relative_alt:i32 vx:i16 vy:i16 vz:i16 hdg:u16"},
    {34, 237, 22, 22, "RC_CHANNELS_SCALED", {}},
    {35, 244, 22, 22, "RC_CHANNELS_RAW", {}},
    {36, 222, 21, 37, "SERVO_OUTPUT_RAW", {}},
    {37, 212, 6, 7, "MISSION_REQUEST_PARTIAL_LIST", {}},
    {38, 9, 6, 7, "MISSION_WRITE_PARTIAL_LIST", {}},
    {39, 254, 37, 38, "MISSION_ITEM", {}},
    {40, 230, 4, 5, "MISSION_REQUEST", {}},
    {41, 28, 4, 4, "MISSION_SET_CURRENT", {}},
    {42, 28, 2, 18, "MISSION_CURRENT", {}},
    {43, 132, 2, 3, "MISSION_REQUEST_LIST", {}},
    {44, 221, 4, 5, "MISSION_COUNT", {}},
    {45, 232, 2, 3, "MISSION_CLEAR_ALL", {}},
    {46, 11, 2, 2, "MISSION_ITEM_REACHED", {}},
    {47, 153, 3, 4, "MISSION_ACK", {}},
    {48, 41, 13, 21, "SET_GPS_GLOBAL_ORIGIN", {}},
    {49, 39, 12, 20, "GPS_GLOBAL_ORIGIN", "latitude:i32 longitude:i32 altitude:i32 + time_usec:u64"},
    {50, 78, 37, 37, "PARAM_MAP_RC", {}},
    {51, 196, 4, 5, "MISSION_REQUEST_INT", {}},
    {54, 15, 27, 27, "SAFETY_SET_ALLOWED_AREA", {}},
    {55, 3, 25, 25, "SAFETY_ALLOWED_AREA", {}},
    {61, 167, 72, 72, "ATTITUDE_QUATERNION_COV", {}},
    {62, 183, 26, 26, "NAV_CONTROLLER_OUTPUT", {}},
    {63, 119, 181, 181, "GLOBAL_POSITION_INT_COV", {}},
    {64, 191, 225, 225, "LOCAL_POSITION_NED_COV", {}},
    {65, 118, 42, 42, "RC_CHANNELS", {}},
    {66, 148, 6, 6, "REQUEST_DATA_STREAM", {}},
    {67, 21, 4, 4, "DATA_STREAM", {}},
    {69, 243, 11, 18, "MANUAL_CONTROL", {}},
    {70, 124, 18, 38, "RC_CHANNELS_OVERRIDE", {}},
    {73, 38, 37, 38, "MISSION_ITEM_INT", {}},
    {74, 20, 20, 20, "VFR_HUD", "airspeed:f32 groundspeed:f32 alt:f32 climb:f32 heading:i16 throttle:u16"},
    {75, 158, 35, 35, "COMMAND_INT", {}},
    {76, 152, 33, 33, "COMMAND_LONG", {}},
    {77, 143, 3, 10, "COMMAND_ACK", {}},
    {80, 14, 4, 4, "COMMAND_CANCEL", {}},
    {81, 106, 22, 22, "MANUAL_SETPOINT", {}},
    {82, 49, 39, 51, "SET_ATTITUDE_TARGET", {}},
    {83, 22, 37, 37, "ATTITUDE_TARGET", {}},
    {84, 143, 53, 53, "SET_POSITION_TARGET_LOCAL_NED", {}},
    {85, 140, 51, 51, "POSITION_TARGET_LOCAL_NED", {}},
    {86, 5, 53, 53, "SET_POSITION_TARGET_GLOBAL_INT", {}},
    {87, 150, 51, 51, "POSITION_TARGET_GLOBAL_INT", {}},
    {89, 231, 28, 28, "LOCAL_POSITION_NED_SYSTEM_GLOBAL_OFFSET", {}},
    {90, 183, 56, 56, "HIL_STATE", {}},
    {91, 63, 42, 42, "HIL_CONTROLS", {}},
    {92, 54, 33, 33, "HIL_RC_INPUTS_RAW", {}},
    {93, 47, 81, 81, "HIL_ACTUATOR_CONTROLS", {}},
    {100, 175, 26, 34, "OPTICAL_FLOW", {}},
    {101, 102, 32, 117, "GLOBAL_VISION_POSITION_ESTIMATE", {}},
    {102, 158, 32, 117, "VISION_POSITION_ESTIMATE", {}},
    {103, 208, 20, 57, "VISION_SPEED_ESTIMATE", {}},
    {104, 56, 32, 116, "VICON_POSITION_ESTIMATE", {}},
    {105, 93, 62, 63, "HIGHRES_IMU",
     "time_usec:u64 xacc:f32 yacc:f32 zacc:f32 xgyro:f32 ygyro:f32 zgyro:f32 xmag:f32 ymag:f32 zmag:f32 "
     "abs_pressure:f32 diff_pressure:f32 pressure_alt:f32 temperature:f32 fields_updated:u16 + id:u8"},
    {106, 138, 44, 44, "OPTICAL_FLOW_RAD", {}},
    {107, 108, 64, 65, "HIL_SENSOR", {}},
    {108, 32, 84, 84, "SIM_STATE", {}},
    {109, 185, 9, 9, "RADIO_STATUS", {}},
    {110, 84, 254, 254, "FILE_TRANSFER_PROTOCOL", {}},
    {111, 34, 16, 18, "TIMESYNC", {}},
    {112, 174, 12, 12, "CAMERA_TRIGGER", {}},
    {113, 124, 36, 39, "HIL_GPS", {}},
    {114, 237, 44, 44, "HIL_OPTICAL_FLOW", {}},
    {115, 4, 64, 64, "HIL_STATE_QUATERNION", {}},
    {116, 76, 22, 24, "SCALED_IMU2", {}},
    {117, 128, 6, 6, "LOG_REQUEST_LIST", {}},
    {118, 56, 14, 14, "LOG_ENTRY", {}},
    {119, 116, 12, 12, "LOG_REQUEST_DATA", {}},
    {120, 134, 97, 97, "LOG_DATA", {}},
    {121, 237, 2, 2, "LOG_ERASE", {}},
    {122, 203, 2, 2, "LOG_REQUEST_END", {}},
    {123, 250, 113, 113, "GPS_INJECT_DATA", {}},
    {124, 87, 35, 57, "GPS2_RAW", {}},
    {125, 203, 6, 6, "POWER_STATUS", {}},
    {126, 220, 79, 81, "SERIAL_CONTROL", {}},
    {127, 25, 35, 35, "GPS_RTK", {}},
    {128, 226, 35, 35, "GPS2_RTK", {}},
    {129, 46, 22, 24, "SCALED_IMU3", {}},
    {130, 29, 13, 13, "DATA_TRANSMISSION_HANDSHAKE", {}},
    {131, 223, 255, 255, "ENCAPSULATED_DATA", {}},
    {132, 85, 14, 39, "DISTANCE_SENSOR", {}},
    {133, 6, 18, 18, "TERRAIN_REQUEST", {}},
    {134, 229, 43, 43, "TERRAIN_DATA", {}},
    {135, 203, 8, 8, "TERRAIN_CHECK", {}},
    {136, 1, 22, 22, "TERRAIN_REPORT", {}},
    {137, 195, 14, 16, "SCALED_PRESSURE2", {}},
    {138, 109, 36, 120, "ATT_POS_MOCAP", {}},
    {139, 168, 43, 43, "SET_ACTUATOR_CONTROL_TARGET", {}},
    {140, 181, 41, 41, "ACTUATOR_CONTROL_TARGET", {}},
    {141, 47, 32, 32, "ALTITUDE", {}},
    {142, 72, 243, 243, "RESOURCE_REQUEST", {}},
    {143, 131, 14, 16, "SCALED_PRESSURE3", {}},
    {144, 127, 93, 93, "FOLLOW_TARGET", {}},
    {146, 103, 100, 100, "CONTROL_SYSTEM_STATE", {}},
    {147, 154, 36, 54, "BATTERY_STATUS",
     "current_consumed:i32 energy_consumed:i32 temperature:i16 voltages[10]:u16 current_battery:i16 "
     "id:u8 battery_function:u8 type:u8 battery_remaining:i8 + time_remaining:i32 charge_state:u8 "
     "voltages_ext[4]:u16 mode:u8 fault_bitmask:u32"},
    {148, 178, 60, 78, "AUTOPILOT_VERSION",
     "capabilities:u64 uid:u64 flight_sw_version:u32 middleware_sw_version:u32 os_sw_version:u32 "
     "board_version:u32 vendor_id:u16 product_id:u16 flight_custom_version[8]:u8 "
     "middleware_custom_version[8]:u8 os_custom_version[8]:u8 + uid2[18]:u8"},
    {149, 200, 30, 60, "LANDING_TARGET", {}},
    {150, 134, 42, 42, "SENSOR_OFFSETS", {}},
    {151, 219, 8, 8, "SET_MAG_OFFSETS", {}},
    {152, 208, 4, 8, "MEMINFO", {}},
    {153, 188, 12, 12, "AP_ADC", {}},
    {154, 84, 15, 15, "DIGICAM_CONFIGURE", {}},
    {155, 22, 13, 13, "DIGICAM_CONTROL", {}},
    {156, 19, 6, 6, "MOUNT_CONFIGURE", {}},
    {157, 21, 15, 15, "MOUNT_CONTROL", {}},
    {158, 134, 14, 14, "MOUNT_STATUS", {}},
    {160, 78, 12, 12, "FENCE_POINT", {}},
    {161, 68, 3, 3, "FENCE_FETCH_POINT", {}},
    {162, 189, 8, 9, "FENCE_STATUS", {}},
    {163, 127, 28, 28, "AHRS", {}},
    {164, 154, 44, 44, "SIMSTATE", {}},
    {165, 21, 3, 3, "HWSTATUS", {}},
    {166, 21, 9, 9, "RADIO", {}},
    {167, 144, 22, 22, "LIMITS_STATUS", {}},
    {168, 1, 12, 12, "WIND", "direction:f32 speed:f32 speed_z:f32"},
    {169, 234, 18, 18, "DATA16", {}},
    {170, 73, 34, 34, "DATA32", {}},
    {171, 181, 66, 66, "DATA64", {}},
    {172, 22, 98, 98, "DATA96", {}},
    {173, 83, 8, 8, "RANGEFINDER", {}},
    {174, 167, 48, 48, "AIRSPEED_AUTOCAL", {}},
    {175, 138, 19, 19, "RALLY_POINT", {}},
    {176, 234, 3, 3, "RALLY_FETCH_POINT", {}},
    {177, 240, 20, 20, "COMPASSMOT_STATUS", {}},
    {178, 47, 24, 24, "AHRS2", {}},
    {179, 189, 29, 29, "CAMERA_STATUS", {}},
    {180, 52, 45, 47, "CAMERA_FEEDBACK", {}},
    {181, 174, 4, 4, "BATTERY2", {}},
    {182, 229, 40, 40, "AHRS3", {}},
    {183, 85, 2, 2, "AUTOPILOT_VERSION_REQUEST", {}},
    {184, 159, 206, 206, "REMOTE_LOG_DATA_BLOCK", {}},
    {185, 186, 7, 7, "REMOTE_LOG_BLOCK_STATUS", {}},
    {186, 72, 29, 29, "LED_CONTROL", {}},
    {191, 92, 27, 27, "MAG_CAL_PROGRESS", {}},
    {192, 36, 44, 54, "MAG_CAL_REPORT", {}},
    {193, 71, 22, 26, "EKF_STATUS_REPORT", {}},
    {194, 98, 25, 33, "PID_TUNING", {}},
    {195, 120, 37, 37, "DEEPSTALL", {}},
    {200, 134, 42, 42, "GIMBAL_REPORT", {}},
    {201, 205, 14, 14, "GIMBAL_CONTROL", {}},
    {214, 69, 8, 8, "GIMBAL_TORQUE_CMD_REPORT", {}},
    {215, 101, 3, 3, "GOPRO_HEARTBEAT", {}},
    {216, 50, 3, 3, "GOPRO_GET_REQUEST", {}},
    {217, 202, 6, 6, "GOPRO_GET_RESPONSE", {}},
    {218, 17, 7, 7, "GOPRO_SET_REQUEST", {}},
    {219, 162, 2, 2, "GOPRO_SET_RESPONSE", {}},
    {225, 208, 65, 65, "EFI_STATUS", {}},
    {226, 207, 8, 8, "RPM", {}},
    {230, 163, 42, 42, "ESTIMATOR_STATUS", {}},
    {231, 105, 40, 40, "WIND_COV",
     "time_usec:u64 wind_x:f32 wind_y:f32 wind_z:f32 var_horiz:f32 var_vert:f32 wind_alt:f32 "
     "horiz_accuracy:f32 vert_accuracy:f32"},
    {232, 151, 63, 65, "GPS_INPUT", {}},
    {233, 35, 182, 182, "GPS_RTCM_DATA", {}},
    {234, 150, 40, 40, "HIGH_LATENCY", {}},
    {235, 179, 42, 42, "HIGH_LATENCY2", {}},
    {241, 90, 32, 32, "VIBRATION", {}},
    {242, 104, 52, 60, "HOME_POSITION", {}},
    {243, 85, 53, 61, "SET_HOME_POSITION", {}},
    {244, 95, 6, 6, "MESSAGE_INTERVAL", {}},
    {245, 130, 2, 2, "EXTENDED_SYS_STATE", "vtol_state:u8 landed_state:u8"},
    {246, 184, 38, 38, "ADSB_VEHICLE", {}},
    {247, 81, 19, 19, "COLLISION", {}},
    {248, 8, 254, 254, "V2_EXTENSION", {}},
    {249, 204, 36, 36, "MEMORY_VECT", {}},
    {250, 49, 30, 30, "DEBUG_VECT", {}},
    {251, 170, 18, 18, "NAMED_VALUE_FLOAT", {}},
    {252, 44, 18, 18, "NAMED_VALUE_INT", {}},
    {253, 83, 51, 54, "STATUSTEXT", "severity:u8 text[50]:char + id:u16 chunk_seq:u8"},
    {254, 46, 9, 9, "DEBUG", {}},
    {256, 71, 42, 42, "SETUP_SIGNING", {}},
    {257, 131, 9, 9, "BUTTON_CHANGE", {}},
    {258, 187, 32, 232, "PLAY_TUNE", {}},
    {259, 92, 235, 235, "CAMERA_INFORMATION", {}},
    {260, 146, 5, 13, "CAMERA_SETTINGS", {}},
    {261, 179, 27, 61, "STORAGE_INFORMATION", {}},
    {262, 12, 18, 22, "CAMERA_CAPTURE_STATUS", {}},
    {263, 133, 255, 255, "CAMERA_IMAGE_CAPTURED", {}},
    {264, 49, 28, 28, "FLIGHT_INFORMATION", {}},
    {265, 26, 16, 20, "MOUNT_ORIENTATION", {}},
    {266, 193, 255, 255, "LOGGING_DATA", {}},
    {267, 35, 255, 255, "LOGGING_DATA_ACKED", {}},
    {268, 14, 4, 4, "LOGGING_ACK", {}},
    {269, 109, 213, 213, "VIDEO_STREAM_INFORMATION", {}},
    {270, 59, 19, 19, "VIDEO_STREAM_STATUS", {}},
    {271, 22, 52, 52, "CAMERA_FOV_STATUS", {}},
    {275, 126, 31, 31, "CAMERA_TRACKING_IMAGE_STATUS", {}},
    {276, 18, 49, 49, "CAMERA_TRACKING_GEO_STATUS", {}},
    {280, 70, 33, 33, "GIMBAL_MANAGER_INFORMATION", {}},
    {281, 48, 13, 13, "GIMBAL_MANAGER_STATUS", {}},
    {282, 123, 35, 35, "GIMBAL_MANAGER_SET_ATTITUDE", {}},
    {283, 74, 144, 144, "GIMBAL_DEVICE_INFORMATION", {}},
    {284, 99, 32, 32, "GIMBAL_DEVICE_SET_ATTITUDE", {}},
    {285, 137, 40, 40, "GIMBAL_DEVICE_ATTITUDE_STATUS", {}},
    {286, 210, 53, 53, "AUTOPILOT_STATE_FOR_GIMBAL_DEVICE", {}},
    {287, 1, 23, 23, "GIMBAL_MANAGER_SET_PITCHYAW", {}},
    {288, 20, 23, 23, "GIMBAL_MANAGER_SET_MANUAL_CONTROL", {}},
    {290, 251, 46, 46, "ESC_INFO", {}},
    {291, 10, 57, 57, "ESC_STATUS", "time_usec:u64 rpm[4]:i32 voltage[4]:f32 current[4]:f32 index:u8"},
    {295, 234, 12, 12, "AIRSPEED", {}},
    {299, 19, 96, 98, "WIFI_CONFIG_AP", {}},
    {300, 217, 22, 22, "PROTOCOL_VERSION", {}},
    {301, 243, 58, 58, "AIS_VESSEL", {}},
    {310, 28, 17, 17, "UAVCAN_NODE_STATUS", {}},
    {311, 95, 116, 116, "UAVCAN_NODE_INFO", {}},
    {320, 243, 20, 20, "PARAM_EXT_REQUEST_READ", {}},
    {321, 88, 2, 2, "PARAM_EXT_REQUEST_LIST", {}},
    {322, 243, 149, 149, "PARAM_EXT_VALUE", {}},
    {323, 78, 147, 147, "PARAM_EXT_SET", {}},
    {324, 132, 146, 146, "PARAM_EXT_ACK", {}},
    {330, 23, 158, 167, "OBSTACLE_DISTANCE", {}},
    {331, 91, 230, 233, "ODOMETRY", {}},
    {332, 236, 239, 239, "TRAJECTORY_REPRESENTATION_WAYPOINTS", {}},
    {333, 231, 109, 109, "TRAJECTORY_REPRESENTATION_BEZIER", {}},
    {334, 72, 10, 10, "CELLULAR_STATUS", {}},
    {335, 225, 24, 24, "ISBD_LINK_STATUS", {}},
    {336, 245, 84, 84, "CELLULAR_CONFIG", {}},
    {339, 199, 5, 5, "RAW_RPM", {}},
    {340, 99, 70, 70, "UTM_GLOBAL_POSITION", {}},
    {350, 232, 20, 252, "DEBUG_FLOAT_ARRAY", {}},
    {360, 11, 25, 25, "ORBIT_EXECUTION_STATUS", {}},
    {370, 75, 87, 109, "SMART_BATTERY_INFO", {}},
    {373, 117, 42, 42, "GENERATOR_STATUS", {}},
    {375, 251, 140, 140, "ACTUATOR_OUTPUT_STATUS", {}},
    {380, 232, 20, 20, "TIME_ESTIMATE_TO_TARGET", {}},
    {385, 147, 133, 133, "TUNNEL", {}},
    {390, 156, 238, 238, "ONBOARD_COMPUTER_STATUS", {}},
    {395, 0, 212, 212, "COMPONENT_INFORMATION", {}},
    {400, 110, 254, 254, "PLAY_TUNE_V2", {}},
    {401, 183, 6, 6, "SUPPORTED_TUNES", {}},
    {410, 160, 53, 53, "EVENT", {}},
    {411, 106, 3, 3, "CURRENT_EVENT_SEQUENCE", {}},
    {412, 33, 6, 6, "REQUEST_EVENT", {}},
    {413, 77, 7, 7, "RESPONSE_EVENT_ERROR", {}},
    {441, 169, 17, 17, "GNSS_INTEGRITY", {}},
    {9000, 113, 137, 137, "WHEEL_DISTANCE", {}},
    {9005, 117, 34, 34, "WINCH_STATUS", {}},
    {10001, 209, 20, 20, "UAVIONIX_ADSB_OUT_CFG", {}},
    {10002, 186, 41, 41, "UAVIONIX_ADSB_OUT_DYNAMIC", {}},
    {10003, 4, 1, 1, "UAVIONIX_ADSB_TRANSCEIVER_HEALTH_REPORT", {}},
    {11000, 134, 51, 52, "DEVICE_OP_READ", {}},
    {11001, 15, 135, 136, "DEVICE_OP_READ_REPLY", {}},
    {11002, 234, 179, 180, "DEVICE_OP_WRITE", {}},
    {11003, 64, 5, 5, "DEVICE_OP_WRITE_REPLY", {}},
    {11010, 46, 49, 49, "ADAP_TUNING", {}},
    {11011, 106, 44, 44, "VISION_POSITION_DELTA", {}},
    {11020, 205, 16, 16, "AOA_SSA", {}},
    {11030, 144, 44, 44, "ESC_TELEMETRY_1_TO_4",
     "voltage[4]:u16 current[4]:u16 totalcurrent[4]:u16 rpm[4]:u16 count[4]:u16 temperature[4]:u8"},
    {11031, 133, 44, 44, "ESC_TELEMETRY_5_TO_8",
     "voltage[4]:u16 current[4]:u16 totalcurrent[4]:u16 rpm[4]:u16 count[4]:u16 temperature[4]:u8"},
    {11032, 85, 44, 44, "ESC_TELEMETRY_9_TO_12",
     "voltage[4]:u16 current[4]:u16 totalcurrent[4]:u16 rpm[4]:u16 count[4]:u16 temperature[4]:u8"},
    {11033, 195, 37, 37, "OSD_PARAM_CONFIG", {}},
    {11034, 79, 5, 5, "OSD_PARAM_CONFIG_REPLY", {}},
    {11035, 128, 8, 8, "OSD_PARAM_SHOW_CONFIG", {}},
    {11036, 177, 34, 34, "OSD_PARAM_SHOW_CONFIG_REPLY", {}},
    {11037, 130, 28, 28, "OBSTACLE_DISTANCE_3D", {}},
    {11038, 47, 38, 38, "WATER_DEPTH", {}},
    {11039, 142, 9, 9, "MCU_STATUS", {}},
    {12900, 114, 44, 44, "OPEN_DRONE_ID_BASIC_ID", {}},
    {12901, 254, 59, 59, "OPEN_DRONE_ID_LOCATION", {}},
    {12902, 140, 53, 53, "OPEN_DRONE_ID_AUTHENTICATION", {}},
    {12903, 249, 46, 46, "OPEN_DRONE_ID_SELF_ID", {}},
    {12904, 150, 50, 50, "OPEN_DRONE_ID_SYSTEM", {}},
    {12905, 49, 43, 43, "OPEN_DRONE_ID_OPERATOR_ID", {}},
    {12915, 94, 249, 249, "OPEN_DRONE_ID_MESSAGE_PACK", {}},
    {12920, 20, 5, 5, "HYGROMETER_SENSOR", "temperature:i16 humidity:u16 id:u8"},
    {42000, 227, 1, 1, "ICAROUS_HEARTBEAT", {}},
    {42001, 239, 46, 46, "ICAROUS_KINEMATIC_BANDS", {}},
};

constexpr std::size_t low_ids = 512;
constexpr std::uint16_t no_row = 0xFFFF;

/// Row of each low id, so that the reader's inner loop does not search.
constexpr auto low_rows = [] {
  std::array<std::uint16_t, low_ids> rows{};
  rows.fill(no_row);
  for (std::size_t i = 0; i < std::size(table); ++i)
    if (table[i].id < low_ids) rows[table[i].id] = static_cast<std::uint16_t>(i);
  return rows;
}();

struct TypeName {
  std::string_view name;
  MavlinkType type;
  std::uint8_t size;
};
constexpr TypeName type_names[] = {
    {"u8", MavlinkType::u8, 1},   {"i8", MavlinkType::i8, 1},    {"u16", MavlinkType::u16, 2},
    {"i16", MavlinkType::i16, 2}, {"u32", MavlinkType::u32, 4},  {"i32", MavlinkType::i32, 4},
    {"u64", MavlinkType::u64, 8}, {"i64", MavlinkType::i64, 8},  {"f32", MavlinkType::f32, 4},
    {"f64", MavlinkType::f64, 8}, {"char", MavlinkType::text, 1}};

}  // namespace

std::span<const MavlinkMessageInfo> mavlink_messages() { return table; }

const MavlinkMessageInfo* find_mavlink_message(std::uint32_t id) {
  if (id < low_ids) return low_rows[id] == no_row ? nullptr : &table[low_rows[id]];
  const auto* row = std::lower_bound(std::begin(table), std::end(table), id,
                                     [](const MavlinkMessageInfo& a, std::uint32_t wanted) { return a.id < wanted; });
  return row != std::end(table) && row->id == id ? row : nullptr;
}

const MavlinkMessageInfo* find_mavlink_message(std::string_view name) {
  for (const auto& row : table)
    if (row.name == name) return &row;
  return nullptr;
}

std::int64_t MavlinkField::integer(const std::uint8_t* payload, std::size_t index) const {
  const auto* at = payload + offset;
  switch (type) {
    case MavlinkType::u8:
    case MavlinkType::text:
      return at[index];
    case MavlinkType::i8:
      return load<std::int8_t>(at + index);
    case MavlinkType::u16:
      return load<std::uint16_t>(at + 2 * index);
    case MavlinkType::i16:
      return load<std::int16_t>(at + 2 * index);
    case MavlinkType::u32:
      return load<std::uint32_t>(at + 4 * index);
    case MavlinkType::i32:
      return load<std::int32_t>(at + 4 * index);
    case MavlinkType::u64:
    case MavlinkType::i64:
      return load<std::int64_t>(at + 8 * index);
    case MavlinkType::f32:
    case MavlinkType::f64:
      return 0;
  }
  return 0;
}

double MavlinkField::number(const std::uint8_t* payload, std::size_t index) const {
  if (type == MavlinkType::f32) return load<float>(payload + offset + 4 * index);
  if (type == MavlinkType::f64) return load<double>(payload + offset + 8 * index);
  return static_cast<double>(integer(payload, index));
}

std::string_view MavlinkField::text(const std::uint8_t* payload) const {
  const auto all = as_text(Bytes(payload + offset, count));
  return all.substr(0, all.find('\0'));
}

std::vector<MavlinkField> mavlink_fields(const MavlinkMessageInfo& info) {
  std::vector<MavlinkField> fields;
  auto rest = info.fields;
  std::size_t offset = 0;
  while (!rest.empty()) {
    const auto word = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    const auto colon = word.find(':');
    if (colon == std::string_view::npos) continue;
    const auto bracket = word.find('[');
    MavlinkField field;
    field.name = word.substr(0, std::min(colon, bracket));
    field.offset = static_cast<std::uint8_t>(offset);
    if (bracket != std::string_view::npos) std::from_chars(word.data() + bracket + 1, word.data() + colon, field.count);
    for (const auto& known : type_names) {
      if (known.name != word.substr(colon + 1)) continue;
      field.type = known.type;
      offset += std::size_t{known.size} * field.count;
    }
    fields.push_back(field);
  }
  return fields;
}

}  // namespace quadsonde::ingest
