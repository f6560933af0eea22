#pragma once
// Messages of foreign schemas as trees of names and values.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "ingest/mcap/registry.h"

namespace quadsonde::ingest {

using Json = nlohmann::json;

/// Larger messages are pictures and clouds of points; no stream of a flight is in them.
inline constexpr std::size_t kLargestDecoded = 1u << 20;

class MessageDecoder {
 public:
  virtual ~MessageDecoder() = default;
  /// @return false if the bytes do not follow the schema; out is then not defined
  virtual bool decode(Bytes data, Json& out) = 0;
};

/// For protobuf (by the FileDescriptorSet in the schema), JSON, ROS 2 CDR and ROS 1 (by the message definition in the
/// schema). Nothing if the encoding is none of these or the schema cannot be used.
std::unique_ptr<MessageDecoder> decoder_for(const mcap::KnownChannel& channel, const mcap::KnownSchema* schema);

std::unique_ptr<MessageDecoder> protobuf_decoder(const mcap::KnownSchema& schema);
/// @param cdr  false: the serialisation of ROS 1
std::unique_ptr<MessageDecoder> ros_decoder(const mcap::KnownSchema& schema, bool cdr);

/// The value at a path like "pose.orientation.x" or "q[0]"; nothing if it is not there.
const Json* value_at(const Json& message, std::string_view path);
/// The same as a number; nothing if it is none (true and false are 1 and 0).
std::optional<double> number_at(const Json& message, std::string_view path);

}  // namespace quadsonde::ingest
