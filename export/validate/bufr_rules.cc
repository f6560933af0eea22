#include "export/validate/bufr_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "export/bufr/bufr_decoder.h"

namespace quadsonde::product {
namespace {

using ingest::Bytes;
using ingest::Kind;
using Values = std::vector<std::optional<double>>;

// Elements of Table B without their F.
constexpr int height = 7007, pressure = 7004, wind_direction = 11001, wind_speed = 11002, temperature = 12101;

std::size_t number(Bytes bytes, std::size_t at, std::size_t octets) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < octets; ++i) value = value << 8 | bytes[at + i];
  return value;
}

bool stands(Bytes file, std::size_t at, std::string_view mark) {
  return at + mark.size() <= file.size() &&
         std::equal(mark.begin(), mark.end(), file.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char c, std::uint8_t b) { return static_cast<std::uint8_t>(c) == b; });
}

std::size_t next_message(Bytes file, std::size_t from) {
  for (std::size_t at = from; at + 4 <= file.size(); ++at)
    if (stands(file, at, "BUFR")) return at;
  return file.size();
}

/// Editions before 4 leave the century out; BUFR was not exchanged before 1980.
int year_of_century(int year) { return (year % 100 < 80 ? 2000 : 1900) + year % 100; }

class MessageChecker {
 public:
  MessageChecker(Bytes message, std::string where, Findings& found)
      : bytes_(message), where_(std::move(where)), found_(found), edition_(message[7]) {}

  ingest::Result<void> run() {
    if (!sections()) return {};
    const auto content = decode_bufr(bytes_);
    if (!content && content.error().kind == Kind::no_answer) return ingest::fail(content.error());
    if (!content) {
      add(rule("bufr.decode"), content.error().what);
      return {};
    }
    for (const auto& element : *content) by_code_[element.code].push_back(&element);
    identity();
    place_and_time();
    winds(*content);
    levels();
    return {};
  }

 private:
  void add(const Rule* rule, std::string what) { found_.add(rule, where_, std::move(what)); }

  /// Section 0 to 5 by their lengths. False where nothing behind can be trusted.
  bool sections() {
    if (edition_ != 4) {
      add(edition_ == 3 || edition_ == 2 ? rule("bufr.edition-old") : rule("bufr.edition"),
          fmt::format("it is edition {}", edition_));
      if (edition_ < 2 || edition_ > 4) return false;
    }
    const std::size_t end = bytes_.size() - 4, least_first = edition_ == 4 ? 22 : 17;
    std::size_t at = 8;
    const auto section = [&](int which, std::size_t least) -> std::optional<std::size_t> {
      const std::size_t length = at + 3 <= end ? number(bytes_, at, 3) : 0;
      if (length < least || length > end - at) {
        add(rule("bufr.section-length"),
            fmt::format("section {} says {} octets, {} are left", which, length, at < end ? end - at : 0));
        return std::nullopt;
      }
      const auto begin = at;
      at += length;
      return begin;
    };
    const auto first = section(1, least_first);
    if (!first) return false;
    const bool optional_section = (bytes_[*first + (edition_ == 4 ? 9 : 7)] & 0x80) != 0;
    header(*first);
    if (optional_section && !section(2, 4)) return false;
    const auto third = section(3, 9);
    if (!third) return false;
    descriptors(*third, at);
    if (!section(4, 4)) return false;
    if (at != end) add(rule("bufr.section-length"), fmt::format("{} octets stand behind section 4", end - at));
    return true;
  }

  void header(std::size_t at) {
    const bool fourth = edition_ == 4;
    if (bytes_[at + 3] != 0) add(rule("bufr.master-table"), fmt::format("it is {}", bytes_[at + 3]));
    const auto version = bytes_[at + (fourth ? 13 : 10)];
    // 45 is the newest that MET.md has seen; 255 marks none, experimental ones begin far above.
    if (version < 2 || version > 60)
      add(rule("bufr.table-version"), fmt::format("it is {}{}", version, fourth ? "" : " (octet 11 in old editions)"));
    const auto date = at + (fourth ? 15u : 12u);
    const int year = fourth ? static_cast<int>(number(bytes_, date, 2)) : year_of_century(bytes_[date]);
    const auto month = date + (fourth ? 2 : 1);
    const std::chrono::year_month_day day{std::chrono::year(year), std::chrono::month(bytes_[month]),
                                          std::chrono::day(bytes_[month + 1])};
    const bool clock = bytes_[month + 2] < 24 && bytes_[month + 3] < 60 && (!fourth || bytes_[month + 4] < 61);
    if (!day.ok() || !clock || (fourth && (year < 1900 || year > 2200)))
      add(rule("bufr.date"), fmt::format("it is {:04}-{:02}-{:02} {:02}:{:02}", year, bytes_[month], bytes_[month + 1],
                                         bytes_[month + 2], bytes_[month + 3]));
    else
      typical_ =
          std::chrono::sys_days(day).time_since_epoch().count() * 24.0 + bytes_[month + 2] + bytes_[month + 3] / 60.0;
  }

  void descriptors(std::size_t at, std::size_t end) {
    subsets_ = number(bytes_, at + 4, 2);
    if (subsets_ == 0) add(rule("bufr.subsets"), "it has no subset");
    std::size_t count = 0;
    bool local = false;
    for (std::size_t i = at + 7; i + 2 <= end; i += 2) {
      const auto raw = number(bytes_, i, 2);
      const auto f = raw >> 14, x = raw >> 8 & 0x3F, y = raw & 0xFF;
      if (raw == 0 && i + 4 > end) break;  // filled up to an even number
      ++count;
      local = local || ((f == 0 || f == 3) && (x >= 48 || y >= 192));
    }
    if (count == 0) add(rule("bufr.descriptors"), "it has no descriptor");
    if (local) add(rule("bufr.local-descriptor"), "it has descriptors of a centre's own");
  }

  std::vector<const BufrValues*> all_of(int code) const {
    const auto at = by_code_.find(code);
    return at == by_code_.end() ? std::vector<const BufrValues*>{} : at->second;
  }
  bool any_value(int code) const {
    for (const auto* e : all_of(code)) {
      if (e->is_text && !e->text_missing) return true;
      for (const auto& value : e->values)
        if (value) return true;
    }
    return false;
  }
  /// Every value of an element, subset by subset where there are several in its place.
  Values values_of(int code) const {
    Values all;
    for (const auto* e : all_of(code)) all.insert(all.end(), e->values.begin(), e->values.end());
    return all;
  }

  void identity() {
    const bool wigos = any_value(1125) && any_value(1127) && any_value(1128), wmo = any_value(1001) && any_value(1002);
    const bool other = any_value(1008) || any_value(1006) || any_value(1011) || any_value(1007) || any_value(1015) ||
                       any_value(1018) || any_value(1095);
    if (!wigos && !wmo && !other) add(rule("bufr.station"), "nothing in it names who observed");
  }

  void place_and_time() {
    const auto within = [&](int fine, int coarse, double limit) {
      const auto values = values_of(any_value(fine) ? fine : coarse);
      if (!any_value(fine) && !any_value(coarse)) return false;
      return std::all_of(values.begin(), values.end(), [&](const auto& v) { return !v || std::abs(*v) <= limit; });
    };
    if (!within(5001, 5002, 90) || !within(6001, 6002, 180))
      add(rule("bufr.place"), "latitude or longitude are not there, or are none");
    bool whole = true;
    for (const int code : {4001, 4002, 4003, 4004}) whole = whole && any_value(code);
    if (!whole) {
      add(rule("bufr.time"), "year, month, day or hour are not there");
      return;
    }
    const auto first = [&](int code) {
      const auto all = values_of(code);
      const auto at = std::find_if(all.begin(), all.end(), [](const auto& v) { return v.has_value(); });
      return at != all.end() && std::abs(**at) < 10000 ? static_cast<int>(**at) : -1;
    };
    const std::chrono::year_month_day day{std::chrono::year(first(4001)),
                                          std::chrono::month(static_cast<unsigned>(first(4002))),
                                          std::chrono::day(static_cast<unsigned>(first(4003)))};
    if (!day.ok()) {
      add(rule("bufr.time"), fmt::format("{}-{}-{} is no day", first(4001), first(4002), first(4003)));
      return;
    }
    const double hours = std::chrono::sys_days(day).time_since_epoch().count() * 24.0 + first(4004);
    if (typical_ && std::abs(hours - *typical_) > 24)
      add(rule("bufr.time-typical"), fmt::format("they are {:.0f} hours apart", std::abs(hours - *typical_)));
  }

  void winds(const BufrContent& content) {
    for (std::size_t i = 0; i < content.size(); ++i) {
      if (content[i].code != wind_direction) continue;
      const auto& directions = content[i].values;
      const auto speed = std::find_if(content.begin() + static_cast<std::ptrdiff_t>(i), content.end(),
                                      [](const auto& e) { return e.code == wind_speed; });
      for (std::size_t k = 0; k < directions.size(); ++k) {
        if (directions[k] && (*directions[k] < 0 || *directions[k] > 360))
          return add(rule("bufr.direction"), fmt::format("a direction is {}", *directions[k]));
        if (speed == content.end() || speed->values.size() != directions.size()) continue;
        const auto& v = speed->values[k];
        if (v.has_value() != directions[k].has_value())
          return add(rule("bufr.half-a-wind"), "a wind has only one of speed and direction");
        if (v && (*v == 0) != (*directions[k] == 0))
          return add(rule("bufr.calm"),
                     fmt::format("a speed of {} m/s stands with a direction of {}", *v, *directions[k]));
      }
    }
    for (const int code : {11110, 11111, 11112})
      for (const auto& value : values_of(code))
        if (value && *value < 0) return add(rule("bufr.uncertainty"), fmt::format("one is {} m/s", *value));
    const auto impossible = [&](int code, double least) {
      const auto all = values_of(code);
      return std::any_of(all.begin(), all.end(), [&](const auto& v) { return v && *v < least; });
    };
    if (impossible(temperature, 100) || impossible(pressure, 1))
      add(rule("bufr.not-missing"), "the air has 0 K or 0 Pa somewhere");
  }

  void levels() {
    const auto heights = values_of(height);
    if (!all_of(31001).empty()) {
      const auto counts = values_of(31001);
      if (std::all_of(counts.begin(), counts.end(), [](const auto& n) { return !n || *n == 0; }))
        add(rule("bufr.levels"), "it has no level");
    }
    if (subsets_ > 1) return;  // each begins from the ground again
    std::optional<double> last;
    for (const auto& h : heights) {
      if (h && last && *h <= *last) return add(rule("bufr.heights"), fmt::format("{} m stands behind {} m", *h, *last));
      if (h) last = h;
    }
  }

  Bytes bytes_;
  std::string where_;
  Findings& found_;
  int edition_;
  std::size_t subsets_ = 0;
  std::optional<double> typical_;  ///< hours since 1970
  std::map<int, std::vector<const BufrValues*>> by_code_;
};

}  // namespace

ingest::Result<void> check_bufr(Bytes file, Findings& found) {
  std::size_t at = next_message(file, 0), behind = 0;
  if (at == file.size()) found.add(rule("bufr.start"), "", "there is no message in it");
  for (int count = 1; at < file.size(); ++count) {
    const auto where = fmt::format("message {} at byte {}", count, at);
    if (at > behind) found.add(rule("bufr.between"), where, fmt::format("{} bytes stand before it", at - behind));
    const std::size_t length = at + 8 <= file.size() ? number(file, at + 4, 3) : 0;
    if (length < 8 + 4 || length > file.size() - at) {
      found.add(rule("bufr.length"), where, fmt::format("it says {} bytes, {} are there", length, file.size() - at));
      behind = at + 4;
    } else if (!stands(file, at + length - 4, "7777")) {
      found.add(rule("bufr.end"), where, "no 7777 stands where its length ends");
      behind = at + 4;
    } else {
      if (auto done = MessageChecker(file.subspan(at, length), where, found).run(); !done) return done;
      behind = at + length;
    }
    at = next_message(file, behind);
  }
  if (behind < file.size() && behind > 0 && stands(file, behind - 4, "7777"))
    found.add(rule("bufr.between"), fmt::format("byte {}", behind),
              fmt::format("{} bytes stand behind the last message", file.size() - behind));
  return {};
}

}  // namespace quadsonde::product
