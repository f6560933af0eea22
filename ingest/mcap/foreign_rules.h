#pragma once
// One rule for each kind of foreign message: which fields are which stream, in which axes.
#include <functional>

#include "ingest/mcap/foreign_topics.h"
#include "ingest/mcap/message_decoder.h"

namespace quadsonde::ingest::foreign {

/// Puts one message into a part.
using Rule = std::function<void(LogTime, const Json&, Part&)>;

/// Axes of a vector or an attitude.
enum class Axes { ned, enu, frd, flu };

/// ENU to NED, FLU to FRD; the others stay.
Eigen::Vector3d to_ours(Axes axes, const Eigen::Vector3d& v);
/// FLU to ENU becomes FRD to NED.
Eigen::Quaterniond q_NB_from_enu_flu(const Eigen::Quaterniond& q);

/// Three numbers of an object, by default x, y and z.
std::optional<Eigen::Vector3d> vector_at(const Json& message, const std::string& path);
std::optional<Eigen::Quaterniond> quaternion_at(const Json& message, const std::string& path);

/// The rule for a schema of Foxglove or ROS, else nothing.
Rule rule_for_schema(const std::string& schema_name);
/// The same for PX4's own messages, bridged to ROS 2: "px4_msgs/VehicleAttitude".
Rule px4_rule(const std::string& plain_name);
/// By the names of JSON fields.
/// @param topic  a pair "north", "east" is a wind only on a topic or schema with "wind" in its name
Rule rule_for_json(const std::string& topic, const std::string& schema_name);
/// By the user's map; nothing if it does not name this topic.
Rule rule_for_map(const std::string& topic, const TopicMap& map);

/// The time that a message states for itself (Foxglove's timestamp, ROS's header.stamp), where it is within 10 s of
/// the log time: the instant of the measurement, not of its arrival.
LogTime stated_time(LogTime log_time, const Json& message);

}  // namespace quadsonde::ingest::foreign
