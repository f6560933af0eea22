#pragma once
// Reading numbers out of bytes that nobody vouches for.
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace quadsonde::ingest {

using Bytes = std::span<const std::uint8_t>;
static_assert(std::endian::native == std::endian::little, "the readers copy little-endian numbers as they stand");

/// A little-endian number at an offset that the caller has checked.
template <class T>
  requires std::is_trivially_copyable_v<T>
inline T load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

/// A forward cursor over bytes: each get says whether the bytes were there, and moves only if they were.
class Cursor {
 public:
  explicit Cursor(Bytes bytes, std::size_t at = 0) : bytes_(bytes), at_(at < bytes.size() ? at : bytes.size()) {}
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  template <class T>
  bool get(T& value) {
    if (left() < sizeof(T)) return false;
    value = load<T>(bytes_.data() + at_);
    at_ += sizeof(T);
    return true;
  }
  bool get_bytes(std::uint64_t count, Bytes& out) {
    if (left() < count) return false;
    out = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return true;
  }
  bool skip(std::uint64_t count) {
    Bytes ignored;
    return get_bytes(count, ignored);
  }

 private:
  Bytes bytes_;
  std::size_t at_;
};

inline std::string_view as_text(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
inline Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace quadsonde::ingest
