#include "ingest/mcap/own_schema.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <nlohmann/json.hpp>
#include <algorithm>
#include <set>

namespace quadsonde::ingest::own {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;
using Json = nlohmann::ordered_json;

/// A file after the files it imports.
void add_file(const FileDescriptor& file, std::set<std::string>& seen, google::protobuf::FileDescriptorSet& set) {
  if (!seen.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), seen, set);
  file.CopyTo(set.add_file());
}

Json object_schema(const Descriptor& message);

Json value_schema(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT:
      return {{"oneOf", {{{"type", "number"}}, {{"enum", {"NaN", "Infinity", "-Infinity"}}}}}};
    case FieldDescriptor::CPPTYPE_BOOL:
      return {{"type", "boolean"}};
    case FieldDescriptor::CPPTYPE_INT32:
    case FieldDescriptor::CPPTYPE_UINT32:
      return {{"type", "integer"}};
    case FieldDescriptor::CPPTYPE_MESSAGE:
      // proto3 JSON writes a Timestamp as one text.
      if (field.message_type()->full_name() == "google.protobuf.Timestamp") return {{"type", "string"}};
      return object_schema(*field.message_type());
    default:
      return {{"type", "string"}};  // texts, names of enums, 64-bit integers
  }
}

Json object_schema(const Descriptor& message) {
  Json properties = Json::object();
  for (int i = 0; i < message.field_count(); ++i) {
    const auto& field = *message.field(i);
    auto value = value_schema(field);
    properties[field.name()] = field.is_repeated() ? Json{{"type", "array"}, {"items", value}} : value;
  }
  return {{"type", "object"}, {"properties", properties}};
}

template <class T, std::size_t N>
struct Words {
  std::pair<T, std::string_view> all[N];
  std::string_view of(T value) const {
    for (const auto& [known, word] : all)
      if (known == value) return word;
    return "";
  }
  std::optional<T> named(std::string_view name) const {
    for (const auto& [value, word] : all)
      if (word == name) return value;
    return std::nullopt;
  }
};

constexpr Words<Airframe, 6> kAirframes{{{Airframe::unknown, "unknown"},
                                         {Airframe::multirotor, "multirotor"},
                                         {Airframe::helicopter, "helicopter"},
                                         {Airframe::fixed_wing, "fixed_wing"},
                                         {Airframe::vtol, "vtol"},
                                         {Airframe::other, "other"}}};
constexpr Words<VelocityOrigin, 3> kOrigins{{{VelocityOrigin::receiver, "receiver"},
                                             {VelocityOrigin::fused, "fused"},
                                             {VelocityOrigin::differentiated, "differentiated"}}};
constexpr Words<Kind, 12> kKinds{{{Kind::usage, "usage"},
                                  {Kind::unreadable, "unreadable"},
                                  {Kind::not_a_log, "not_a_log"},
                                  {Kind::unsupported, "unsupported"},
                                  {Kind::truncated, "truncated"},
                                  {Kind::damaged, "damaged"},
                                  {Kind::missing, "missing"},
                                  {Kind::doubtful, "doubtful"},
                                  {Kind::inconsistent, "inconsistent"},
                                  {Kind::limit, "limit"},
                                  {Kind::no_answer, "no_answer"},
                                  {Kind::write_failed, "write_failed"}}};

/// Length of the UTF-8 character at the front; 0 if there is none. Source: Unicode 15, table 3-7.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return byte(i) >= low && byte(i) <= high;
  };
  const auto first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF)
    return follows(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF) && follows(2) ? 3 : 0;
  if (first >= 0xF0 && first <= 0xF4)
    return follows(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF) && follows(2) && follows(3) ? 4 : 0;
  return 0;
}

}  // namespace

std::string_view name_of(Airframe airframe) { return kAirframes.of(airframe); }
std::string_view name_of(VelocityOrigin origin) { return kOrigins.of(origin); }
std::string_view name_of(Kind kind) { return kKinds.of(kind); }
std::optional<Airframe> airframe_named(std::string_view name) { return kAirframes.named(name); }
std::optional<VelocityOrigin> velocity_origin_named(std::string_view name) { return kOrigins.named(name); }
std::optional<Kind> kind_named(std::string_view name) { return kKinds.named(name); }

std::string utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto length = character_length(text);
    out.append(length ? text.substr(0, length) : "?");
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string descriptor_set(const Descriptor& message) {
  google::protobuf::FileDescriptorSet set;
  std::set<std::string> seen;
  add_file(*message.file(), seen, set);
  return set.SerializeAsString();
}

std::string json_schema(const Descriptor& message) {
  auto schema = object_schema(message);
  schema["title"] = message.full_name();
  return schema.dump();
}

}  // namespace quadsonde::ingest::own
