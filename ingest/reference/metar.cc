#include "ingest/reference/metar.h"

#include <cctype>
#include <charconv>
#include <cmath>

namespace quadsonde::ingest {
namespace {

bool digits(std::string_view text) {
  for (const char c : text)
    if (c < '0' || c > '9') return false;
  return !text.empty();
}

int number(std::string_view text) {
  int value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// DDHHMMZ with the year and month that bring it closest to `near`.
std::optional<UtcTime> metar_time(std::string_view token, std::optional<UtcTime> near) {
  using namespace std::chrono;
  if (token.size() != 7 || token.back() != 'Z' || !digits(token.substr(0, 6)) || !near) return std::nullopt;
  const int day_of_month = number(token.substr(0, 2)), hour = number(token.substr(2, 2)), minute = number(token.substr(4, 2));
  if (hour > 23 || minute > 59) return std::nullopt;
  const year_month_day around{floor<days>(sys_time<nanoseconds>(nanoseconds(near->ns)))};
  std::optional<UtcTime> best;
  for (const int shift : {-1, 0, 1}) {
    const auto month_of = year_month(around.year(), around.month()) + months(shift);
    const year_month_day date(month_of.year(), month_of.month(), day(static_cast<unsigned>(day_of_month)));
    if (!date.ok()) continue;
    const auto t = duration_cast<nanoseconds>(sys_days(date).time_since_epoch() + hours(hour) + minutes(minute)).count();
    if (!best || std::llabs(t - near->ns) < std::llabs(best->ns - near->ns)) best = UtcTime{t};
  }
  return best;
}

struct Unit {
  std::string_view name;
  double metres_per_second;
};
constexpr Unit units[] = {{"KT", knot}, {"MPS", 1.0}, {"KMH", 1 / 3.6}};

/// ff or fff, P before it meaning "above".
bool take_speed(std::string_view& text, double& value) {
  if (!text.empty() && text[0] == 'P') text.remove_prefix(1);
  std::size_t n = 0;
  while (n < text.size() && n < 3 && std::isdigit(static_cast<unsigned char>(text[n]))) ++n;
  if (n < 2) return false;
  value = number(text.substr(0, n));
  text.remove_prefix(n);
  return true;
}

bool read_wind_group(std::string_view token, ReferenceWind& wind) {
  const Unit* unit = nullptr;
  for (const auto& u : units)
    if (token.size() > u.name.size() && token.substr(token.size() - u.name.size()) == u.name) unit = &u;
  if (!unit) return false;
  token.remove_suffix(unit->name.size());
  if (token.size() < 5) return false;
  const auto direction = token.substr(0, 3);
  token.remove_prefix(3);
  const bool variable = direction == "VRB";
  if (!variable && !digits(direction)) return false;
  double speed = 0, gust = 0;
  if (!take_speed(token, speed)) return false;
  const bool gusts = !token.empty() && token[0] == 'G';
  if (gusts) {
    token.remove_prefix(1);
    if (!take_speed(token, gust)) return false;
    wind.gust = gust * unit->metres_per_second;
  }
  if (!token.empty()) return false;
  wind.speed_min = wind.speed_max = speed * unit->metres_per_second;
  wind.calm = speed == 0;
  const int degrees = variable ? 0 : number(direction);
  if (degrees > 360) return false;
  if (!variable && !wind.calm) wind.from_deg = degrees == 0 ? 360 : degrees;
  // Rounded to whole units and tens of degrees.
  wind.speed_sd = unit->metres_per_second / std::sqrt(12.0);
  wind.from_sd_deg = 10 / std::sqrt(12.0);
  return true;
}

bool read_sector(std::string_view token, ReferenceWind& wind) {
  if (token.size() != 7 || token[3] != 'V' || !digits(token.substr(0, 3)) || !digits(token.substr(4))) return false;
  wind.sector_deg = {number(token.substr(0, 3)), number(token.substr(4))};
  return true;
}

std::string_view take_token(std::string_view& text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  std::size_t n = 0;
  while (n < text.size() && !blank(text[n])) ++n;
  const auto token = text.substr(0, n);
  text.remove_prefix(n);
  return token;
}

}  // namespace

std::optional<ReferenceWind> parse_metar(std::string_view report, std::optional<UtcTime> near) {
  ReferenceWind wind;
  wind.height = GroundHeight{10};
  bool have_time = false;
  for (auto token = take_token(report); !token.empty(); token = take_token(report)) {
    if (token.back() == '=') token.remove_suffix(1);
    if (token == "RMK") break;
    if (token == "METAR" || token == "SPECI" || token == "COR" || token == "AUTO") continue;
    if (token == "NIL") return std::nullopt;
    if (!have_time) {
      if (const auto time = metar_time(token, near)) {
        wind.utc = *time;
        have_time = true;
      } else if (wind.station.empty() && token.size() == 4) {
        wind.station = token;
      }
      continue;
    }
    if (!wind.speed_min) {
      read_wind_group(token, wind);
      continue;
    }
    // The sector, if any, follows the wind directly.
    read_sector(token, wind);
    break;
  }
  if (!have_time || !wind.speed_min) return std::nullopt;
  return wind;
}

}  // namespace quadsonde::ingest
