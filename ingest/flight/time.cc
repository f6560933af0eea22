#include "ingest/flight/time.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace quadsonde::ingest {

Duration seconds(double s) {
  const double ns = s * 1e9;
  if (std::isnan(ns)) return Duration(0);
  constexpr double most = 9.2e18;
  return Duration(static_cast<std::int64_t>(std::llround(std::clamp(ns, -most, most))));
}

std::string to_iso8601(UtcTime t, int fraction_digits) {
  using namespace std::chrono;
  std::int64_t step = 1'000'000'000;
  for (int i = 0; i < fraction_digits; ++i) step /= 10;
  // Floored, not rounded: a time stamp never names an instant that had not come yet.
  const auto since = nanoseconds(t.ns);
  const auto day = floor<days>(since);
  const year_month_day date{sys_days(day)};
  const auto of_day = (since - day).count();
  const auto second = of_day / 1'000'000'000;
  std::string text = fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", static_cast<int>(date.year()),
                                 static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), second / 3600,
                                 second / 60 % 60, second % 60);
  if (fraction_digits > 0) text += fmt::format(".{:0{}}", of_day % 1'000'000'000 / step, fraction_digits);
  return text + "Z";
}

namespace {
/// Takes exactly `digits` digits off the front of the text.
bool take_number(std::string_view& text, std::size_t digits, int& value) {
  if (text.size() < digits) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + digits, value);
  if (error != std::errc() || end != text.data() + digits || text[0] == '-') return false;
  text.remove_prefix(digits);
  return true;
}
bool take_char(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text[0]) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}
std::int64_t take_fraction_ns(std::string_view& text) {
  std::int64_t ns = 0, scale = 100'000'000;
  while (!text.empty() && text[0] >= '0' && text[0] <= '9') {
    ns += (text[0] - '0') * scale;
    scale /= 10;
    text.remove_prefix(1);
  }
  return ns;
}
std::optional<int> take_zone_s(std::string_view& text) {
  if (text.empty() || take_char(text, "Zz")) return 0;
  const int sign = text[0] == '-' ? -1 : 1;
  int hours = 0, minutes = 0;
  if (!take_char(text, "+-") || !take_number(text, 2, hours)) return std::nullopt;
  take_char(text, ":");
  if (!text.empty() && !take_number(text, 2, minutes)) return std::nullopt;
  if (hours > 23 || minutes > 59) return std::nullopt;
  return sign * (hours * 3600 + minutes * 60);
}
}  // namespace

std::optional<UtcTime> parse_iso8601(std::string_view text) {
  using namespace std::chrono;
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  int y = 0, mo = 0, d = 0, h = 0, mi = 0, s = 0;
  std::int64_t fraction = 0;
  if (!take_number(text, 4, y) || !take_char(text, "-/") || !take_number(text, 2, mo) || !take_char(text, "-/") ||
      !take_number(text, 2, d))
    return std::nullopt;
  const year_month_day date{year(y), month(static_cast<unsigned>(mo)), day(static_cast<unsigned>(d))};
  if (!date.ok() || y < 1700 || y > 2250) return std::nullopt;
  if (take_char(text, "T ")) {
    if (!take_number(text, 2, h) || !take_char(text, ":") || !take_number(text, 2, mi)) return std::nullopt;
    if (take_char(text, ":") && !take_number(text, 2, s)) return std::nullopt;
    if (h > 24 || mi > 59 || s > 60 || (h == 24 && (mi > 0 || s > 0))) return std::nullopt;
    if (take_char(text, ".,")) fraction = take_fraction_ns(text);
    take_char(text, " ");
  }
  const auto zone = take_zone_s(text);
  if (!zone || !text.empty()) return std::nullopt;
  const std::int64_t whole = sys_days(date).time_since_epoch().count() * 86400LL + h * 3600 + mi * 60 + s - *zone;
  return UtcTime{whole * 1'000'000'000 + fraction};
}

namespace {
constexpr std::int64_t gps_epoch_unix_s = 315964800;
struct LeapRow {
  std::int64_t from_unix_s;
  int gps_minus_utc;
};
constexpr LeapRow leap_rows[] = {
    {315964800, 0},   {362793600, 1},   {394329600, 2},   {425865600, 3},   {489024000, 4},   {567993600, 5},
    {631152000, 6},   {662688000, 7},   {709948800, 8},   {741484800, 9},   {773020800, 10},  {820454400, 11},
    {867715200, 12},  {915148800, 13},  {1136073600, 14}, {1230768000, 15}, {1341100800, 16}, {1435708800, 17},
    {1483228800, 18},
};
}  // namespace

int gps_minus_utc_s(std::int64_t gps_s) {
  int leap = 0;
  for (const auto& row : leap_rows)
    if (row.from_unix_s + row.gps_minus_utc <= gps_s + gps_epoch_unix_s) leap = row.gps_minus_utc;
  return leap;
}

UtcTime utc_from_gps(int week, std::int64_t time_of_week_ms) {
  const std::int64_t gps_ms = week * 604'800'000LL + time_of_week_ms;
  const int leap = gps_minus_utc_s(gps_ms / 1000);
  return {(gps_epoch_unix_s * 1000 + gps_ms - leap * 1000LL) * 1'000'000};
}

std::optional<Latency> latency_of(std::vector<double> ages_s) {
  const auto all = ages_s.size();
  constexpr double most = 10;
  std::erase_if(ages_s, [](double age) { return !(age >= 0 && age <= most); });
  if (ages_s.empty() || 2 * ages_s.size() < all) return std::nullopt;
  const auto middle = ages_s.begin() + static_cast<std::ptrdiff_t>(ages_s.size() / 2);
  std::nth_element(ages_s.begin(), middle, ages_s.end());
  return Latency{*middle, false};
}

// As LogTimes, since their difference is defined for all that a damaged log may hold.
void ClockEstimator::add(LogTime log, UtcTime utc) { offsets_.push_back(LogTime{utc.ns} - log); }

std::optional<Latency> ClockEstimator::latency() const {
  constexpr std::size_t window = 100, fewest = 20;
  if (offsets_.size() < fewest) return std::nullopt;
  std::vector<double> ages;
  const std::size_t windows = std::max<std::size_t>(1, offsets_.size() / window);
  for (std::size_t w = 0; w < windows; ++w) {
    const auto begin = offsets_.begin() + static_cast<std::ptrdiff_t>(offsets_.size() * w / windows);
    const auto end = offsets_.begin() + static_cast<std::ptrdiff_t>(offsets_.size() * (w + 1) / windows);
    // A wrong date before the fix is no quick sample: the quickest among those within 1 s of the window's median.
    std::vector<Duration> sorted(begin, end);
    std::sort(sorted.begin(), sorted.end());
    const auto from_median = [&](Duration offset) {
      return to_seconds(LogTime{offset.count()} - LogTime{sorted[sorted.size() / 2].count()});
    };
    double quickest = 0;
    for (const auto offset : sorted)
      if (const double ahead = from_median(offset); ahead <= 1) quickest = ahead;
    for (const auto offset : sorted) ages.push_back(quickest - from_median(offset));
  }
  auto latency = latency_of(std::move(ages));
  if (latency) latency->at_least = true;
  return latency;
}

Clock ClockEstimator::estimate(std::string source) const {
  Clock clock;
  if (offsets_.empty()) return clock;
  auto sorted = offsets_;
  std::sort(sorted.begin(), sorted.end());
  const auto middle = sorted[sorted.size() / 2];
  double sum2 = 0;
  std::size_t near = 0;
  for (const auto offset : sorted) {
    const double off = to_seconds(LogTime{offset.count()} - LogTime{middle.count()});
    if (std::abs(off) > 1) continue;
    sum2 += off * off;
    ++near;
  }
  clock.utc_minus_log = middle;
  // The receiver's latency (tens to 200 ms) does not show in the spread.
  clock.uncertainty_s = std::hypot(std::sqrt(sum2 / static_cast<double>(std::max<std::size_t>(near, 1))), 0.1);
  clock.source = std::move(source);
  return clock;
}

}  // namespace quadsonde::ingest
