#include "ingest/mcap/ros_definition.h"

#include <algorithm>
#include <charconv>
#include <map>

namespace quadsonde::ingest {
namespace {

constexpr std::size_t kMostFields = 4096;  // in all; nav_msgs/Odometry has some 30

const std::map<std::string_view, RosType> kTypes = {
    {"bool", RosType::boolean},   {"byte", RosType::uint8},     {"char", RosType::uint8},
    {"int8", RosType::int8},      {"uint8", RosType::uint8},    {"int16", RosType::int16},
    {"uint16", RosType::uint16},  {"int32", RosType::int32},    {"uint32", RosType::uint32},
    {"int64", RosType::int64},    {"uint64", RosType::uint64},  {"float32", RosType::float32},
    {"float64", RosType::float64}, {"string", RosType::text},   {"time", RosType::time},
    {"duration", RosType::time}};

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string_view next_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// "pkg/msg/Type" and "pkg/Type" are one.
std::string plain_name(std::string_view name) {
  const auto first = name.find('/'), last = name.rfind('/');
  if (first == name.npos || first == last) return std::string(name);
  return std::string(name.substr(0, first)) + std::string(name.substr(last));
}

/// One structure before its types are looked up.
struct Draft {
  std::string name;
  std::vector<std::pair<RosField, std::string>> fields;  // and the name of the type
};

class DefinitionParser {
 public:
  std::optional<RosDefinition> parse(std::string_view name, std::string_view text) {
    drafts_.push_back({plain_name(name), {}});
    while (!text.empty()) {
      auto line = next_line(text);
      line = trim(line.substr(0, line.find('#')));
      if (line.empty() || line.find_first_not_of('=') == line.npos) continue;
      if (line.starts_with("MSG:"))
        drafts_.push_back({plain_name(trim(line.substr(4))), {}});
      else if (!take_field(line))
        return std::nullopt;
    }
    return resolve();
  }

 private:
  bool take_field(std::string_view line) {
    const auto type_end = line.find_first_of(" \t");
    if (type_end == line.npos || ++fields_ > kMostFields) return false;
    auto type = line.substr(0, type_end);
    auto rest = trim(line.substr(type_end));
    const auto name_end = rest.find_first_of(" \t=");
    const auto name = rest.substr(0, name_end);
    const auto after = name_end == rest.npos ? std::string_view{} : trim(rest.substr(name_end));
    if (after.starts_with('=')) return true;  // a constant; what else follows a name is its default
    RosField field;
    field.name = name;
    if (const auto bracket = type.find('['); bracket != type.npos) {
      if (!take_bounds(type.substr(bracket), field)) return false;
      type = type.substr(0, bracket);
    }
    type = type.substr(0, type.find("<="));  // string<=10 is a string
    if (name.empty() || type.empty()) return false;
    drafts_.back().fields.emplace_back(std::move(field), std::string(type));
    return true;
  }

  static bool take_bounds(std::string_view bounds, RosField& field) {
    field.is_array = true;
    if (!bounds.ends_with(']')) return false;
    bounds = bounds.substr(1, bounds.size() - 2);
    if (bounds.empty() || bounds.starts_with("<=")) return true;
    std::uint32_t length = 0;
    const auto [end, error] = std::from_chars(bounds.data(), bounds.data() + bounds.size(), length);
    field.length = length;
    return error == std::errc() && end == bounds.data() + bounds.size();
  }

  /// By its full name, as a type of the same package, or by its last part alone ("Header").
  std::optional<std::size_t> find(const std::string& type, const std::string& user) const {
    const auto plain = plain_name(type);
    const auto sibling = user.substr(0, user.find('/') + 1) + plain;
    for (const auto& wanted : {plain, sibling})
      for (std::size_t i = 0; i < drafts_.size(); ++i)
        if (drafts_[i].name == wanted) return i;
    for (std::size_t i = 0; i < drafts_.size(); ++i)
      if (drafts_[i].name.ends_with("/" + plain)) return i;
    return std::nullopt;
  }

  std::optional<RosDefinition> resolve() {
    RosDefinition definition;
    for (auto& draft : drafts_) {
      RosStructure structure{draft.name, {}};
      for (auto& [field, type] : draft.fields) {
        const auto known = kTypes.find(type);
        const auto found = find(type, draft.name);
        if (known != kTypes.end())
          field.type = known->second;
        else if (found)
          field.structure = *found;
        else if (type == "builtin_interfaces/Time" || type == "builtin_interfaces/Duration")
          field.type = RosType::time;
        else
          return std::nullopt;
        structure.fields.push_back(std::move(field));
      }
      definition.structures.push_back(std::move(structure));
    }
    std::vector<int> state(definition.structures.size(), 0);
    return acyclic(definition, 0, state) ? std::optional(std::move(definition)) : std::nullopt;
  }

  static bool acyclic(const RosDefinition& definition, std::size_t at, std::vector<int>& state) {
    if (state[at] != 0) return state[at] == 2;
    state[at] = 1;
    for (const auto& field : definition.structures[at].fields)
      if (field.type == RosType::structure && !acyclic(definition, field.structure, state)) return false;
    state[at] = 2;
    return true;
  }

  std::vector<Draft> drafts_;
  std::size_t fields_ = 0;
};

}  // namespace

std::optional<RosDefinition> parse_ros_definition(std::string_view name, std::string_view text) {
  return DefinitionParser().parse(name, text);
}

}  // namespace quadsonde::ingest
