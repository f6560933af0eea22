#include "export/bufr/bufr_decoder.h"

#include <eccodes.h>

#include <cstring>

#include "export/bufr/bufr_message.h"
#include "export/isolated.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

constexpr std::size_t most_values = 4'000'000;

/// Runs in the child.
class Decoder {
 public:
  explicit Decoder(ingest::Bytes message)
      : handle_(codes_handle_new_from_message(nullptr, message.data(), message.size())) {}

  /// "E" and why not, or "D" and the content.
  std::string answer() {
    if (!handle_) return "Ethey are no BUFR message for ecCodes";
    if (const int status = codes_set_long(handle_, "unpack", 1); status != CODES_SUCCESS)
      return std::string("E") + codes_get_error_message(status);
    auto* keys = codes_bufr_keys_iterator_new(handle_, 0);
    if (!keys) return "Eits elements cannot be listed";
    while (codes_bufr_keys_iterator_next(keys)) {
      const char* key = codes_bufr_keys_iterator_get_name(keys);
      if (!key || std::strstr(key, "->")) continue;
      if (!take(key)) return "Eit has more values than anybody could look at";
    }
    return "D" + pack(content_);
  }

 private:
  bool take(const std::string& key) {
    long code = 0;
    // Keys of the header have no code: they stand in sections 0 to 3.
    if (codes_get_long(handle_, (key + "->code").c_str(), &code) != CODES_SUCCESS) return true;
    BufrValues element;
    element.code = static_cast<int>(code);
    int type = 0;
    codes_get_native_type(handle_, key.c_str(), &type);
    if (type == CODES_TYPE_STRING) {
      int error = 0;
      element.is_text = true;
      element.text_missing = codes_is_missing(handle_, key.c_str(), &error) != 0;
      content_.push_back(std::move(element));
      return true;
    }
    std::size_t count = 0;
    if (codes_get_size(handle_, key.c_str(), &count) != CODES_SUCCESS) return true;
    if (count > most_values - values_) return false;
    values_ += count;
    std::vector<double> values(count);
    if (count && codes_get_double_array(handle_, key.c_str(), values.data(), &count) != CODES_SUCCESS) return true;
    for (const double value : values) {
      const bool missing = value == CODES_MISSING_DOUBLE || value == CODES_MISSING_LONG;
      element.values.push_back(missing ? std::nullopt : std::optional(value));
    }
    content_.push_back(std::move(element));
    return true;
  }

  codes_handle* handle_;
  BufrContent content_;
  std::size_t values_ = 0;
};

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
bool get(std::string_view& bytes, T& value) {
  if (bytes.size() < sizeof value) return false;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return true;
}

}  // namespace

std::string pack(const BufrContent& content) {
  std::string bytes;
  for (const auto& e : content) {
    put(bytes, static_cast<std::int32_t>(e.code));
    put(bytes, static_cast<std::uint8_t>((e.is_text ? 1 : 0) + (e.text_missing ? 2 : 0)));
    put(bytes, static_cast<std::uint64_t>(e.values.size()));
    for (const auto& value : e.values)
      put(bytes, static_cast<std::uint8_t>(value.has_value())), put(bytes, value.value_or(0));
  }
  return bytes;
}

std::optional<BufrContent> unpack_content(std::string_view packed) {
  BufrContent content;
  while (!packed.empty()) {
    std::int32_t code = 0;
    std::uint8_t bits = 0;
    std::uint64_t count = 0;
    if (!get(packed, code) || !get(packed, bits) || !get(packed, count)) return std::nullopt;
    if (bits > 3 || count > packed.size() / (1 + sizeof(double))) return std::nullopt;
    BufrValues element{code, (bits & 1) != 0, (bits & 2) != 0, {}};
    for (std::uint64_t i = 0; i < count; ++i) {
      std::uint8_t there = 0;
      double value = 0;
      if (!get(packed, there) || !get(packed, value)) return std::nullopt;
      element.values.push_back(there ? std::optional(value) : std::nullopt);
    }
    content.push_back(std::move(element));
  }
  return content;
}

ingest::Result<BufrContent> decode_bufr(ingest::Bytes message) {
  const auto lock = lock_eccodes();
  const auto answer = isolated([&] {
    silence_eccodes();
    return Decoder(message).answer();
  });
  if (!answer) return fail(answer.error());
  if (!answer->starts_with("D")) return fail(Kind::damaged, "ecCodes says: " + answer->substr(1));
  auto content = unpack_content(std::string_view(*answer).substr(1));
  if (!content) return fail(Kind::damaged, "the library that decodes it fails on it");
  return std::move(*content);
}

}  // namespace quadsonde::product
