#include "ingest/mcap/message_decoder.h"

#include <charconv>

namespace quadsonde::ingest {
namespace {

class JsonDecoder : public MessageDecoder {
 public:
  bool decode(Bytes data, Json& out) override {
    if (data.size() > kLargestDecoded) return false;
    out = Json::parse(as_text(data).begin(), as_text(data).end(), nullptr, false);
    return out.is_object();
  }
};

const Json* member(const Json* at, std::string_view name) {
  if (!at->is_object()) return nullptr;
  const auto found = at->find(name);
  return found == at->end() ? nullptr : &*found;
}

const Json* element(const Json* at, std::string_view digits) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  const bool usable = error == std::errc() && end == digits.data() + digits.size();
  return usable && at->is_array() && index < at->size() ? &(*at)[index] : nullptr;
}

}  // namespace

std::unique_ptr<MessageDecoder> decoder_for(const mcap::KnownChannel& channel, const mcap::KnownSchema* schema) {
  if (channel.message_encoding == "json") return std::make_unique<JsonDecoder>();
  if (!schema) return nullptr;
  if (channel.message_encoding == "protobuf" && schema->encoding == "protobuf") return protobuf_decoder(*schema);
  if (channel.message_encoding == "cdr" && schema->encoding == "ros2msg") return ros_decoder(*schema, true);
  if (channel.message_encoding == "ros1" && schema->encoding == "ros1msg") return ros_decoder(*schema, false);
  return nullptr;
}

const Json* value_at(const Json& message, std::string_view path) {
  const Json* at = &message;
  while (at && !path.empty()) {
    const auto end = std::min(path.find_first_of(".["), path.size());
    if (end > 0) at = member(at, path.substr(0, end));
    path.remove_prefix(end);
    if (at && path.starts_with('[')) {
      const auto close = path.find(']');
      if (close == path.npos) return nullptr;
      at = element(at, path.substr(1, close - 1));
      path.remove_prefix(close + 1);
    }
    if (path.starts_with('.')) path.remove_prefix(1);
  }
  return at;
}

std::optional<double> number_at(const Json& message, std::string_view path) {
  const auto* value = value_at(message, path);
  if (value && value->is_number()) return value->get<double>();
  if (value && value->is_boolean()) return value->get<bool>() ? 1.0 : 0.0;
  return std::nullopt;
}

}  // namespace quadsonde::ingest
