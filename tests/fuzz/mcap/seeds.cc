#include "tests/fuzz/mcap/seeds.h"

#include <google/protobuf/descriptor.pb.h>

#include "export/mcap/flight_to_mcap.h"
#include "ingest/mcap/writer.h"

namespace quadsonde::fuzz {
namespace {

using namespace ingest::mcap;  // NOLINT: a test
using ingest::as_bytes;

using Seed = std::pair<std::string, std::vector<std::uint8_t>>;

/// Two topics, messages out of order, an attachment and metadata.
Seed plain(const std::string& name, WriterSettings settings) {
  MemorySink sink;
  settings.chunk_size = 150;
  Writer writer(sink, settings);
  const auto schema = *writer.add_schema("a/B", "ros2msg", as_bytes("float64[] x\nstring s\n"));
  const auto one = *writer.add_channel(schema, "/one", "cdr");
  const auto two = *writer.add_channel(0, "/two", "json", {{"k", "v"}});
  const std::string cdr("\0\1\0\0\0\0\0\0\0\0\0\0", 12);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint64_t time = 100 + 10 * (i ^ 1);
    (void)writer.write({i % 2 ? two : one, i, time, time, as_bytes(i % 2 ? R"({"vn":1,"ve":2,"vd":3})" : cdr)});
    if (i == 3) (void)writer.add_metadata("m", {{"a", "b"}});
  }
  (void)writer.attach(1, 2, "n", "t", as_bytes("data"));
  (void)writer.close();
  return {name, sink.bytes()};
}

Seed flight(const std::string& name, product::FlightFileSettings settings) {
  ingest::Flight f;
  f.clock.utc_minus_log = ingest::Duration(1'700'000'000'000'000'000);
  for (int i = 0; i < 3; ++i) {
    const ingest::LogTime t{1'000'000LL * i};
    f.attitude.push(t, Eigen::Quaterniond(1, 0, 0, 0));
    f.velocity.push(t, {1, 2, 3});
    f.position.push(t, {47, 8});
  }
  f.events.push({0}, {ingest::Event::What::text, "e"});
  f.problems.push_back({ingest::Kind::doubtful, "w", {}, ""});
  settings.compression = product::FlightFileSettings::Compression::none;
  MemorySink sink;
  (void)product::write_flight(sink, f, settings, {{{5}, {1}, {1, 2, 3}}});
  return {name, sink.bytes()};
}

Seed schema_seed(const std::string& name, std::uint8_t encoding, const std::string& schema, const std::string& message) {
  std::vector<std::uint8_t> bytes{encoding, 0};
  bytes.insert(bytes.end(), schema.begin(), schema.end());
  bytes.insert(bytes.end(), message.begin(), message.end());
  bytes[1] = static_cast<std::uint8_t>((schema.size() * 255 + bytes.size() - 3) / (bytes.size() - 2));
  return {name, bytes};
}

/// package a; message B { double x = 1; repeated int32 y = 2; B b = 3; }
std::string small_descriptor_set() {
  using google::protobuf::FieldDescriptorProto;
  google::protobuf::FileDescriptorSet set;
  auto& file = *set.add_file();
  file.set_name("f");
  file.set_package("a");
  file.set_syntax("proto3");
  auto& message = *file.add_message_type();
  message.set_name("B");
  const auto field = [&](const char* name, int number, FieldDescriptorProto::Type type, FieldDescriptorProto::Label label) {
    auto& f = *message.add_field();
    f.set_name(name);
    f.set_number(number);
    f.set_type(type);
    f.set_label(label);
    if (type == FieldDescriptorProto::TYPE_MESSAGE) f.set_type_name(".a.B");
  };
  field("x", 1, FieldDescriptorProto::TYPE_DOUBLE, FieldDescriptorProto::LABEL_OPTIONAL);
  field("y", 2, FieldDescriptorProto::TYPE_INT32, FieldDescriptorProto::LABEL_REPEATED);
  field("b", 3, FieldDescriptorProto::TYPE_MESSAGE, FieldDescriptorProto::LABEL_OPTIONAL);
  return set.SerializeAsString();
}

}  // namespace

std::vector<Seed> mcap_seeds() {
  std::vector<Seed> seeds;
  WriterSettings settings;
  settings.compression = Compression::none;
  seeds.push_back(plain("chunked", settings));
  settings.chunk_crc = settings.data_crc = settings.summary_crc = false;
  seeds.push_back(plain("chunked_without_crc", settings));
  settings.compression = Compression::lz4;
  seeds.push_back(plain("lz4_without_crc", settings));
  settings.compression = Compression::zstd;
  seeds.push_back(plain("zstd_without_crc", settings));
  settings.chunked = false;
  seeds.push_back(plain("unchunked_without_crc", settings));
  product::FlightFileSettings flights;
  flights.viewer_topics = false;
  seeds.push_back(flight("flight", flights));
  flights.encoding = product::FlightFileSettings::Encoding::json;
  seeds.push_back(flight("flight_json", flights));
  seeds.push_back(schema_seed("schema_protobuf", 0, small_descriptor_set(), std::string("\x09\0\0\0\0\0\0\xf0\x3f\x12\x01\x05", 12)));
  seeds.push_back(schema_seed("schema_ros2", 1, "C[] c\nint32[2] d\n====\nMSG: a/C\nfloat64 x 1\nstring y\n", std::string("\0\1\0\0\0\0\0\0\1\0\0\0\2\0\0\0", 16)));
  seeds.push_back(schema_seed("schema_ros1", 2, "time t\nbool[] b\n", std::string("\1\0\0\0\2\0\0\0\1\0\0\0\1", 13)));
  seeds.push_back(schema_seed("schema_json", 3, "", R"({"a":[1,{"b":null}]})"));
  return seeds;
}

}  // namespace quadsonde::fuzz
