#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string facts_of(const char* name, const std::string& default_text, const std::string& range) {
  std::string text = unit_of(name);
  text += (text.empty() ? "" : "; ") + std::string("default ") + default_text;
  return range.empty() ? text : text + "; " + range;
}

std::string range_text(double low, double high) { return fmt::format("{} to {}", low, high); }

template <class Value>
auto number_setter(Value& value, double low, double high) {
  return [&value, low, high](const std::string& text) -> std::optional<std::string> {
    const auto read = number(text);
    if (!read || *read < low || *read > high) return fmt::format("expected a number from {} to {}", low, high);
    value = *read;
    return std::nullopt;
  };
}

}  // namespace

std::string unit_of(std::string_view name) {
  static constexpr std::pair<std::string_view, std::string_view> units[] = {
      {"_kg_m3", "kg/m3"}, {"_km", "km"}, {"_m_s", "m/s"}, {"_deg_s", "deg/s"}, {"_deg", "deg"},
      {"_kg", "kg"},       {"_msl", "m"},   {"_m", "m"},         {"_s", "s"}};
  for (const auto& [ending, unit] : units)
    if (name.ends_with(ending)) return std::string(unit);
  return "";
}

std::string flag_of(std::string_view key) {
  std::string flag = "--" + std::string(key);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

std::string key_of(std::string_view flag) {
  while (flag.starts_with('-')) flag.remove_prefix(1);
  std::string key(flag);
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

Option& Options::add(const char* name, const char* sentence) {
  Option option;
  option.key = name;
  option.flag = flag_of(name);
  option.sentence = sentence;
  options_.push_back(std::move(option));
  return options_.back();
}

void Options::operator()(const char* name, double& value, double low, double high, const char* sentence) {
  auto& option = add(name, sentence);
  option.placeholder = "NUMBER";
  option.facts = facts_of(name, fmt::format("{}", value), range_text(low, high));
  option.set = number_setter(value, low, high);
}

void Options::operator()(const char* name, std::optional<double>& value, double low, double high,
                         const char* sentence) {
  auto& option = add(name, sentence);
  option.placeholder = "NUMBER";
  option.facts = facts_of(name, value ? fmt::format("{}", *value) : "not set", range_text(low, high));
  option.set = number_setter(value, low, high);
}

void Options::operator()(const char* name, bool& value, const char* sentence) {
  auto& option = add(name, sentence);
  option.is_switch = true;
  option.on_by_default = value;
  option.facts = value ? "default on" : "default off";
  option.set = [&value](const std::string& text) -> std::optional<std::string> {
    if (text != "true" && text != "false") return "expected true or false";
    value = text == "true";
    return std::nullopt;
  };
}

void Options::operator()(const char* name, std::string& value, const char* placeholder, const char* sentence) {
  auto& option = add(name, sentence);
  option.placeholder = placeholder;
  option.facts = value.empty() ? "default not set" : "default " + value;
  // What is written like a file is meant beside the settings file that names it.
  option.is_path = std::string_view(placeholder).find("FILE") != std::string_view::npos ||
                   std::string_view(placeholder).find(".toml") != std::string_view::npos ||
                   std::string_view(placeholder).find(".csv") != std::string_view::npos;
  option.set = [&value](const std::string& text) -> std::optional<std::string> {
    if (text.empty()) return "expected a value";
    value = text;
    return std::nullopt;
  };
}

void Options::operator()(const char* name, std::string& value, std::initializer_list<const char*> words,
                         const char* sentence) {
  auto& option = add(name, sentence);
  const std::vector<std::string> choices(words.begin(), words.end());
  option.placeholder = fmt::format("{}", fmt::join(choices, "|"));
  option.facts = "default " + value;
  option.set = [&value, choices](const std::string& text) -> std::optional<std::string> {
    if (std::find(choices.begin(), choices.end(), text) == choices.end())
      return fmt::format("expected one of {}", fmt::join(choices, ", "));
    value = text;
    return std::nullopt;
  };
}

void Options::list(const char* name, std::vector<std::string>& values, const char* placeholder, const char* sentence) {
  auto& option = add(name, sentence);
  option.placeholder = placeholder;
  option.facts = "default none";
  option.repeats = option.is_path = true;
  option.set = [&values](const std::string& text) -> std::optional<std::string> {
    if (text.empty()) return "expected a value";
    values.push_back(text);
    return std::nullopt;
  };
}

Option* Options::find(std::string_view key) {
  for (auto& option : options_)
    if (option.key == key) return &option;
  return nullptr;
}

std::string help_text(const Options& options) {
  std::string text;
  for (const auto& o : options.all()) {
    std::string head = "  ";
    if (o.letter) head += fmt::format("-{}, ", o.letter);
    head += o.is_switch && o.on_by_default ? "--[no-]" + o.flag.substr(2) : o.flag;
    if (!o.placeholder.empty()) head += " " + o.placeholder + (o.repeats ? "..." : "");
    head += o.facts.empty() ? "" : "  (" + o.facts + ")";
    text += product::wrapped(head, 79, 6) + "\n" + product::wrapped("      " + o.sentence, 79, 6) + "\n";
  }
  return text;
}

}  // namespace quadsonde::cli
