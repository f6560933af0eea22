#include "ingest/reference/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace quadsonde::ingest {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

TextLines split_lines(std::string_view text, char comment) {
  TextLines lines;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  for (std::uint64_t number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    const auto line = text.substr(0, end);
    if (!trimmed(line).empty() && line[0] != comment) {
      lines.text.push_back(line);
      lines.number.push_back(number);
    }
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return lines;
}

std::vector<std::string_view> split_cells(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  while (true) {
    const bool quoted = !line.empty() && line.front() == '"';
    const auto close = quoted ? line.find('"', 1) : std::string_view::npos;
    const auto end = line.find(delimiter, close == std::string_view::npos ? 0 : close);
    auto cell = trimmed(line.substr(0, end));
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    cells.push_back(cell);
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

std::optional<std::size_t> column(const std::vector<std::string_view>& header, std::string_view name) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.begin());
}

std::optional<double> cell_number(const std::vector<std::string_view>& cells, std::optional<std::size_t> index) {
  if (!index || *index >= cells.size()) return std::nullopt;
  const auto cell = cells[*index];
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace quadsonde::ingest
