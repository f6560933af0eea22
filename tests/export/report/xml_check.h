#pragma once
// Whether a text is well-formed XML, as far as our own pictures go: tags nest, attributes are quoted, no bare < & in
// text, entities are the five of XML or numbers.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadsonde::support {

/// What is wrong, or nothing.
inline std::optional<std::string> xml_fault(std::string_view text) {
  std::vector<std::string> open;
  const auto entity_ok = [&](std::size_t at) {
    const auto end = text.find(';', at);
    if (end == std::string_view::npos || end - at > 8) return false;
    const auto name = text.substr(at + 1, end - at - 1);
    return name == "amp" || name == "lt" || name == "gt" || name == "quot" || name == "apos" || name.starts_with('#');
  };
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '&' && !entity_ok(i)) return "bare & at " + std::to_string(i);
    if (text[i] != '<') {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    bool quoted = false;
    for (; end < text.size() && (quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') quoted = !quoted;
      if (text[end] == '<') return "< inside a tag at " + std::to_string(end);
      if (text[end] == '&' && !entity_ok(end)) return "bare & at " + std::to_string(end);
    }
    if (end >= text.size()) return "a tag that never ends at " + std::to_string(i);
    auto tag = std::string(text.substr(i + 1, end - i - 1));
    i = end + 1;
    if (tag.starts_with('!')) continue;
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return "closes what is not open: " + tag;
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(tag.substr(0, tag.find_first_of(" \n")));
    }
  }
  return open.empty() ? std::nullopt : std::optional("never closed: " + open.back());
}

}  // namespace quadsonde::support
