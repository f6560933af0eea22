// CDR as ROS 2 writes it (plain, either byte order) and the serialisation of ROS 1.
#include <algorithm>
#include <array>

#include "ingest/mcap/message_decoder.h"
#include "ingest/mcap/ros_definition.h"

namespace quadsonde::ingest {
namespace {

// A message of nested arrays may not make more values than this; no message of a flight comes near.
constexpr std::size_t kMostValues = 1u << 16;

/// Reads numbers at their alignment, counted from behind the encapsulation head.
class RosReader {
 public:
  RosReader(Bytes data, bool aligned, bool swapped) : data_(data), aligned_(aligned), swapped_(swapped) {}

  template <class T>
  bool get(T& value) {
    if (aligned_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (at_ > data_.size() || data_.size() - at_ < sizeof(T)) return false;
    std::array<std::uint8_t, sizeof(T)> bytes;
    std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(at_), sizeof(T), bytes.begin());
    if (swapped_) std::ranges::reverse(bytes);
    value = load<T>(bytes.data());
    at_ += sizeof(T);
    return true;
  }
  bool get_text(std::string& text) {
    std::uint32_t length = 0;
    if (!get(length) || length > left()) return false;
    text.assign(as_text(data_.subspan(at_, length)));
    at_ += length;
    // CDR counts the closing NUL.
    if (!text.empty() && text.back() == '\0') text.pop_back();
    return true;
  }
  bool skip(std::size_t count) {
    if (count > left()) return false;
    at_ += count;
    return true;
  }
  std::size_t left() const { return data_.size() - std::min(at_, data_.size()); }
  bool take_value() { return ++values_ <= kMostValues; }

 private:
  Bytes data_;
  bool aligned_, swapped_;
  std::size_t at_ = 0, values_ = 0;
};

class RosDecoder : public MessageDecoder {
 public:
  RosDecoder(RosDefinition definition, bool cdr) : definition_(std::move(definition)), cdr_(cdr) {}

  bool decode(Bytes data, Json& out) override {
    if (data.size() > kLargestDecoded) return false;
    bool swapped = false;
    if (cdr_) {
      // 00 00 big-endian, 00 01 little-endian plain CDR; parameter lists and version 2 are other layouts.
      if (data.size() < 4 || data[0] != 0 || data[1] > 1) return false;
      swapped = data[1] == 0;
      data = data.subspan(4);
    }
    RosReader reader(data, cdr_, swapped);
    return structure(reader, definition_.structures.front(), out);
  }

 private:
  bool structure(RosReader& reader, const RosStructure& type, Json& out) const {
    out = Json::object();
    // ROS 2 gives an empty structure one byte.
    if (type.fields.empty()) return !cdr_ || reader.skip(1);
    for (const auto& field : type.fields)
      if (!(field.is_array ? array(reader, field, out[field.name]) : value(reader, field, out[field.name]))) return false;
    return true;
  }

  bool array(RosReader& reader, const RosField& field, Json& out) const {
    std::uint32_t count = field.length.value_or(0);
    if (!field.length && !reader.get(count)) return false;
    // Every element of a sequence takes a byte at least, but for empty structures of ROS 1.
    if (count > reader.left() && count > 0) return false;
    if (field.type == RosType::uint8 || field.type == RosType::int8) {
      out = nullptr;  // raw bytes
      return reader.skip(count);
    }
    out = Json::array();
    for (std::uint32_t i = 0; i < count; ++i) {
      out.push_back(nullptr);
      if (!value(reader, field, out.back())) return false;
    }
    return true;
  }

  template <class T>
  static bool number(RosReader& reader, Json& out) {
    T read{};
    if (!reader.get(read)) return false;
    out = read;
    return true;
  }

  static bool time(RosReader& reader, Json& out) {
    std::int32_t sec = 0;
    std::uint32_t nanosec = 0;
    if (!reader.get(sec) || !reader.get(nanosec)) return false;
    out = {{"sec", sec}, {"nanosec", nanosec}};
    return true;
  }

  static bool text(RosReader& reader, Json& out) {
    std::string read;
    if (!reader.get_text(read)) return false;
    out = std::move(read);
    return true;
  }

  bool value(RosReader& reader, const RosField& field, Json& out) const {
    if (!reader.take_value()) return false;
    switch (field.type) {
      case RosType::boolean:
      case RosType::uint8:
        return number<std::uint8_t>(reader, out);
      case RosType::int8:
        return number<std::int8_t>(reader, out);
      case RosType::int16:
        return number<std::int16_t>(reader, out);
      case RosType::uint16:
        return number<std::uint16_t>(reader, out);
      case RosType::int32:
        return number<std::int32_t>(reader, out);
      case RosType::uint32:
        return number<std::uint32_t>(reader, out);
      case RosType::int64:
        return number<std::int64_t>(reader, out);
      case RosType::uint64:
        return number<std::uint64_t>(reader, out);
      case RosType::float32:
        return number<float>(reader, out);
      case RosType::float64:
        return number<double>(reader, out);
      case RosType::text:
        return text(reader, out);
      case RosType::time:
        return time(reader, out);
      case RosType::structure:
        return structure(reader, definition_.structures[field.structure], out);
    }
    return false;
  }

  RosDefinition definition_;
  bool cdr_;
};

}  // namespace

std::unique_ptr<MessageDecoder> ros_decoder(const mcap::KnownSchema& schema, bool cdr) {
  auto definition = parse_ros_definition(schema.name, as_text(schema.data));
  if (!definition) return nullptr;
  return std::make_unique<RosDecoder>(std::move(*definition), cdr);
}

}  // namespace quadsonde::ingest
