#pragma once
// The text of a ROS message definition, with the definitions it needs behind it.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadsonde::ingest {

enum class RosType { boolean, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64, text, time,
                     structure };

struct RosField {
  std::string name;
  RosType type = RosType::structure;
  std::size_t structure = 0;             ///< index of the definition, for a structure
  bool is_array = false;
  std::optional<std::uint32_t> length;   ///< of an array of fixed length
};

struct RosStructure {
  std::string name;  ///< package/Type
  std::vector<RosField> fields;
};

/// The first structure is the message itself.
struct RosDefinition {
  std::vector<RosStructure> structures;
};

/// Reads ros1msg and ros2msg texts (constants and defaults are passed over).
/// @param name  of the schema: "sensor_msgs/msg/NavSatFix" or "sensor_msgs/NavSatFix"
/// @return nothing if a line is no definition, a type is missing, or types contain themselves
std::optional<RosDefinition> parse_ros_definition(std::string_view name, std::string_view text);

}  // namespace quadsonde::ingest
