#include <cstring>

#include "export/cf_netcdf/describe.h"

namespace quadsonde::product {
namespace {

/// Bytes of numbers as they are (a NaN stays the NaN that it is), lengths before what they count. Child and parent are
/// one program on one machine.
class Packer {
 public:
  void number(std::uint64_t value) { raw(&value, sizeof value); }
  void text(const std::string& value) {
    number(value.size());
    bytes_ += value;
  }
  void texts(const std::vector<std::string>& values) {
    number(values.size());
    for (const auto& value : values) text(value);
  }
  void doubles(const std::vector<double>& values) {
    number(values.size());
    raw(values.data(), values.size() * sizeof(double));
  }
  void attributes(const std::vector<NcAttribute>& all) {
    number(all.size());
    for (const auto& a : all)
      text(a.name), number(static_cast<std::uint64_t>(a.type)), texts(a.texts), doubles(a.numbers);
  }
  std::string take() { return std::move(bytes_); }

 private:
  void raw(const void* at, std::size_t size) {
    if (size) bytes_.append(static_cast<const char*>(at), size);
  }
  std::string bytes_;
};

/// After the first length that does not fit everything is empty, and sound() is false.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : left_(bytes) {}
  bool sound() const { return sound_; }
  bool at_end() const { return left_.empty(); }

  std::uint64_t number() {
    std::uint64_t value = 0;
    if (const auto from = take(sizeof value); !from.empty()) std::memcpy(&value, from.data(), sizeof value);
    return value;
  }
  /// A number of things of at least so many bytes each.
  std::size_t count(std::size_t each) {
    const auto value = number();
    if (value <= left_.size() / each) return static_cast<std::size_t>(value);
    sound_ = false, left_ = {};
    return 0;
  }
  std::string text() { return std::string(take(count(1))); }
  std::vector<std::string> texts() {
    std::vector<std::string> all(count(8));
    for (auto& one : all) one = text();
    return all;
  }
  std::vector<double> doubles() {
    const auto n = count(8);
    const auto from = take(n * sizeof(double));
    std::vector<double> values(from.size() / sizeof(double));
    if (!values.empty()) std::memcpy(values.data(), from.data(), from.size());
    return values;
  }
  template <class Enum>
  Enum one_of(Enum last) {
    const auto value = number();
    if (value > static_cast<std::uint64_t>(last)) sound_ = false;
    return sound_ ? static_cast<Enum>(value) : last;
  }
  std::vector<NcAttribute> attributes() {
    std::vector<NcAttribute> all(count(32));
    for (auto& a : all) a.name = text(), a.type = one_of(NcType::other), a.texts = texts(), a.numbers = doubles();
    return all;
  }

 private:
  std::string_view take(std::size_t size) {
    if (size > left_.size()) {
      sound_ = false, left_ = {};
      return {};
    }
    const auto part = left_.substr(0, size);
    left_.remove_prefix(size);
    return part;
  }
  std::string_view left_;
  bool sound_ = true;
};

/// Whether the data of a variable are as many as its dimensions say.
bool fits(const NcDescription& d, const NcVariable& v) {
  if (v.data != NcData::all) return v.values.empty() && v.texts.empty();
  std::uint64_t count = 1;
  const bool characters = v.type == NcType::character;
  for (std::size_t i = 0; i < v.dimensions.size(); ++i) {
    const auto length = d.dimensions[v.dimensions[i]].length;
    if (characters && i + 1 == v.dimensions.size() && length) continue;
    if (length && count > (std::uint64_t{1} << 40) / length) return false;
    count *= length;
  }
  return (characters ? v.texts.size() : v.values.size()) == count;
}

}  // namespace

std::string pack(const NcDescription& d) {
  Packer p;
  p.text(d.format), p.number(d.groups);
  p.number(d.dimensions.size());
  for (const auto& dimension : d.dimensions)
    p.text(dimension.name), p.number(dimension.length), p.number(dimension.unlimited);
  p.attributes(d.attributes);
  p.number(d.variables.size());
  for (const auto& v : d.variables) {
    p.text(v.name), p.number(static_cast<std::uint64_t>(v.type)), p.number(v.dimensions.size());
    for (const auto dimension : v.dimensions) p.number(dimension);
    p.attributes(v.attributes);
    p.number(static_cast<std::uint64_t>(v.data)), p.doubles(v.values), p.texts(v.texts);
  }
  return p.take();
}

std::optional<NcDescription> unpack_description(std::string_view packed) {
  Unpacker u(packed);
  NcDescription d;
  d.format = u.text(), d.groups = static_cast<std::uint32_t>(u.number());
  d.dimensions.resize(u.count(24));
  for (auto& dimension : d.dimensions)
    dimension.name = u.text(), dimension.length = u.number(), dimension.unlimited = u.number() != 0;
  d.attributes = u.attributes();
  d.variables.resize(u.count(56));
  for (auto& v : d.variables) {
    v.name = u.text(), v.type = u.one_of(NcType::other);
    v.dimensions.resize(u.count(8));
    for (auto& dimension : v.dimensions) {
      const auto at = u.number();
      if (at >= d.dimensions.size()) return std::nullopt;
      dimension = static_cast<std::uint32_t>(at);
    }
    v.attributes = u.attributes();
    v.data = u.one_of(NcData::no_numbers), v.values = u.doubles(), v.texts = u.texts();
    if (!u.sound() || !fits(d, v)) return std::nullopt;
  }
  if (!u.sound() || !u.at_end()) return std::nullopt;
  return d;
}

}  // namespace quadsonde::product
