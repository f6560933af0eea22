#include "ingest/csv/time_text.h"

#include <charconv>
#include <chrono>
#include <cmath>

#include "ingest/csv/table.h"

namespace quadsonde::ingest::csv {
namespace {

bool take_digits(std::string_view& text, std::size_t most, int& value) {
  std::size_t count = 0;
  value = 0;
  while (count < most && count < text.size() && text[count] >= '0' && text[count] <= '9')
    value = value * 10 + (text[count++] - '0');
  text.remove_prefix(count);
  return count > 0;
}

struct Fields {
  int year = 1970, month = 1, day = 1, hour = 0, minute = 0, second = 0;
  std::int64_t fraction_ns = 0;
  std::optional<bool> afternoon;
  std::optional<int> zone_s;
};

std::optional<UtcTime> assemble(Fields f, int zone_s) {
  using namespace std::chrono;
  if (f.afternoon) f.hour = f.hour % 12 + (*f.afternoon ? 12 : 0);
  const year_month_day date{year(f.year), month(static_cast<unsigned>(f.month)), day(static_cast<unsigned>(f.day))};
  if (!date.ok() || f.year < 1700 || f.year > 2250 || f.hour > 24 || f.minute > 59 || f.second > 60)
    return std::nullopt;
  const std::int64_t s = sys_days(date).time_since_epoch().count() * 86400LL + f.hour * 3600 + f.minute * 60 + f.second;
  return UtcTime{(s - f.zone_s.value_or(zone_s)) * 1'000'000'000 + f.fraction_ns};
}

bool take_second(std::string_view& text, Fields& f) {
  if (!take_digits(text, 2, f.second)) return false;
  if (text.empty() || (text[0] != '.' && text[0] != ',')) return true;
  text.remove_prefix(1);
  std::int64_t scale = 100'000'000;
  while (!text.empty() && text[0] >= '0' && text[0] <= '9') {
    f.fraction_ns += (text[0] - '0') * scale;
    scale /= 10;
    text.remove_prefix(1);
  }
  return true;
}

bool take_half(std::string_view& text, Fields& f) {
  if (text.size() < 2 || (text[1] != 'M' && text[1] != 'm')) return false;
  if (text[0] == 'A' || text[0] == 'a') f.afternoon = false;
  if (text[0] == 'P' || text[0] == 'p') f.afternoon = true;
  text.remove_prefix(2);
  return f.afternoon.has_value();
}

bool take_field(char kind, std::string_view& text, Fields& f) {
  switch (kind) {
    case 'Y':
      return take_digits(text, 4, f.year);
    case 'y': {
      const bool taken = take_digits(text, 2, f.year);
      f.year += 2000;
      return taken;
    }
    case 'm':
      return take_digits(text, 2, f.month);
    case 'd':
      return take_digits(text, 2, f.day);
    case 'H':
    case 'I':
      return take_digits(text, 2, f.hour);
    case 'M':
      return take_digits(text, 2, f.minute);
    case 'S':
      return take_second(text, f);
    case 'p':
      return take_half(text, f);
    case 'z': {
      const auto end = text.find(' ');
      f.zone_s = parse_zone(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end);
      return f.zone_s.has_value();
    }
    default:
      return false;
  }
}

std::optional<UtcTime> parse_pattern(std::string_view text, std::string_view pattern, int zone_s) {
  Fields f;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '%' && i + 1 < pattern.size()) {
      if (!take_field(pattern[++i], text, f)) return std::nullopt;
    } else {
      if (text.empty() || text[0] != pattern[i]) return std::nullopt;
      text.remove_prefix(1);
    }
  }
  return trim(text).empty() ? assemble(f, zone_s) : std::nullopt;
}

bool names_zone(std::string_view text) {
  return text.size() > 10 && text.substr(10).find_first_of("Zz+-") != std::string_view::npos;
}

std::optional<UtcTime> parse_unix(std::string_view text, double unit_s) {
  if (unit_s == 1) {
    const auto ns = parse_seconds_ns(text);
    return ns ? std::optional(UtcTime{*ns}) : std::nullopt;
  }
  std::int64_t whole = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  const std::int64_t unit_ns = unit_s == 1e-3 ? 1'000'000 : 1'000;
  const std::int64_t most = 9'200'000'000'000'000'000 / unit_ns;
  if (error == std::errc() && end == text.data() + text.size() && whole > -most && whole < most)
    return UtcTime{whole * unit_ns};
  const auto value = parse_number(text);
  if (!value || !(std::abs(*value * unit_s) < 9.2e9)) return std::nullopt;
  return UtcTime{static_cast<std::int64_t>(*value * unit_s * 1e9)};
}

}  // namespace

std::optional<int> parse_zone(std::string_view text) {
  text = trim(text);
  if (text == "Z" || text == "z" || text == "UTC" || text == "GMT") return 0;
  if (text.size() < 2 || (text[0] != '+' && text[0] != '-')) return std::nullopt;
  const int sign = text[0] == '-' ? -1 : 1;
  text.remove_prefix(1);
  int hours = 0, minutes = 0;
  if (!take_digits(text, 2, hours)) return std::nullopt;
  if (!text.empty() && text[0] == ':') text.remove_prefix(1);
  if (!text.empty() && (!take_digits(text, 2, minutes) || !text.empty())) return std::nullopt;
  if (hours > 15 || minutes > 59) return std::nullopt;
  return sign * (hours * 3600 + minutes * 60);
}

bool is_time_format(std::string_view format) {
  return format == "iso" || format == "unix" || format == "unix_ms" || format == "unix_us" ||
         format.find('%') != std::string_view::npos;
}

std::optional<UtcTime> parse_time(std::string_view text, const TimeFormat& format) {
  text = trim(text);
  if (format.format == "unix") return parse_unix(text, 1);
  if (format.format == "unix_ms") return parse_unix(text, 1e-3);
  if (format.format == "unix_us") return parse_unix(text, 1e-6);
  if (format.format != "iso") return parse_pattern(text, format.format, format.zone_s);
  auto utc = parse_iso8601(text);
  if (utc && !names_zone(text)) utc->ns -= std::int64_t{format.zone_s} * 1'000'000'000;
  return utc;
}

}  // namespace quadsonde::ingest::csv
