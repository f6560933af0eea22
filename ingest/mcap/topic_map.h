#pragma once
// What the streams of a foreign MCAP are, in the user's own words.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::ingest {

/// One stream of a flight, and the fields of the messages that carry it. In TOML:
///   [velocity]
///   topic = "/odometry"
///   fields = ["twist.linear.x", "twist.linear.y", "twist.linear.z"]
///   axes = "enu"
///   scale = 1.0               # value = field * scale + offset, in SI or in degrees of latitude and longitude
/// Axes are "ned" or "enu" for velocity, local_position and wind (two fields), "frd" or "flu" for accelerometer (and
/// for a velocity on the topic of the attitude), "ned_frd" or "enu_flu" for attitude. An attitude has four fields
/// (w, x, y, z) or three (roll, pitch, yaw; scale takes them to radians).
/// Times are MCAP's log_time, unless `time` names a field and `time_scale` takes it to seconds.
struct TopicRule {
  std::string topic;
  std::vector<std::string> fields;
  std::string axes;
  double scale = 1, offset = 0;
  std::string time;
  double time_scale = 1;
};

/// Rules by stream: attitude, velocity, position, local_position, height_msl, height_ellipsoid, height_ground,
/// pressure, baro_altitude, accelerometer, temperature, humidity, wind, rotors, landed.
struct TopicMap {
  std::map<std::string, TopicRule> rules;
};

/// @param file_name  for messages only
/// @return fails with usage, naming the line, if a key is unknown or a rule incomplete
Result<TopicMap> parse_topic_map(std::string_view toml, const std::string& file_name);

}  // namespace quadsonde::ingest
