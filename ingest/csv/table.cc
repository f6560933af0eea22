#include "ingest/csv/table.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>

namespace quadsonde::ingest::csv {

Lines::Lines(Bytes bytes, std::size_t at, std::uint64_t line) : text_(as_text(bytes)), at_(at), line_(line) {
  if (at_ == 0 && text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;
}

bool Lines::next(std::string_view& line) {
  if (at_ >= text_.size()) return false;
  const auto end = text_.find('\n', at_);
  ended_ = end != std::string_view::npos;
  line = text_.substr(at_, ended_ ? end - at_ : std::string_view::npos);
  at_ = ended_ ? end + 1 : text_.size();
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  ++line_;
  return true;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

namespace {

std::string_view trim_blanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Takes a field that begins with a quote; a delimiter inside it does not count.
std::string_view take_quoted(std::string_view& rest, char delimiter) {
  const auto close = rest.find('"', 1);
  const auto field = rest.substr(1, close == std::string_view::npos ? std::string_view::npos : close - 1);
  const auto next = close == std::string_view::npos ? close : rest.find(delimiter, close);
  rest = next == std::string_view::npos ? std::string_view() : rest.substr(next + 1);
  return field;
}

void split_blanks(std::string_view line, std::size_t most, std::vector<std::string_view>& fields) {
  std::size_t at = 0;
  while (fields.size() < most) {
    at = line.find_first_not_of(" \t", at);
    if (at == std::string_view::npos) return;
    const auto end = line.find_first_of(" \t", at);
    fields.push_back(line.substr(at, end == std::string_view::npos ? end : end - at));
    if (end == std::string_view::npos) return;
    at = end;
  }
}

}  // namespace

void split(std::string_view line, char delimiter, std::size_t most, std::vector<std::string_view>& fields) {
  fields.clear();
  if (delimiter == ' ') return split_blanks(line, most, fields);
  const bool quotes = line.find('"') != std::string_view::npos;
  while (fields.size() < most) {
    if (quotes && !line.empty() && line.front() == '"') {
      fields.push_back(trim_blanks(take_quoted(line, delimiter)));
      if (line.data() == nullptr) return;
      continue;
    }
    const auto* end = static_cast<const char*>(std::memchr(line.data(), delimiter, line.size()));
    if (!end) {
      fields.push_back(trim_blanks(line));
      return;
    }
    const auto size = static_cast<std::size_t>(end - line.data());
    fields.push_back(trim_blanks(line.substr(0, size)));
    line.remove_prefix(size + 1);
  }
}

std::size_t count_fields(std::string_view line, char delimiter) {
  if (delimiter != ' ' && line.find('"') == std::string_view::npos)
    return static_cast<std::size_t>(std::count(line.begin(), line.end(), delimiter)) + 1;
  std::vector<std::string_view> fields;
  split(line, delimiter, std::string_view::npos, fields);
  return fields.size();
}

char guess_delimiter(std::string_view line) {
  char best = 0;
  std::ptrdiff_t most = 0;
  for (const char delimiter : {'\t', ';', ','}) {
    const auto count = std::count(line.begin(), line.end(), delimiter);
    if (count > most) {
      most = count;
      best = delimiter;
    }
  }
  return best;
}

bool is_blank(std::string_view field) {
  if (field.empty()) return true;
  if (field.size() > 7) return false;
  for (const std::string_view word : {"N/A", "n/a", "NA", "No Data", "null", "NULL", "None", "-", "--"})
    if (field == word) return true;
  return false;
}

std::optional<double> parse_number(std::string_view field) {
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size() || field.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_seconds_ns(std::string_view field) {
  const bool negative = !field.empty() && field.front() == '-';
  auto digits = field;
  if (negative || (!digits.empty() && digits.front() == '+')) digits.remove_prefix(1);
  const auto dot = digits.find('.');
  const auto whole_text = digits.substr(0, dot);
  std::int64_t whole = 0, fraction = 0;
  const auto plain = [](std::string_view t) { return t.find_first_not_of("0123456789") == std::string_view::npos; };
  const auto fraction_text = dot == std::string_view::npos ? std::string_view() : digits.substr(dot + 1);
  if (digits.empty() || whole_text.empty() || whole_text.size() > 10 || !plain(whole_text) || !plain(fraction_text)) {
    const auto value = parse_number(field);  // an exponent, or something else
    if (!value || !(*value > -9.2e9 && *value < 9.2e9)) return std::nullopt;
    return static_cast<std::int64_t>(*value * 1e9);
  }
  std::from_chars(whole_text.data(), whole_text.data() + whole_text.size(), whole);
  if (whole > 9'200'000'000) return std::nullopt;
  std::int64_t scale = 100'000'000;
  for (const char c : fraction_text.substr(0, 9)) {
    fraction += (c - '0') * scale;
    scale /= 10;
  }
  if (fraction_text.size() > 9 && fraction_text[9] >= '5') ++fraction;
  const auto ns = whole * 1'000'000'000 + fraction;
  return negative ? -ns : ns;
}

}  // namespace quadsonde::ingest::csv
