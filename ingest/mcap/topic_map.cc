#include "ingest/mcap/topic_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <toml++/toml.h>

namespace quadsonde::ingest {
namespace {

/// What a stream's rule must look like.
struct Shape {
  std::set<std::size_t> fields;  ///< allowed counts; empty: one or more
  std::set<std::string> axes;    ///< allowed words; empty: it has none
};

const std::map<std::string, Shape>& shapes() {
  static const std::map<std::string, Shape> table = {
      {"attitude", {{3, 4}, {"ned_frd", "enu_flu"}}},
      {"velocity", {{3}, {"ned", "enu", "frd", "flu"}}},
      {"local_position", {{3}, {"ned", "enu"}}},
      {"wind", {{2}, {"ned", "enu"}}},
      {"accelerometer", {{3}, {"frd", "flu"}}},
      {"position", {{2}, {}}},
      {"height_msl", {{1}, {}}},
      {"height_ellipsoid", {{1}, {}}},
      {"height_ground", {{1}, {}}},
      {"pressure", {{1}, {}}},
      {"baro_altitude", {{1}, {}}},
      {"temperature", {{1}, {}}},
      {"humidity", {{1}, {}}},
      {"landed", {{1}, {}}},
      {"rotors", {{}, {}}}};
  return table;
}

template <class Set>
std::string listed(const Set& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

class MapReader {
 public:
  explicit MapReader(const std::string& file) : file_(file) {}

  Result<TopicMap> read(const toml::table& table) {
    TopicMap map;
    for (const auto& [key, node] : table) {
      const std::string stream(key.str());
      const auto shape = shapes().find(stream);
      if (shape == shapes().end()) {
        std::vector<std::string> names;
        for (const auto& [name, ignored] : shapes()) names.push_back(name);
        return wrong(node, fmt::format("no stream is called {}", stream), "the streams are " + listed(names));
      }
      const auto* rule = node.as_table();
      if (!rule) return wrong(node, fmt::format("{} is no table", stream), fmt::format("write [{}]", stream));
      auto read = read_rule(*rule, stream, shape->second);
      if (!read) return fail(read.error());
      map.rules[stream] = std::move(*read);
    }
    return map;
  }

 private:
  tl::unexpected<Problem> wrong(const toml::node& node, std::string what, std::string hint) const {
    return fail(Kind::usage, std::move(what), {file_, {}, node.source().begin.line, {}}, std::move(hint));
  }

  Result<TopicRule> read_rule(const toml::table& table, const std::string& stream, const Shape& shape) const {
    TopicRule rule;
    for (const auto& [key, node] : table)
      if (!take(std::string(key.str()), node, rule))
        return wrong(node, fmt::format("{}.{} is not known, or not of the right type", stream, key.str()),
                     "a rule has topic, fields, axes, scale, offset, time and time_scale");
    if (rule.topic.empty() || rule.fields.empty())
      return wrong(table, fmt::format("{} needs a topic and fields", stream), "add them");
    if (!shape.fields.empty() && !shape.fields.contains(rule.fields.size()))
      return wrong(table, fmt::format("{} has {} fields", stream, rule.fields.size()),
                   "it takes " + listed(shape.fields));
    if (shape.axes.empty() ? !rule.axes.empty() : !shape.axes.contains(rule.axes))
      return wrong(table, fmt::format("{} has the axes \"{}\"", stream, rule.axes),
                   shape.axes.empty() ? "it has none" : "say one of " + listed(shape.axes));
    return rule;
  }

  static bool take(const std::string& key, const toml::node& node, TopicRule& rule) {
    const auto text = node.value<std::string>();
    const auto number = node.value<double>();
    const auto into = [](const auto& value, auto& target) {
      if (value) target = *value;
      return value.has_value();
    };
    if (key == "topic") return into(text, rule.topic);
    if (key == "axes") return into(text, rule.axes);
    if (key == "time") return into(text, rule.time);
    if (key == "scale") return into(number, rule.scale);
    if (key == "offset") return into(number, rule.offset);
    if (key == "time_scale") return into(number, rule.time_scale);
    if (key != "fields") return false;
    const auto* list = node.as_array();
    if (!list) return false;
    for (const auto& field : *list) {
      const auto name = field.value<std::string>();
      if (!name) return false;
      rule.fields.push_back(*name);
    }
    return true;
  }

  std::string file_;
};

}  // namespace

Result<TopicMap> parse_topic_map(std::string_view text, const std::string& file_name) {
  try {
    return MapReader(file_name).read(toml::parse(text));
  } catch (const toml::parse_error& error) {
    return fail(Kind::usage, std::string(error.description()), {file_name, {}, error.source().begin.line, {}},
                "correct the map");
  }
}

}  // namespace quadsonde::ingest
