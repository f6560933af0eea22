#pragma once
// Reading TOML with words for what is missing or of the wrong type. One Problem, the first one met, is kept.
#include <fmt/format.h>

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::ingest {

/// A table being read: every key asked for is remembered, so that leftover() can name the ones nobody knows.
class TomlFields {
 public:
  TomlFields(const toml::table& table, std::string path, const std::string& file, std::optional<Problem>& problem)
      : table_(table), path_(std::move(path)), file_(file), problem_(problem) {}

  std::optional<double> number(std::string_view key, double low = -1e300, double high = 1e300) {
    const auto* node = find(key);
    if (!node) return std::nullopt;
    const auto value = node->value<double>();
    if (!value || !(*value >= low && *value <= high)) {
      complain(key, fmt::format("expected a number from {} to {}", low, high), node);
      return std::nullopt;
    }
    return value;
  }
  /// As number and text, but a missing key leaves `into` as it is.
  void set(std::string_view key, double& into, double low = -1e300, double high = 1e300) {
    if (const auto value = number(key, low, high)) into = *value;
  }
  std::optional<std::string> text(std::string_view key) {
    const auto* node = find(key);
    if (!node) return std::nullopt;
    const auto value = node->value<std::string>();
    if (!value) complain(key, "expected a text in quotes", node);
    return value;
  }
  void set(std::string_view key, std::string& into) {
    if (auto value = text(key)) into = std::move(*value);
  }
  void set(std::string_view key, bool& into) {
    const auto* node = find(key);
    if (!node) return;
    if (const auto* value = node->as_boolean())
      into = value->get();
    else
      complain(key, "expected true or false", node);
  }
  /// Numbers of an array; nothing if the key is absent; a complaint if it is not one of `count` (0 = any) numbers.
  std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count = 0) {
    const auto* node = find(key);
    if (!node) return std::nullopt;
    std::vector<double> values;
    if (const auto* array = node->as_array())
      for (const auto& element : *array)
        if (const auto value = element.value<double>()) values.push_back(*value);
    const auto* array = node->as_array();
    if (!array || array->size() != values.size() || (count && values.size() != count)) {
      complain(key, count ? fmt::format("expected {} numbers in brackets", count) : "expected numbers in brackets", node);
      return std::nullopt;
    }
    return values;
  }
  /// A sub-table, or an empty one.
  TomlFields table(std::string_view key) {
    static const toml::table empty;
    const auto* node = find(key);
    if (node && !node->is_table()) complain(key, "expected a table", node);
    return {node && node->is_table() ? *node->as_table() : empty, path_ + std::string(key) + ".", file_, problem_};
  }
  /// The tables of an array of tables.
  std::vector<TomlFields> tables(std::string_view key) {
    std::vector<TomlFields> all;
    const auto* node = find(key);
    if (!node) return all;
    const auto* array = node->as_array();
    if (!array) complain(key, fmt::format("expected [[{}]] tables", key), node);
    if (!array) return all;
    for (const auto& element : *array) {
      if (const auto* part = element.as_table())
        all.emplace_back(*part, fmt::format("{}{}[{}].", path_, std::string(key), all.size()), file_, problem_);
      else
        complain(key, "expected a table", &element);
    }
    return all;
  }
  const toml::node* find(std::string_view key) {
    known_.insert(std::string(key));
    return table_.get(key);
  }
  bool has(std::string_view key) { return find(key) != nullptr; }
  /// Complains about keys that nobody asked for: a misspelt key must not be ignored silently.
  void leftover() {
    for (const auto& [key, node] : table_)
      if (!known_.count(std::string(key.str()))) complain(key.str(), "is not a key that is known here", &node);
  }
  void complain(std::string_view key, std::string what, const toml::node* node = nullptr) {
    if (problem_) return;
    Where where{file_, {}, {}, path_ + std::string(key)};
    if (node && node->source().begin.line) where.line = node->source().begin.line;
    problem_ = Problem{Kind::usage, std::move(what), where, "correct the file and run again"};
  }

 private:
  const toml::table& table_;
  std::string path_;
  const std::string& file_;
  std::optional<Problem>& problem_;
  std::set<std::string> known_;
};

/// Parses TOML text; what toml++ throws ends here.
inline Result<toml::table> parse_toml(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    Where where{file, {}, error.source().begin.line, {}};
    return fail(Kind::usage, std::string(error.description()), where, "correct the TOML and run again");
  }
}

/// A TOML string literal, escaped.
inline std::string toml_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (u < 0x20 || u == 0x7f)
      out += fmt::format("\\u{:04X}", u);
    else
      out += c;
  }
  return out + "\"";
}

}  // namespace quadsonde::ingest
