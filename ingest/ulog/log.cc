// What a read log answers.
#include "ingest/ulog/container.h"

namespace quadsonde::ingest::ulog {

std::optional<double> Value::number() const {
  const auto data = as_bytes(bytes);
  if (type == "float" && bytes.size() >= 4) return static_cast<double>(load<float>(data.data()));
  if (type == "int32_t" && bytes.size() >= 4) return load<std::int32_t>(data.data());
  if (type == "uint32_t" && bytes.size() >= 4) return load<std::uint32_t>(data.data());
  if (type == "double" && bytes.size() >= 8) return load<double>(data.data());
  if (type == "uint64_t" && bytes.size() >= 8) return static_cast<double>(load<std::uint64_t>(data.data()));
  if (type == "int64_t" && bytes.size() >= 8) return static_cast<double>(load<std::int64_t>(data.data()));
  if ((type == "uint8_t" || type == "bool") && !bytes.empty()) return data[0];
  return std::nullopt;
}

Bytes Log::payload_at(std::uint64_t at) const {
  // The head in front of it was checked when it was read: size u16, type u8, id u16.
  const auto size = load<std::uint16_t>(bytes.data() + at - 5);
  return bytes.subspan(static_cast<std::size_t>(at), size - 2U);
}

std::optional<double> Log::parameter(std::string_view name) const {
  std::optional<double> value;
  for (const auto& p : parameters)
    if (p.name == name) value = p.value.number();
  return value;
}

std::string Log::info_text(std::string_view name) const {
  const auto found = info.find(name);
  if (found == info.end() || found->second.type.substr(0, 4) != "char") return {};
  auto text = found->second.bytes;
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

}  // namespace quadsonde::ingest::ulog
