#pragma once
// Small tables of references: a header, a delimiter, cells by name.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"

namespace quadsonde::ingest {

/// Lines of a text without comment lines, and their line numbers (first is 1).
struct TextLines {
  std::vector<std::string_view> text;
  std::vector<std::uint64_t> number;
};
TextLines split_lines(std::string_view text, char comment = '#');

/// Cells of one line; quotes around a cell are taken off, blanks trimmed.
std::vector<std::string_view> split_cells(std::string_view line, char delimiter);

/// Index of a column by its name, or nothing.
std::optional<std::size_t> column(const std::vector<std::string_view>& header, std::string_view name);

/// A number, or nothing for an empty cell, M, T or anything else.
std::optional<double> cell_number(const std::vector<std::string_view>& cells, std::optional<std::size_t> index);

}  // namespace quadsonde::ingest
