#pragma once
// A table as text: lines, fields, numbers. It knows no canonical column and no Flight.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"

namespace quadsonde::ingest::csv {

/// Walks over lines that end in LF or CR LF; a byte order mark at the start is skipped.
class Lines {
 public:
  explicit Lines(Bytes bytes, std::size_t at = 0, std::uint64_t line = 0);
  bool next(std::string_view& line);
  std::uint64_t number() const { return line_; }  ///< of the line that next() gave last, first is 1
  std::size_t at() const { return at_; }          ///< offset behind it
  bool ended() const { return ended_; }           ///< had that line a line end?

 private:
  std::string_view text_;
  std::size_t at_;
  std::uint64_t line_;
  bool ended_ = true;
};

std::string_view trim(std::string_view text);

/// Fields of a line, trimmed, quotes taken off. Delimiter ' ' stands for any run of blanks and tabs.
/// Stops after `most` fields.
void split(std::string_view line, char delimiter, std::size_t most, std::vector<std::string_view>& fields);

/// How many fields split() would find without a limit.
std::size_t count_fields(std::string_view line, char delimiter);

/// Tab, semicolon or comma, whichever the line has most of; 0 if it has none.
char guess_delimiter(std::string_view line);

/// Empty, or one of the words that tables write for "no value" (N/A, No Data, null, None, -).
bool is_blank(std::string_view field);

/// The whole field as a number; empty if it is none. "nan" and "inf" come out as such.
std::optional<double> parse_number(std::string_view field);

/// Decimal seconds to whole nanoseconds without rounding through a double.
std::optional<std::int64_t> parse_seconds_ns(std::string_view field);

}  // namespace quadsonde::ingest::csv
