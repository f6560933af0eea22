// Types of the definition section: parsing, sizes, and the way from a path to a place in the payload.
#include "ingest/ulog/format.h"

#include <charconv>
#include <cmath>

#include "ingest/ulog/container.h"

namespace quadsonde::ingest::ulog {
namespace {

constexpr int max_depth = 16;
/// A message holds at most 65535 bytes, so no sound type is larger.
constexpr std::uint64_t max_size = 65535;

std::optional<Scalar> scalar(std::string_view type) {
  static constexpr std::pair<std::string_view, Scalar> names[] = {
      {"float", Scalar::real32},  {"uint64_t", Scalar::uint64}, {"uint8_t", Scalar::uint8},
      {"bool", Scalar::boolean},  {"int32_t", Scalar::int32},   {"uint32_t", Scalar::uint32},
      {"double", Scalar::real64}, {"uint16_t", Scalar::uint16}, {"int16_t", Scalar::int16},
      {"int8_t", Scalar::int8},   {"int64_t", Scalar::int64},   {"char", Scalar::uint8}};
  for (const auto& [name, value] : names)
    if (name == type) return value;
  return std::nullopt;
}

/// Size of one element of a type; empty if it is not defined, circular or larger than any message.
/// `budget` bounds the work that hostile definitions can ask for.
std::optional<std::uint64_t> type_size(const Formats& formats, std::string_view type, int depth, int& budget) {
  if (const auto s = scalar(type)) return size_of(*s);
  const auto format = formats.find(type);
  if (format == formats.end() || depth >= max_depth) return std::nullopt;
  std::uint64_t total = 0;
  for (const auto& field : format->second.fields) {
    if (--budget < 0) return std::nullopt;
    const auto one = type_size(formats, field.type, depth + 1, budget);
    if (!one) return std::nullopt;
    total += *one * field.count;
    if (total > max_size) return std::nullopt;
  }
  return total;
}

/// Splits "esc[3]" into name and index.
bool split_index(std::string_view part, std::string_view& name, std::optional<std::uint32_t>& index) {
  const auto open = part.find('[');
  name = part.substr(0, open);
  index.reset();
  if (open == std::string_view::npos) return true;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(part.data() + open + 1, part.data() + part.size(), value);
  if (error != std::errc() || end + 1 != part.data() + part.size() || *end != ']') return false;
  index = value;
  return true;
}

}  // namespace

std::uint32_t size_of(Scalar type) {
  switch (type) {
    case Scalar::int8:
    case Scalar::uint8:
    case Scalar::boolean:
      return 1;
    case Scalar::int16:
    case Scalar::uint16:
      return 2;
    case Scalar::int32:
    case Scalar::uint32:
    case Scalar::real32:
      return 4;
    case Scalar::int64:
    case Scalar::uint64:
    case Scalar::real64:
      return 8;
  }
  return 1;
}

std::optional<Format> parse_format(std::string_view text) {
  const auto colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  Format format;
  format.name = std::string(text.substr(0, colon));
  text.remove_prefix(colon + 1);
  while (!text.empty()) {
    const auto end = text.find(';');
    const auto item = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (item.empty()) continue;
    const auto field = parse_typed_name(item);
    if (!field) return std::nullopt;
    format.fields.push_back(*field);
  }
  return format;
}

std::optional<Field> parse_typed_name(std::string_view text) {
  const auto blank = text.find(' ');
  if (blank == std::string_view::npos || blank == 0 || blank + 1 == text.size()) return std::nullopt;
  Field field;
  field.name = std::string(text.substr(blank + 1));
  std::string_view type;
  std::optional<std::uint32_t> count;
  if (!split_index(text.substr(0, blank), type, count) || type.empty()) return std::nullopt;
  if (count && *count > max_size) return std::nullopt;
  field.type = std::string(type);
  field.array = count.has_value();
  field.count = count.value_or(1);
  return field;
}

std::optional<std::uint64_t> format_size(const Formats& formats, std::string_view name) {
  int budget = 10000;
  return type_size(formats, name, 0, budget);
}

std::optional<Column> find_column(const Formats& formats, std::string_view format, std::string_view path) {
  std::uint64_t offset = 0;
  int budget = 10000;
  for (int depth = 0; depth < max_depth; ++depth) {
    const auto dot = path.find('.');
    std::string_view name;
    std::optional<std::uint32_t> index;
    const auto of_type = formats.find(format);
    if (of_type == formats.end() || !split_index(path.substr(0, dot), name, index)) return std::nullopt;
    const Field* found = nullptr;
    for (const auto& field : of_type->second.fields) {
      const auto one = type_size(formats, field.type, 0, budget);
      if (!one) return std::nullopt;
      if (field.name == name && index.value_or(0) < field.count && (index || !field.array)) {
        offset += *one * index.value_or(0);
        found = &field;
        break;
      }
      offset += *one * field.count;
    }
    if (!found || offset > max_size) return std::nullopt;
    if (dot == std::string_view::npos) {
      const auto type = scalar(found->type);
      if (!type) return std::nullopt;
      return Column{*type, static_cast<std::uint32_t>(offset)};
    }
    format = found->type;
    path.remove_prefix(dot + 1);
  }
  return std::nullopt;
}

std::optional<double> number(Bytes payload, Column column) {
  if (payload.size() < std::size_t{column.offset} + size_of(column.type)) return std::nullopt;
  const auto* at = payload.data() + column.offset;
  switch (column.type) {
    case Scalar::int8:
      return load<std::int8_t>(at);
    case Scalar::uint8:
      return load<std::uint8_t>(at);
    case Scalar::boolean:
      return *at != 0 ? 1.0 : 0.0;
    case Scalar::int16:
      return load<std::int16_t>(at);
    case Scalar::uint16:
      return load<std::uint16_t>(at);
    case Scalar::int32:
      return load<std::int32_t>(at);
    case Scalar::uint32:
      return load<std::uint32_t>(at);
    case Scalar::real32:
      return static_cast<double>(load<float>(at));
    case Scalar::int64:
      return static_cast<double>(load<std::int64_t>(at));
    case Scalar::uint64:
      return static_cast<double>(load<std::uint64_t>(at));
    case Scalar::real64:
      return load<double>(at);
  }
  return std::nullopt;
}

std::optional<std::int64_t> integer(Bytes payload, Column column) {
  if (column.type == Scalar::uint64 || column.type == Scalar::int64) {
    if (payload.size() < std::size_t{column.offset} + 8) return std::nullopt;
    return load<std::int64_t>(payload.data() + column.offset);
  }
  const auto value = number(payload, column);
  if (!value || !(std::abs(*value) < 9e18)) return std::nullopt;
  return static_cast<std::int64_t>(*value);
}

}  // namespace quadsonde::ingest::ulog
