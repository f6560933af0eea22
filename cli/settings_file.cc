#include "cli/settings_file.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "ingest/motion/toml_fields.h"

namespace quadsonde::cli {
namespace {

using ingest::fail;
using ingest::Kind;

/// The value as a flag would have it; empty for what no flag takes.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* i = node.as_integer()) return fmt::format("{}", i->get());
  if (const auto* d = node.as_floating_point()) return fmt::format("{}", d->get());
  if (const auto* s = node.as_string()) return s->get();
  return std::nullopt;
}

std::string placed(const Option& option, const std::string& text, const std::filesystem::path& folder) {
  const bool word = text == "auto" || text.starts_with("class:") || text.empty();
  if (!option.is_path || word || std::filesystem::path(text).is_absolute()) return text;
  return (folder / text).string();
}

ingest::Result<void> apply(Option& option, const toml::node& node, const std::filesystem::path& file) {
  const auto complain = [&](const std::string& what) {
    return fail(Kind::usage, what, {file.string(), {}, node.source().begin.line, option.key},
                "correct the settings file and run again");
  };
  std::vector<const toml::node*> values;
  if (const auto* array = node.as_array(); array && option.repeats)
    for (const auto& element : *array) values.push_back(&element);
  else
    values.push_back(&node);
  for (const auto* value : values) {
    const auto text = text_of(*value);
    if (!text) return complain("expected a single value");
    if (const auto expected = option.set(placed(option, *text, file.parent_path()))) return complain(*expected);
  }
  return {};
}

}  // namespace

std::optional<std::filesystem::path> settings_beside(const std::filesystem::path& input) {
  const auto file = input.parent_path() / "quadsonde.toml";
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) return file;
  return std::nullopt;
}

ingest::Result<void> apply_settings_file(const std::filesystem::path& file, Options& options,
                                         const std::set<std::string>& known_elsewhere) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  if (!stream || std::filesystem::is_directory(file, error))
    return fail(Kind::usage, "the settings file cannot be opened", {file.string(), {}, {}, {}},
                "check the path given to --settings");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const auto table = ingest::parse_toml(text, file.string());
  if (!table) return fail(table.error());
  for (const auto& [name, node] : *table) {
    const auto key = key_of(name.str());
    auto* option = options.find(key);
    if (!option && known_elsewhere.count(key)) continue;
    if (!option)
      return fail(Kind::usage, "no verb knows this setting",
                  {file.string(), {}, node.source().begin.line, std::string(name.str())},
                  "see `quadsonde VERB --help` for the names");
    if (option->given) continue;
    if (auto applied = apply(*option, node, file); !applied) return applied;
  }
  return {};
}

}  // namespace quadsonde::cli
