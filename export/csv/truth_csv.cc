#include "export/csv/truth_csv.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <vector>

#include "export/csv/numbers.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

constexpr std::array<std::string_view, 5> columns{"time_s", "height_agl_m", "wind_east_m_s", "wind_north_m_s",
                                                  "wind_up_m_s"};

std::vector<std::string_view> split(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> parts;
  for (std::size_t from = 0; from <= line.size();) {
    const auto comma = std::min(line.find(',', from), line.size());
    parts.push_back(line.substr(from, comma - from));
    from = comma + 1;
  }
  return parts;
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Where each of our columns stands in the header.
ingest::Result<std::array<std::size_t, 5>> find_columns(std::string_view header, const std::string& file) {
  const auto names = split(header);
  std::array<std::size_t, 5> at{};
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto found = std::find(names.begin(), names.end(), columns[c]);
    if (found == names.end())
      return fail(Kind::missing, fmt::format("the column {} of a truth table is not there", columns[c]),
                  {file, {}, 1, std::string(columns[c])},
                  fmt::format("give a table with the columns {}, as `quadsonde simulate --truth` writes it",
                              fmt::join(columns, ",")));
    at[c] = static_cast<std::size_t>(found - names.begin());
  }
  return at;
}

}  // namespace

std::string truth_csv(const ingest::Truth& truth) {
  std::string text = fmt::format("{}\n", fmt::join(columns, ","));
  for (const auto& t : truth)
    text += fmt::format("{},{},{},{},{}\n", seconds_text(t.time), fixed(t.height.m, 3), fixed(t.v_NA_N.y(), 6),
                        fixed(t.v_NA_N.x(), 6), fixed(-t.v_NA_N.z(), 6));
  return text;
}

ingest::Result<ingest::Truth> parse_truth_csv(std::string_view text, const std::string& file) {
  ingest::Truth truth;
  std::array<std::size_t, 5> at{};
  std::uint64_t line_number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const auto end = std::min(text.find('\n', from), text.size());
    const auto line = text.substr(from, end - from);
    from = end + 1;
    if (++line_number == 1) {
      const auto found = find_columns(line, file);
      if (!found) return fail(found.error());
      at = *found;
      continue;
    }
    if (line.empty() || line == "\r") continue;
    const auto parts = split(line);
    std::array<double, 5> values{};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto value = at[c] < parts.size() ? number(parts[at[c]]) : std::nullopt;
      if (!value)
        return fail(Kind::damaged, "expected a finite number here", {file, {}, line_number, std::string(columns[c])},
                    "correct or remove the line");
      values[c] = *value;
    }
    const ingest::LogTime time{ingest::seconds(values[0]).count()};
    if (!truth.empty() && time <= truth.back().time)
      return fail(Kind::damaged, "the time does not rise from the line before", {file, {}, line_number, "time_s"},
                  "sort the table by time_s");
    truth.push_back({time, {values[1]}, {values[3], values[2], -values[4]}});
  }
  if (line_number == 0) return find_columns("", file).map([](auto) { return ingest::Truth{}; });
  if (truth.empty())
    return fail(Kind::missing, "the truth table has no rows", {file, {}, {}, {}}, "give a table with at least one row");
  return truth;
}

ingest::Result<ingest::Truth> read_truth_csv(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  if (!stream || std::filesystem::is_directory(file, error))
    return fail(Kind::unreadable, "the reference cannot be opened", {file.string(), {}, {}, {}}, "check the path");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_truth_csv(text, file.string());
}

}  // namespace quadsonde::product
