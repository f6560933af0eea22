#include "ingest/csv/flight_from_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ingest/csv/decompress.h"
#include "ingest/csv/row_streams.h"
#include "ingest/csv/table.h"
#include "ingest/csv/table_layout.h"
#include "ingest/csv/time_text.h"

namespace quadsonde::ingest {
namespace csv {
namespace {

/// 146 years: no clock of a logger is further from its origin, and differences of two such times still fit.
constexpr std::int64_t most_ns = 4'600'000'000'000'000'000;

/// What became of the cells of one bound column.
struct CellCount {
  std::uint64_t numbers = 0, wrong = 0, first_wrong_line = 0;
};

class TableReader {
 public:
  TableReader(const Layout& layout, const std::string& file, bool cut)
      : layout_(layout),
        file_(file),
        cut_(cut),
        streams_(layout, file, flight_),
        values_(layout.bound.size()),
        cells_(layout.bound.size()) {
    for (std::size_t i = 0; i < layout.bound.size(); ++i) {
      const auto& column = layout.bound[i];
      if (column.canonical == "time_s")
        time_ = static_cast<int>(i);
      else if (column.canonical == "utc")
        utc_ = static_cast<int>(i);
      else if (column.canonical == "event")
        event_ = static_cast<int>(i);
      for (const auto field : column.fields) needed_ = std::max(needed_, field + 1);
    }
    const auto format_of = [&](int slot) {
      const auto& own = layout.bound[static_cast<std::size_t>(slot)].source->format;
      const auto& shared = layout.map->time_format;
      return TimeFormat{!own.empty() ? own : !shared.empty() ? shared : "iso", layout.map->zone_s};
    };
    if (utc_ >= 0) utc_format_ = format_of(utc_);
    if (time_ >= 0) time_is_text_ = !layout.bound[static_cast<std::size_t>(time_)].source->format.empty();
    if (time_is_text_) time_format_ = format_of(time_);
  }

  void read(Bytes bytes) {
    const auto full = full_row(bytes);
    Lines lines(bytes, layout_.data_at, layout_.header_line);
    std::string_view line;
    while (lines.next(line)) {
      if (is_comment(line)) continue;
      // A field that is missing somewhere in a row would shift all the others.
      const bool complete = count_fields(line, layout_.delimiter) >= full && (lines.ended() || !cut_);
      if (complete) {
        split(line, layout_.delimiter, needed_, fields_);
        take_row(lines.number());
      } else if (!lines.ended() && !layout_.map->skip_other_rows) {
        problems_.push_back({Kind::truncated,
                             "the table ends in the middle of a row",
                             {file_, {}, lines.number(), {}},
                             "the rows before it are used"});
      } else if (short_rows_++ == 0) {
        first_short_row_ = lines.number();
      }
    }
  }

  void finish(LogContent& content) {
    streams_.finish(content.details);
    report_cells(content);
    for (auto& problem : problems_) flight_.problems.push_back(std::move(problem));
    estimate_clock();
    take_vehicle();
    content.messages = rows_;
    if (other_rows_ + short_rows_ > 0)
      content.details.emplace_back("rows not used", fmt::format("{}", other_rows_ + short_rows_));
    if (rows_ > 0) content.flights.push_back(std::move(flight_));
  }

 private:
  /// Fields of a full row: those of the header, or fewer where none of the first rows has so many (some writers leave
  /// out empty cells at the end).
  std::size_t full_row(Bytes bytes) const {
    Lines lines(bytes, layout_.data_at, layout_.header_line);
    std::string_view line;
    std::size_t most = 0;
    for (int rows = 0; rows < 20 && lines.next(line);) {
      if (is_comment(line)) continue;
      most = std::max(most, count_fields(line, layout_.delimiter));
      ++rows;
    }
    return std::clamp(most, std::min(needed_, layout_.names.size()), layout_.names.size());
  }

  bool is_comment(std::string_view line) const {
    const auto& mark = layout_.map->comment;
    return line.empty() || (!mark.empty() && line.substr(0, mark.size()) == mark);
  }

  /// The text of a bound column in this row; several columns are joined by a blank.
  std::string_view text(int slot) {
    const auto& places = layout_.bound[static_cast<std::size_t>(slot)].fields;
    const auto field = [&](std::size_t i) { return i < fields_.size() ? fields_[i] : std::string_view(); };
    if (places.size() == 1) return field(places[0]);
    joined_.clear();
    for (const auto place : places) {
      if (!joined_.empty()) joined_ += ' ';
      joined_ += field(place);
    }
    return joined_;
  }

  std::optional<LogTime> row_time() {
    const auto cell = text(time_);
    if (time_is_text_) {
      const auto utc = parse_time(cell, time_format_);
      return utc ? std::optional(LogTime{utc->ns}) : std::nullopt;
    }
    const auto& source = *layout_.bound[static_cast<std::size_t>(time_)].source;
    if (source.scale == 1 && source.offset == 0) {
      const auto ns = parse_seconds_ns(cell);
      return ns ? std::optional(LogTime{*ns}) : std::nullopt;
    }
    const auto number = parse_number(cell);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    return LogTime{seconds(*number * source.scale + source.offset).count()};
  }

  void take_row(std::uint64_t line) {
    Row row;
    row.line = line;
    std::optional<UtcTime> utc;
    if (utc_ >= 0) utc = parse_time(text(utc_), utc_format_);
    const auto time = time_ >= 0 ? row_time() : utc ? std::optional(LogTime{utc->ns}) : std::nullopt;
    if (!time || time->ns < -most_ns || time->ns > most_ns) {
      if (other_rows_++ == 0) first_other_row_ = line;
      return;
    }
    row.time = *time;
    if (rows_ > 0 && last_time_ - *time > seconds(1) && steps_back_++ == 0) first_step_back_ = line;
    last_time_ = *time;
    ++rows_;
    if (utc) note_utc(*time, *utc);
    for (std::size_t i = 0; i < values_.size(); ++i) take_cell(i, line);
    if (event_ >= 0) row.event = text(event_);
    row.values = &values_;
    streams_.add(row);
  }

  void take_cell(std::size_t i, std::uint64_t line) {
    auto& value = values_[i];
    value = std::numeric_limits<double>::quiet_NaN();
    const int slot = static_cast<int>(i);
    if (slot == time_ || slot == utc_ || slot == event_) {
      ++cells_[i].numbers;
      return;
    }
    const auto cell = text(slot);
    if (is_blank(cell)) return;
    const auto& source = *layout_.bound[i].source;
    const auto number = parse_number(cell);
    if (number && std::isfinite(*number)) {
      value = *number * source.scale + source.offset;
      ++cells_[i].numbers;
    } else if (cells_[i].wrong++ == 0) {
      cells_[i].first_wrong_line = line;
    }
  }

  void report_cells(LogContent& content) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto& count = cells_[i];
      const auto name = fmt::format("{}", fmt::join(layout_.bound[i].source->columns, " "));
      content.topics.push_back({name, count.numbers});
      if (count.wrong > 0)
        problems_.push_back({Kind::damaged,
                             fmt::format("{} of {} values of column {} are not numbers", count.wrong,
                                         count.wrong + count.numbers, name),
                             {file_, {}, count.first_wrong_line, name},
                             "they are left out; the rest is used"});
    }
    if (other_rows_ > 0 && !layout_.map->skip_other_rows)
      problems_.push_back({Kind::damaged,
                           fmt::format("{} rows have no time that can be read", other_rows_),
                           {file_, {}, first_other_row_, {}},
                           "they are left out; see [read] time_format of a map"});
    if (short_rows_ > 0 && !layout_.map->skip_other_rows)
      problems_.push_back({Kind::damaged,
                           fmt::format("{} rows have fewer fields than the header", short_rows_),
                           {file_, {}, first_short_row_, {}},
                           "they are left out, since a missing field shifts the others"});
    if (steps_back_ > 0)
      problems_.push_back({Kind::doubtful,
                           fmt::format("the time steps back by more than 1 s in {} places", steps_back_),
                           {file_, {}, first_step_back_, {}},
                           "the rows are sorted; if these are several flights, split the table"});
  }

  void note_utc(LogTime t, UtcTime utc) {
    if (utc.ns < 0 || utc.ns > most_ns) return;
    clock_.add(t, utc);
    whole_seconds_ = whole_seconds_ && utc.ns % 1'000'000'000 == 0;
  }

  void estimate_clock() {
    const auto& source =
        utc_ >= 0 ? layout_.bound[static_cast<std::size_t>(utc_)].source->columns.front() : std::string();
    flight_.clock = clock_.estimate("column " + source);
    if (!flight_.clock.utc_minus_log || time_ < 0 || !whole_seconds_) return;
    // Times cut to whole seconds lie half a second early on average.
    *flight_.clock.utc_minus_log += std::chrono::milliseconds(500);
    flight_.clock.source += ", whole seconds";
  }

  void take_vehicle() {
    const auto& map = *layout_.map;
    auto& vehicle = flight_.vehicle;
    vehicle.name = map.vehicle_name;
    for (const auto& [key, value] : layout_.preamble)
      if (!map.vehicle_name_from.empty() && key == map.vehicle_name_from) vehicle.name = value;
    vehicle.autopilot = map.autopilot;
    if (map.multirotor) vehicle.airframe = Airframe::multirotor;
  }

  const Layout& layout_;
  const std::string& file_;
  bool cut_;
  Flight flight_;
  RowStreams streams_;
  std::vector<double> values_;
  std::vector<CellCount> cells_;
  std::vector<std::string_view> fields_;
  std::string joined_;
  std::vector<Problem> problems_;
  int time_ = -1, utc_ = -1, event_ = -1;
  std::size_t needed_ = 0;
  TimeFormat utc_format_, time_format_;
  bool time_is_text_ = false;
  ClockEstimator clock_;
  bool whole_seconds_ = true;
  LogTime last_time_;
  std::uint64_t rows_ = 0, other_rows_ = 0, first_other_row_ = 0, steps_back_ = 0, first_step_back_ = 0;
  std::uint64_t short_rows_ = 0, first_short_row_ = 0;
};

void describe(const Layout& layout, LogContent& content) {
  content.details.emplace_back("map", layout.map->name);
  if (!layout.map->note.empty()) content.details.emplace_back("map note", layout.map->note);
  if (layout.map->magnetic_heading) content.details.emplace_back("heading", "magnetic");
  std::string unused;
  for (std::size_t i = 0; i < layout.names.size(); ++i) {
    const auto uses = [&](const BoundColumn& c) {
      return std::find(c.fields.begin(), c.fields.end(), i) != c.fields.end();
    };
    if (std::none_of(layout.bound.begin(), layout.bound.end(), uses))
      unused += (unused.empty() ? "" : ", ") + layout.names[i];
  }
  if (!unused.empty()) content.details.emplace_back("columns not used", unused);
  content.details.emplace_back("map_toml", used_map(layout));
}

}  // namespace
}  // namespace csv

Result<LogContent> read_csv(Bytes bytes, const std::string& file_name, const CsvReadSettings& settings) {
  LogContent content;
  content.format = "csv";
  csv::Decompressed plain;
  if (csv::is_compressed(bytes)) {
    auto result = csv::decompress(bytes, file_name);
    if (!result) return fail(std::move(result.error()));
    plain = std::move(*result);
    bytes = plain.bytes;
    if (plain.cut) content.problems.push_back(*plain.cut);
  }
  const auto layout = csv::find_layout(bytes, file_name, settings.map ? &*settings.map : nullptr);
  if (!layout) return fail(layout.error());
  csv::describe(*layout, content);
  csv::TableReader reader(*layout, file_name, plain.cut.has_value());
  reader.read(bytes);
  reader.finish(content);
  if (settings.mode == Reading::strict) {
    if (!content.problems.empty()) return fail(content.problems.front());
    if (!content.flights.empty() && !content.flights[0].problems.empty())
      return fail(content.flights[0].problems.front());
  }
  if (content.flights.empty())
    return fail(Kind::missing, "the table has a header but no row with a time that can be read",
                {file_name, {}, layout->header_line, {}}, "check the table, or time_format in [read] of a map");
  return content;
}

bool looks_like_table(Bytes bytes) { return csv::find_layout(bytes, "", nullptr).has_value(); }

}  // namespace quadsonde::ingest
