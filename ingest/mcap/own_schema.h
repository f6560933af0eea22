#pragma once
// The names that writer and reader of our own logs share.
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/flight.h"

namespace google::protobuf {
class Descriptor;
}

namespace quadsonde::ingest::own {

inline constexpr std::string_view kTopicPrefix = "/quadsonde/";
inline constexpr std::string_view kPackage = "quadsonde.";

/// Metadata records.
inline constexpr const char* kClock = "quadsonde.clock";
inline constexpr const char* kVehicle = "quadsonde.vehicle";
inline constexpr const char* kOrigin = "quadsonde.origin";
inline constexpr const char* kFlight = "quadsonde.flight";
inline constexpr const char* kProduct = "quadsonde.product";

/// Key of kClock and of every channel: nanoseconds to subtract from an MCAP time for the source's log clock.
inline constexpr const char* kShift = "mcap_minus_log_ns";
/// Keys of a channel.
inline constexpr const char* kSource = "source";
inline constexpr const char* kVelocityOrigin = "velocity_origin";
inline constexpr const char* kLatency = "latency_s";  // median age of a sample when the source stamped it
inline constexpr const char* kLatencyAtLeast = "latency_at_least";

/// A number as text that reads back to the same bits.
template <class T>
std::optional<T> number_from(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Words for enumerators, and back; an unknown word gives nothing.
std::string_view name_of(Airframe airframe);
std::string_view name_of(VelocityOrigin origin);
std::string_view name_of(Kind kind);
std::optional<Airframe> airframe_named(std::string_view name);
std::optional<VelocityOrigin> velocity_origin_named(std::string_view name);
std::optional<Kind> kind_named(std::string_view name);

/// The text with every byte that is no UTF-8 replaced by '?': MCAP and protobuf take nothing else.
std::string utf8(std::string_view text);

/// Serialised FileDescriptorSet of a message and all that it needs: the schema data of an MCAP protobuf channel.
std::string descriptor_set(const google::protobuf::Descriptor& message);
/// The same as a JSON schema of the proto3 JSON form, field names as in the .proto.
std::string json_schema(const google::protobuf::Descriptor& message);

}  // namespace quadsonde::ingest::own
