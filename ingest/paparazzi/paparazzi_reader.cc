#include "ingest/paparazzi/paparazzi_reader.h"

#include <algorithm>
#include <charconv>

namespace quadsonde::ingest {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word(char c) { return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string lower(std::string_view text) {
  std::string out(text);
  for (auto& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// "123.4567" to nanoseconds, exactly; empty for anything else.
std::optional<std::int64_t> parse_seconds_ns(std::string_view text) {
  std::int64_t whole = 0, fraction = 0, scale = 1'000'000'000;
  const auto dot = std::min(text.find('.'), text.size());
  const auto [end, error] = std::from_chars(text.data(), text.data() + dot, whole);
  if (error != std::errc() || end != text.data() + dot || whole < 0 || whole > 9'000'000'000 || text[0] == '-')
    return std::nullopt;
  for (std::size_t i = dot + 1; i < text.size(); ++i) {
    if (!is_digit(text[i])) return std::nullopt;
    scale /= 10;
    fraction += (text[i] - '0') * scale;
  }
  return whole * 1'000'000'000 + fraction;
}

std::string_view take_word(std::string_view& text) {
  const auto end = std::min(text.find(' '), text.size());
  const auto word = text.substr(0, end);
  text.remove_prefix(std::min(text.size(), end + 1));
  return word;
}

/// Tags of something like XML, one after another; attributes in order, names in lower case.
class TagScanner {
 public:
  explicit TagScanner(std::string_view text) : text_(text) {}

  bool next() {
    attributes.clear();
    for (;;) {
      at_ = text_.find('<', at_);
      if (at_ == std::string_view::npos) return false;
      if (text_.substr(at_).starts_with("<!--")) {
        const auto end = text_.find("-->", at_);
        if (end == std::string_view::npos) return false;
        at_ = end + 3;
        continue;
      }
      ++at_;
      name = lower(take_name(at_ < text_.size() && text_[at_] == '/'));
      if (name.empty()) continue;
      take_attributes();
      return true;
    }
  }
  std::string_view attribute(std::string_view wanted) const {
    for (const auto& [key, value] : attributes)
      if (key == wanted) return value;
    return {};
  }

  std::string name;  ///< with a leading '/' for an end tag
  std::vector<std::pair<std::string, std::string_view>> attributes;

 private:
  std::string_view take_name(bool with_slash) {
    const auto from = at_;
    if (with_slash) ++at_;
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    return text_.substr(from, at_ - from);
  }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  /// Up to '>' outside of quotes; what is no attribute is stepped over.
  void take_attributes() {
    for (;;) {
      skip_blanks();
      if (at_ >= text_.size() || text_[at_] == '>' || text_[at_] == '<') return;
      const auto key = take_name(false);
      if (key.empty()) {
        ++at_;
        continue;
      }
      skip_blanks();
      if (at_ >= text_.size() || text_[at_] != '=') continue;
      ++at_;
      skip_blanks();
      if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) continue;
      const auto end = text_.find(text_[at_], at_ + 1);
      if (end == std::string_view::npos) {
        at_ = text_.size();
        return;
      }
      attributes.emplace_back(lower(key), text_.substr(at_ + 1, end - at_ - 1));
      at_ = end + 1;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<std::size_t> PaparazziMessageDefinition::find(std::string_view field) const {
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == field) return i;
  return std::nullopt;
}

const PaparazziMessageDefinition* PaparazziDefinitions::find(std::string_view name) const {
  const auto found = messages_.find(name);
  return found == messages_.end() ? nullptr : &found->second;
}

PaparazziDefinitions PaparazziDefinitions::scan(Bytes log) {
  PaparazziDefinitions definitions;
  TagScanner tag(as_text(log));
  std::string current_class;  // messages of a telemetry configuration stand outside of any class
  std::map<std::string, std::string, std::less<>> class_of;
  PaparazziMessageDefinition* message = nullptr;
  while (tag.next()) {
    if (tag.name == "configuration") {
      if (const auto ns = parse_seconds_ns(tag.attribute("time_of_day"))) definitions.time_of_day_ = UtcTime{*ns};
    } else if (tag.name == "aircraft") {
      definitions.aircraft_.push_back({std::string(tag.attribute("ac_id")), std::string(tag.attribute("name")), {}});
    } else if (tag.name == "firmware") {
      auto& aircraft = definitions.aircraft_;
      if (!aircraft.empty() && aircraft.back().firmware.empty())
        aircraft.back().firmware = lower(tag.attribute("name"));
    } else if (tag.name == "class" || tag.name == "msg_class") {
      current_class = lower(tag.attribute("name"));
    } else if (tag.name == "/class" || tag.name == "/msg_class") {
      current_class.clear();
      message = nullptr;
    } else if (tag.name == "message" && !current_class.empty()) {
      message = nullptr;
      const auto name = std::string(tag.attribute("name"));
      if (name.empty()) continue;
      const bool is_telemetry = current_class.starts_with("telemetry");
      auto& owner = class_of[name];
      if (!owner.empty() && !(is_telemetry && !owner.starts_with("telemetry"))) continue;
      owner = current_class;
      message = &definitions.messages_[name];
      *message = {name, {}};
    } else if (tag.name == "/message") {
      message = nullptr;
    } else if (tag.name == "field" && message != nullptr) {
      message->fields.push_back(
          {lower(tag.attribute("name")), lower(tag.attribute("type")), lower(tag.attribute("unit"))});
    }
  }
  return definitions;
}

bool PaparazziLineReader::next(PaparazziLine& line) {
  while (at_ < text_.size()) {
    const auto end = text_.find('\n', at_);
    if (end == std::string_view::npos) {
      trailing_ = text_.size() - at_;
      at_ = text_.size();
      return false;
    }
    auto rest = text_.substr(at_, end - at_);
    line.at = at_;
    line.line = ++line_;
    at_ = end + 1;
    if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    if (std::all_of(rest.begin(), rest.end(), is_blank)) continue;
    const auto time = parse_seconds_ns(take_word(rest));
    line.aircraft = take_word(rest);
    line.name = take_word(rest);
    line.values = rest;
    const bool is_message = time && !line.name.empty() && std::all_of(line.name.begin(), line.name.end(), is_word) &&
                            !is_digit(line.name[0]);
    if (is_message && std::all_of(line.aircraft.begin(), line.aircraft.end(), is_digit) && !line.aircraft.empty()) {
      line.time = LogTime{*time};
      ++good_;
      return true;
    }
    if (is_message) {
      ++ground_;
    } else if (unparsable_++ == 0) {
      first_unparsable_ = line.line;
    }
  }
  return false;
}

void split_paparazzi_values(std::string_view values, std::vector<std::string_view>& out) {
  out.clear();
  std::size_t at = 0;
  while (at < values.size()) {
    if (values[at] == ' ') {
      ++at;
      continue;
    }
    const bool quoted = values[at] == '"';
    const auto from = quoted ? at + 1 : at;
    const auto end = std::min(values.find(quoted ? '"' : ' ', from), values.size());
    out.push_back(values.substr(from, end - from));
    at = end + 1;
  }
}

}  // namespace quadsonde::ingest
