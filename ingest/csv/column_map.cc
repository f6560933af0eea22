#include "ingest/csv/column_map.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "ingest/csv/shipped_maps.h"
#include "ingest/csv/time_text.h"

namespace quadsonde::ingest {
namespace {

constexpr std::string_view canonical[] = {"time_s",
                                          "utc",
                                          "qw",
                                          "qx",
                                          "qy",
                                          "qz",
                                          "roll_deg",
                                          "pitch_deg",
                                          "yaw_deg",
                                          "vn_m_s",
                                          "ve_m_s",
                                          "vd_m_s",
                                          "sd_velocity_m_s",
                                          "lat_deg",
                                          "lon_deg",
                                          "height_msl_m",
                                          "alt_msl_m",
                                          "height_ellipsoid_m",
                                          "height_agl_m",
                                          "x_m",
                                          "y_m",
                                          "z_m",
                                          "baro_alt_m",
                                          "pressure_pa",
                                          "temperature_k",
                                          "relative_humidity_pct",
                                          "ax_m_s2",
                                          "ay_m_s2",
                                          "az_m_s2",
                                          "event"};

/// Everything that can be wrong with a map ends here, with its line.
struct MapError {
  std::string what;
  std::optional<std::uint64_t> line;
};

[[noreturn]] void wrong(std::string what, const toml::node* node = nullptr) {
  std::optional<std::uint64_t> line;
  if (node && node->source().begin.line > 0) line = node->source().begin.line;
  throw MapError{std::move(what), line};
}

std::string text_of(const toml::node& node, std::string_view key) {
  if (const auto value = node.value<std::string>(); value && node.is_string()) return *value;
  wrong(fmt::format("{} should be a text", key), &node);
}
double number_of(const toml::node& node, std::string_view key) {
  if (node.is_number())
    if (const auto value = node.value<double>()) return *value;
  wrong(fmt::format("{} should be a number", key), &node);
}
bool flag_of(const toml::node& node, std::string_view key) {
  if (const auto value = node.value<bool>(); value && node.is_boolean()) return *value;
  wrong(fmt::format("{} should be true or false", key), &node);
}
const toml::table& table_of(const toml::node& node, std::string_view key) {
  if (const auto* table = node.as_table()) return *table;
  wrong(fmt::format("{} should be a table", key), &node);
}
std::vector<std::string> texts_of(const toml::node& node, std::string_view key) {
  std::vector<std::string> texts;
  const auto* array = node.as_array();
  if (!array || array->empty()) wrong(fmt::format("{} should be a list of texts", key), &node);
  for (const auto& item : *array) texts.push_back(text_of(item, key));
  return texts;
}

ColumnSource source_of(const toml::node& node, std::string_view canonical_name) {
  ColumnSource source;
  if (node.is_string()) {
    source.columns = {text_of(node, canonical_name)};
    return source;
  }
  for (const auto& [key, value] : table_of(node, canonical_name)) {
    if (key == "column")
      source.columns = {text_of(value, key)};
    else if (key == "columns")
      source.columns = texts_of(value, key);
    else if (key == "scale")
      source.scale = number_of(value, key);
    else if (key == "offset")
      source.offset = number_of(value, key);
    else if (key == "optional")
      source.optional = flag_of(value, key);
    else if (key == "format")
      source.format = text_of(value, key);
    else
      wrong(fmt::format("{} is not known in {}; known are column, columns, scale, offset, format, optional", key.str(),
                        canonical_name),
            &value);
  }
  if (source.columns.empty()) wrong(fmt::format("{} names no column", canonical_name), &node);
  if (!source.format.empty() && !csv::is_time_format(source.format))
    wrong(fmt::format("format \"{}\" is none of iso, unix, unix_ms, unix_us or a pattern such as %Y-%m-%d %H:%M:%S",
                      source.format),
          &node);
  return source;
}

char delimiter_of(const toml::node& node) {
  const auto text = text_of(node, "delimiter");
  if (text == "whitespace") return ' ';
  if (text == "tab") return '\t';
  if (text.size() == 1) return text[0];
  wrong("delimiter should be one character, \"tab\" or \"whitespace\"", &node);
}

void take_read(ColumnMap& map, const toml::table& table) {
  for (const auto& [key, value] : table) {
    if (key == "delimiter") {
      map.delimiter = delimiter_of(value);
    } else if (key == "header_row") {
      const double row = number_of(value, key);
      if (!(row >= 1 && row <= 1e6)) wrong("header_row counts lines from 1", &value);
      map.header = static_cast<std::uint64_t>(row);
    } else if (key == "comment") {
      map.comment = text_of(value, key);
    } else if (key == "time_format") {
      map.time_format = text_of(value, key);
      if (!csv::is_time_format(map.time_format))
        wrong(fmt::format("time_format \"{}\" is not known", map.time_format), &value);
    } else if (key == "zone") {
      const auto zone = csv::parse_zone(text_of(value, key));
      if (!zone) wrong("zone should be UTC or an offset such as +02:00", &value);
      map.zone_s = *zone;
    } else if (key == "other_rows") {
      const auto text = text_of(value, key);
      if (text != "skip" && text != "report") wrong("other_rows should be skip or report", &value);
      map.skip_other_rows = text == "skip";
    } else {
      wrong(fmt::format(
                "{} is not known in [read]; known are delimiter, header_row, comment, time_format, zone, other_rows",
                key.str()),
            &value);
    }
  }
}

bool is_magnetic(const toml::node& node) {
  const auto text = text_of(node, "heading");
  if (text != "true" && text != "magnetic") wrong("heading should be \"true\" or \"magnetic\"", &node);
  return text == "magnetic";
}

void take_vehicle(ColumnMap& map, const toml::table& table) {
  for (const auto& [key, value] : table) {
    if (key == "name")
      map.vehicle_name = text_of(value, key);
    else if (key == "name_from")
      map.vehicle_name_from = text_of(value, key);
    else if (key == "autopilot")
      map.autopilot = text_of(value, key);
    else if (key == "multirotor")
      map.multirotor = flag_of(value, key);
    else if (key == "rotors")
      map.rotors = static_cast<int>(std::clamp(number_of(value, key), 0.0, 64.0));
    else if (key == "heading")
      map.magnetic_heading = is_magnetic(value);
    else
      wrong(fmt::format("{} is not known in [vehicle]; known are name, name_from, autopilot, multirotor, rotors, heading",
                        key.str()),
            &value);
  }
}

void take_map(ColumnMap& map, const toml::table& table) {
  for (const auto& [key, value] : table) {
    if (key == "name")
      map.name = text_of(value, key);
    else if (key == "note")
      map.note = text_of(value, key);
    else if (key == "match")
      map.match = texts_of(value, key);
    else
      wrong(fmt::format("{} is not known in [map]; known are name, note, match", key.str()), &value);
  }
}

ColumnMap build(const toml::table& root, std::string_view toml, const std::string& name) {
  ColumnMap map;
  map.name = name;
  map.toml = std::string(toml);
  for (const auto& [key, value] : root) {
    if (key == "read")
      take_read(map, table_of(value, key));
    else if (key == "vehicle")
      take_vehicle(map, table_of(value, key));
    else if (key == "map")
      take_map(map, table_of(value, key));
    else if (!is_canonical_column(key.str()))
      wrong(fmt::format("{} is not a column that is known here; known are {}, rotor_1_rpm...", key.str(),
                        fmt::join(canonical, ", ")),
            &value);
    else if (const auto* array = value.as_array())
      for (const auto& item : *array) map.columns[std::string(key.str())].push_back(source_of(item, key));
    else
      map.columns[std::string(key.str())].push_back(source_of(value, key));
  }
  if (map.columns.empty()) wrong("the map names no column");
  return map;
}

}  // namespace

bool is_canonical_column(std::string_view name) {
  if (std::find(std::begin(canonical), std::end(canonical), name) != std::end(canonical)) return true;
  constexpr std::string_view head = "rotor_", tail = "_rpm";
  if (name.size() < head.size() + tail.size() + 1 || name.size() > head.size() + tail.size() + 2) return false;
  const auto digits = name.substr(head.size(), name.size() - head.size() - tail.size());
  return name.substr(0, head.size()) == head && name.substr(name.size() - tail.size()) == tail &&
         digits.find_first_not_of("0123456789") == std::string_view::npos && digits[0] != '0';
}

Result<ColumnMap> parse_column_map(std::string_view toml, const std::string& name) {
  const std::string hint = "each line is one canonical column, such as vn_m_s = \"VelN\"";
  try {
    return build(toml::parse(toml), toml, name);
  } catch (const toml::parse_error& error) {
    return fail(Kind::usage, fmt::format("the column map is not TOML: {}", error.description()),
                {name, {}, error.source().begin.line, {}}, hint);
  } catch (const MapError& error) {
    return fail(Kind::usage, "the column map is not right: " + error.what, {name, {}, error.line, {}}, hint);
  } catch (const std::exception& error) {
    return fail(Kind::usage, fmt::format("the column map cannot be read: {}", error.what()), {name, {}, {}, {}}, hint);
  }
}

Result<ColumnMap> read_column_map(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file && text.empty())
    return fail(Kind::unreadable, "the column map cannot be read", {path.string(), {}, {}, {}},
                "check the path given to --columns");
  auto map = parse_column_map(text, path.stem().string());
  if (!map) map.error().where.file = path.string();
  return map;
}

const std::vector<ColumnMap>& shipped_column_maps() {
  static const std::vector<ColumnMap> maps = [] {
    std::vector<ColumnMap> all;
    for (const auto& [name, text] : csv::shipped_map_texts) {
      auto map = parse_column_map(text, std::string(name));
      if (map) all.push_back(std::move(*map));  // a test holds that every shipped map parses
    }
    // The canonical names fit any header that holds them, so they come last.
    std::stable_partition(all.begin(), all.end(), [](const auto& map) { return !map.match.empty(); });
    return all;
  }();
  return maps;
}

}  // namespace quadsonde::ingest
