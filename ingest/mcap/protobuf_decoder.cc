#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/descriptor_database.h>
#include <google/protobuf/dynamic_message.h>

#include "ingest/mcap/message_decoder.h"

namespace quadsonde::ingest {
namespace {

namespace pb = google::protobuf;
using pb::FieldDescriptor;

/// A schema with more fields than this in one message is not one of a flight.
constexpr int kMostFields = 500;

Json tree_of(const pb::Message& message);

/// One value; index -1 for a field that is not repeated.
Json value_of(const pb::Message& m, const FieldDescriptor& f, int index) {
  const auto& r = *m.GetReflection();
  const bool many = index >= 0;
  switch (f.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return many ? r.GetRepeatedDouble(m, &f, index) : r.GetDouble(m, &f);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return many ? r.GetRepeatedFloat(m, &f, index) : r.GetFloat(m, &f);
    case FieldDescriptor::CPPTYPE_INT32:
      return many ? r.GetRepeatedInt32(m, &f, index) : r.GetInt32(m, &f);
    case FieldDescriptor::CPPTYPE_UINT32:
      return many ? r.GetRepeatedUInt32(m, &f, index) : r.GetUInt32(m, &f);
    case FieldDescriptor::CPPTYPE_INT64:
      return many ? r.GetRepeatedInt64(m, &f, index) : r.GetInt64(m, &f);
    case FieldDescriptor::CPPTYPE_UINT64:
      return many ? r.GetRepeatedUInt64(m, &f, index) : r.GetUInt64(m, &f);
    case FieldDescriptor::CPPTYPE_BOOL:
      return many ? r.GetRepeatedBool(m, &f, index) : r.GetBool(m, &f);
    case FieldDescriptor::CPPTYPE_ENUM:
      return many ? r.GetRepeatedEnumValue(m, &f, index) : r.GetEnumValue(m, &f);
    case FieldDescriptor::CPPTYPE_STRING:
      if (f.type() == FieldDescriptor::TYPE_BYTES) return nullptr;
      return many ? r.GetRepeatedString(m, &f, index) : r.GetString(m, &f);
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return tree_of(many ? r.GetRepeatedMessage(m, &f, index) : r.GetMessage(m, &f));
  }
  return nullptr;
}

/// Scalars without presence are there with their default, as proto3 leaves out zeros; unset messages and optional
/// fields are not there.
Json tree_of(const pb::Message& message) {
  Json tree = Json::object();
  const auto& descriptor = *message.GetDescriptor();
  const auto& reflection = *message.GetReflection();
  for (int i = 0; i < descriptor.field_count() && i < kMostFields; ++i) {
    const auto& field = *descriptor.field(i);
    if (field.is_repeated()) {
      Json list = Json::array();
      const int size = reflection.FieldSize(message, &field);
      for (int k = 0; k < size; ++k) list.push_back(value_of(message, field, k));
      tree[field.name()] = std::move(list);
    } else if (!field.has_presence() || reflection.HasField(message, &field)) {
      tree[field.name()] = value_of(message, field, -1);
    }
  }
  return tree;
}

class ProtobufDecoder : public MessageDecoder {
 public:
  /// False if the schema's data is no FileDescriptorSet with a message of its name.
  bool prepare(const mcap::KnownSchema& schema) {
    pb::FileDescriptorSet set;
    if (schema.data.size() > std::size_t{INT32_MAX} ||
        !set.ParseFromArray(schema.data.data(), static_cast<int>(schema.data.size())))
      return false;
    for (const auto& file : set.file())
      if (!database_.Add(file)) return false;
    const auto* descriptor = pool_.FindMessageTypeByName(schema.name);
    if (!descriptor) return false;
    message_.reset(factory_.GetPrototype(descriptor)->New());
    return true;
  }

  bool decode(Bytes data, Json& out) override {
    if (data.size() > kLargestDecoded || !message_->ParseFromArray(data.data(), static_cast<int>(data.size())))
      return false;
    out = tree_of(*message_);
    return true;
  }

 private:
  // In the order of need: the message goes before the factory, the factory before the pool.
  pb::SimpleDescriptorDatabase database_;
  pb::DescriptorPool pool_{&database_};
  pb::DynamicMessageFactory factory_{&pool_};
  std::unique_ptr<pb::Message> message_;
};

}  // namespace

std::unique_ptr<MessageDecoder> protobuf_decoder(const mcap::KnownSchema& schema) {
  auto decoder = std::make_unique<ProtobufDecoder>();
  if (!decoder->prepare(schema)) return nullptr;
  return decoder;
}

}  // namespace quadsonde::ingest
