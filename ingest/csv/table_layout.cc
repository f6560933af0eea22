#include "ingest/csv/table_layout.h"

#include <fmt/format.h>

#include <algorithm>

#include "ingest/csv/table.h"

namespace quadsonde::ingest::csv {
namespace {

constexpr std::uint64_t max_preamble = 200;  // lines in which the header is searched
constexpr std::size_t max_columns = 4096;

struct Header {
  std::uint64_t line = 0;
  std::size_t data_at = 0;
  char delimiter = 0;
  std::vector<std::string> names;
};

bool holds(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}
bool holds(const std::vector<std::string>& names, const std::vector<std::string>& wanted) {
  return std::all_of(wanted.begin(), wanted.end(), [&](const auto& name) { return holds(names, name); });
}

std::vector<std::string> names_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> fields;
  split(line, delimiter, max_columns, fields);
  std::vector<std::string> names;
  for (const auto field : fields) names.emplace_back(trim(field));
  return names;
}

bool is_comment(std::string_view line, const ColumnMap* map) {
  return trim(line).empty() || (map && !map->comment.empty() && line.substr(0, map->comment.size()) == map->comment);
}

/// The columns of a map that a header holds, in the map's order; names of those that it should hold and does not.
std::vector<BoundColumn> take_columns(const ColumnMap& map, const std::vector<std::string>& names,
                                      std::vector<std::string>& missing) {
  std::vector<BoundColumn> bound;
  for (const auto& [canonical, sources] : map.columns) {
    const auto source =
        std::find_if(sources.begin(), sources.end(), [&](const auto& s) { return holds(names, s.columns); });
    if (source == sources.end()) {
      if (map.match.empty() && !sources.front().optional)
        missing.push_back(fmt::format("\"{}\" (for {})", fmt::join(sources.front().columns, "\" and \""), canonical));
      continue;
    }
    BoundColumn column{canonical, &*source, {}};
    for (const auto& name : source->columns)
      column.fields.push_back(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
    bound.push_back(std::move(column));
  }
  return bound;
}

std::size_t bound_count(const ColumnMap& map, const std::vector<std::string>& names) {
  std::vector<std::string> ignored;
  return take_columns(map, names, ignored).size();
}

/// Goes over the lines in which a header may be.
template <class Function>
void for_each_candidate(Bytes bytes, const ColumnMap* map, Function&& function) {
  Lines lines(bytes);
  std::string_view line;
  while (lines.number() < std::max(max_preamble, map ? map->header : 0) && lines.next(line)) {
    if (line.size() > (1U << 18) || (map && map->header > 0 && lines.number() != map->header)) continue;
    if (map && map->header == 0 && is_comment(line, map)) continue;
    const char delimiter = map && map->delimiter ? map->delimiter : guess_delimiter(line);
    if (delimiter == 0) continue;
    if (function(Header{lines.number(), lines.at(), delimiter, names_of(line, delimiter)})) return;
  }
}

/// The shipped map whose columns a line holds; the canonical names where none does.
std::optional<Header> find_shipped(Bytes bytes, const ColumnMap*& found) {
  std::optional<Header> header;
  const auto& maps = shipped_column_maps();
  for_each_candidate(bytes, nullptr, [&](Header candidate) {
    for (const auto& map : maps)
      if (!map.match.empty() && holds(candidate.names, map.match)) {
        found = &map;
        header = std::move(candidate);
        return true;
      }
    return false;
  });
  if (header || maps.empty()) return header;
  const auto& canonical = maps.back();
  for_each_candidate(bytes, nullptr, [&](Header candidate) {
    if (bound_count(canonical, candidate.names) < 2) return false;
    found = &canonical;
    header = std::move(candidate);
    return true;
  });
  return header;
}

/// The line that holds most of the columns of the user's map.
std::optional<Header> find_header(Bytes bytes, const ColumnMap& map) {
  std::optional<Header> best;
  std::size_t most = 0;
  for_each_candidate(bytes, &map, [&](Header candidate) {
    const auto count = bound_count(map, candidate.names);
    if (best && count <= most) return false;
    most = count;
    best = std::move(candidate);
    return false;
  });
  return best;
}

void read_preamble(Bytes bytes, Layout& layout) {
  Lines lines(bytes);
  std::string_view line;
  std::vector<std::string_view> fields;
  while (lines.next(line) && lines.number() < layout.header_line) {
    split(line, layout.delimiter, 2, fields);
    if (fields.size() == 2) layout.preamble.emplace_back(fields[0], fields[1]);
  }
}

std::string shorten(const std::vector<std::string>& names) {
  const std::vector<std::string> first(
      names.begin(), names.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(names.size(), 12)));
  return fmt::format("{}{}", fmt::join(first, ", "), names.size() > 12 ? ", ..." : "");
}

}  // namespace

Result<Layout> find_layout(Bytes bytes, const std::string& file, const ColumnMap* map) {
  const bool users = map != nullptr;
  const auto header = users ? find_header(bytes, *map) : find_shipped(bytes, map);
  if (!header) {
    std::optional<Header> first;
    for_each_candidate(bytes, nullptr, [&](Header h) {
      first = std::move(h);
      return true;
    });
    if (!first)
      return fail(Kind::not_a_log, "this is text, but no line of it is the header of a table", {file, {}, {}, {}},
                  "give a log, or a table whose first line names its columns");
    return fail(
        Kind::missing, fmt::format("no known table has these columns: {}", shorten(first->names)),
        {file, {}, first->line, {}},
        "name them as in the reference (time_s, roll_deg, pitch_deg, yaw_deg, vn_m_s, ...) or give --columns MAP.toml");
  }
  Layout layout;
  layout.map = map;
  layout.delimiter = header->delimiter;
  layout.data_at = header->data_at;
  layout.header_line = header->line;
  layout.names = header->names;
  std::vector<std::string> missing;
  layout.bound = take_columns(*map, layout.names, missing);
  if (users && !missing.empty())
    return fail(
        Kind::missing, fmt::format("the table has no column {}", missing.front()), {file, {}, header->line, {}},
        fmt::format("its columns are: {}; change the map, or mark the line optional = true", shorten(layout.names)));
  const auto is_time = [](const BoundColumn& c) { return c.canonical == "time_s" || c.canonical == "utc"; };
  if (std::none_of(layout.bound.begin(), layout.bound.end(), is_time))
    return fail(
        Kind::missing, "no column gives the time (time_s or utc)", {file, {}, header->line, "time_s"},
        fmt::format("its columns are: {}; name the time time_s, or give --columns MAP.toml", shorten(layout.names)));
  read_preamble(bytes, layout);
  return layout;
}

namespace {

/// A TOML basic string.
std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string source_text(const ColumnSource& source) {
  std::string text, names;
  for (const auto& column : source.columns) names += (names.empty() ? "" : ", ") + toml_string(column);
  text = source.columns.size() == 1 ? "column = " + names : "columns = [" + names + "]";
  if (source.scale != 1) text += fmt::format(", scale = {}", source.scale);
  if (source.offset != 0) text += fmt::format(", offset = {}", source.offset);
  if (!source.format.empty()) text += ", format = " + toml_string(source.format);
  return text == "column = " + names ? names : "{ " + text + " }";
}

/// The lines of [read] and [vehicle].
std::string sections(std::string_view toml) {
  std::string kept;
  bool keep = false;
  while (!toml.empty()) {
    const auto end = std::min(toml.find('\n'), toml.size());
    const auto line = toml.substr(0, end);
    toml.remove_prefix(std::min(end + 1, toml.size()));
    if (line.starts_with('[')) {
      keep = line.starts_with("[read]") || line.starts_with("[vehicle]");
      if (keep) kept += '\n';
    }
    if (keep && !line.empty()) kept += std::string(line) + '\n';
  }
  return kept;
}

}  // namespace

std::string used_map(const Layout& layout) {
  std::string text;
  for (const auto& bound : layout.bound) text += bound.canonical + " = " + source_text(*bound.source) + "\n";
  return text + sections(layout.map->toml);
}

}  // namespace quadsonde::ingest::csv
