#include "ingest/reference/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "ingest/reference/metar.h"
#include "ingest/reference/text_table.h"

namespace quadsonde::ingest {
namespace {

using Cells = std::vector<std::string_view>;

enum class Layout { plain_table, iem, raw_list, none };

bool digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// A line with the time of a report, DDHHMMZ, among its first words.
bool is_report(std::string_view line) {
  for (int word = 0; word < 7; ++word) {
    const auto from = line.find_first_not_of(" \t\r,\"");
    if (from == std::string_view::npos) return false;
    line.remove_prefix(from);
    const auto token = line.substr(0, line.find_first_of(" \t\r,\""));
    if (token.size() == 7 && token.back() == 'Z' && digits(token.substr(0, 6))) return true;
    line.remove_prefix(token.size());
  }
  return false;
}

struct Table {
  TextLines lines;
  char delimiter = ',';
  Cells header;
  Layout layout = Layout::none;
};

Table table_of(Bytes bytes) {
  Table t;
  t.lines = split_lines(as_text(bytes));
  if (t.lines.text.empty()) return t;
  t.delimiter = t.lines.text[0].find('\t') != std::string_view::npos ? '\t' : ',';
  t.header = split_cells(t.lines.text[0], t.delimiter);
  if (column(t.header, "utc") && (column(t.header, "speed_min_m_s") || column(t.header, "speed_max_m_s")))
    t.layout = Layout::plain_table;
  else if (column(t.header, "station") && column(t.header, "valid"))
    t.layout = Layout::iem;
  else if (std::any_of(t.lines.text.begin(), t.lines.text.end(), is_report))
    t.layout = Layout::raw_list;
  return t;
}

Problem bad_line(const std::string& file, std::uint64_t line, std::string what) {
  return {Kind::damaged, std::move(what), {file, {}, line, {}}, "the line was left out"};
}

/// Direction of a report as we keep it: 0 < d <= 360.
std::optional<double> kept_direction(std::optional<double> from) {
  if (!from || *from < 0 || *from > 360) return std::nullopt;
  return *from == 0 ? 360 : *from;
}

constexpr double fastest = 200;  ///< [m/s]; more is another unit or nonsense

/// The place and height that a line names; false where they are none on Earth.
bool read_place(const Cells& cells, std::optional<std::size_t> lat, std::optional<std::size_t> lon,
                std::optional<std::size_t> height, ReferenceWind& wind) {
  if (const auto h = cell_number(cells, height)) {
    if (*h < 0 || *h > 50000) return false;
    wind.height = GroundHeight{*h};
  }
  const auto at_lat = cell_number(cells, lat), at_lon = cell_number(cells, lon);
  if (!at_lat || !at_lon) return true;
  if (std::abs(*at_lat) > 90 || std::abs(*at_lon) > 360) return false;
  wind.place = GeoPoint{*at_lat, *at_lon};
  return true;
}

Reference read_plain_table(const TextLines& lines, const Cells& header, char delimiter, const std::string& file) {
  Reference reference{"table", file, {}, {}};
  const auto utc = column(header, "utc"), low = column(header, "speed_min_m_s"), high = column(header, "speed_max_m_s");
  const auto from = column(header, "wind_from_deg"), height = column(header, "height_agl_m");
  const auto lat = column(header, "lat_deg"), lon = column(header, "lon_deg");
  for (std::size_t i = 1; i < lines.text.size(); ++i) {
    const auto cells = split_cells(lines.text[i], delimiter);
    ReferenceWind wind;
    const auto time = utc && *utc < cells.size() ? parse_iso8601(cells[*utc]) : std::nullopt;
    wind.speed_min = cell_number(cells, low);
    wind.speed_max = cell_number(cells, high);
    if (!wind.speed_max) wind.speed_max = wind.speed_min;
    if (!wind.speed_min) wind.speed_min = wind.speed_max;
    if (!time || !wind.speed_min || *wind.speed_min < 0 || *wind.speed_max < *wind.speed_min ||
        *wind.speed_max > fastest) {
      reference.problems.push_back(bad_line(file, lines.number[i], "expected utc, a least and a largest speed in m/s"));
      continue;
    }
    wind.utc = *time;
    wind.calm = *wind.speed_max == 0;
    wind.from_deg = wind.calm ? std::nullopt : kept_direction(cell_number(cells, from));
    // A range is a uniform distribution: its sd is the width over sqrt(12).
    wind.speed_sd = (*wind.speed_max - *wind.speed_min) / std::sqrt(12.0);
    if (!read_place(cells, lat, lon, height, wind)) {
      reference.problems.push_back(
          bad_line(file, lines.number[i], "expected a place on Earth and a height above ground"));
      continue;
    }
    reference.records.push_back(wind);
  }
  return reference;
}

Reference read_iem(const TextLines& lines, const Cells& header, char delimiter, const std::string& file) {
  Reference reference{"METAR", file, {}, {}};
  const auto station = column(header, "station"), valid = column(header, "valid"), report = column(header, "metar");
  const auto from = column(header, "drct"), speed = column(header, "sknt"), gust = column(header, "gust");
  const auto lat = column(header, "lat"), lon = column(header, "lon");
  for (std::size_t i = 1; i < lines.text.size(); ++i) {
    const auto cells = split_cells(lines.text[i], delimiter);
    const auto time = *valid < cells.size() ? parse_iso8601(cells[*valid]) : std::nullopt;
    if (!time) {
      reference.problems.push_back(bad_line(file, lines.number[i], "expected a time in the column valid"));
      continue;
    }
    std::optional<ReferenceWind> wind;
    if (report && *report < cells.size()) wind = parse_metar(cells[*report], time);
    if (!wind) {
      const auto knots = cell_number(cells, speed);
      if (!knots) continue;  // a report without wind is no damage
      if (*knots < 0 || *knots * knot > fastest) {
        reference.problems.push_back(bad_line(file, lines.number[i], "expected a speed in knots in the column sknt"));
        continue;
      }
      wind.emplace();
      wind->height = GroundHeight{10};
      wind->speed_min = wind->speed_max = *knots * knot;
      wind->calm = *knots == 0;
      if (!wind->calm) wind->from_deg = kept_direction(cell_number(cells, from));
      if (const auto g = cell_number(cells, gust); g && *g >= 0 && *g * knot <= fastest) wind->gust = *g * knot;
      wind->speed_sd = knot / std::sqrt(12.0);
      wind->from_sd_deg = 10 / std::sqrt(12.0);
    }
    wind->utc = *time;
    if (station && *station < cells.size()) wind->station = cells[*station];
    if (!read_place(cells, lat, lon, std::nullopt, *wind)) {
      reference.problems.push_back(bad_line(file, lines.number[i], "expected a place on Earth in lat and lon"));
      continue;
    }
    reference.records.push_back(*wind);
  }
  return reference;
}

/// Raw reports, each on a line, with or without "YYYY-MM-DD HH:MM" before it.
Reference read_raw_list(const TextLines& lines, const std::string& file, std::optional<UtcTime> near) {
  Reference reference{"METAR", file, {}, {}};
  for (std::size_t i = 0; i < lines.text.size(); ++i) {
    auto line = lines.text[i];
    const auto stamp = line.size() > 16 ? parse_iso8601(line.substr(0, 16)) : std::nullopt;
    if (stamp) line.remove_prefix(16);
    if (auto wind = parse_metar(line, stamp ? stamp : near)) {
      if (stamp) wind->utc = *stamp;
      reference.records.push_back(*wind);
    } else if (line.find("KT") != std::string_view::npos || line.find("MPS") != std::string_view::npos) {
      reference.problems.push_back(bad_line(file, lines.number[i], "no wind could be read from this report"));
    }
  }
  return reference;
}

/// Why a reference has no record.
Problem why_nothing(const Reference& reference, Layout layout, std::optional<UtcTime> near) {
  const Where where{reference.source, {}, {}, {}};
  if (layout == Layout::none)
    return {Kind::not_a_log, "no wind was found: this is neither a METAR list, an IEM download nor a plain table",
            where, "a plain table begins with utc,speed_min_m_s,speed_max_m_s,wind_from_deg"};
  if (layout == Layout::raw_list && !near)
    return {Kind::missing, "its reports tell the day of the month only, and the flight tells no date", where,
            "write YYYY-MM-DD HH:MM before each report, or give the flight's time with --start-utc"};
  if (!reference.problems.empty()) return reference.problems.front();
  return {Kind::missing, "none of its reports has a wind", where, "give reports with a wind"};
}

/// In the order of time, then of stations; what stands there twice once.
void sort_records(std::vector<ReferenceWind>& records) {
  std::stable_sort(records.begin(), records.end(), [](const auto& a, const auto& b) {
    return std::pair(a.utc, std::string_view(a.station)) < std::pair(b.utc, std::string_view(b.station));
  });
  const auto facts = [](const ReferenceWind& r) {
    return std::tuple(r.utc, std::string_view(r.station), r.speed_min, r.speed_max, r.gust, r.from_deg, r.sector_deg,
                      r.height ? std::optional(r.height->m) : std::nullopt,
                      r.place ? std::optional(std::pair(r.place->lat_deg, r.place->lon_deg)) : std::nullopt);
  };
  records.erase(
      std::unique(records.begin(), records.end(), [&](const auto& a, const auto& b) { return facts(a) == facts(b); }),
      records.end());
}

}  // namespace

bool looks_like_reference(Bytes bytes) { return table_of(bytes).layout != Layout::none; }

Result<Reference> read_reference(Bytes bytes, const std::string& file_name, std::optional<UtcTime> near) {
  const auto table = table_of(bytes);
  if (table.lines.text.empty())
    return fail(Kind::not_a_log, "the reference is empty", {file_name, {}, {}, {}}, "give a METAR list or a table");
  Reference reference;
  if (table.layout == Layout::plain_table)
    reference = read_plain_table(table.lines, table.header, table.delimiter, file_name);
  else if (table.layout == Layout::iem)
    reference = read_iem(table.lines, table.header, table.delimiter, file_name);
  else
    reference = read_raw_list(table.lines, file_name, near);
  if (reference.records.empty()) return fail(why_nothing(reference, table.layout, near));
  sort_records(reference.records);
  return reference;
}

void place_records(Reference& reference, GeoPoint place, GroundHeight height) {
  const bool height_is_assumed = reference.kind == "METAR";
  for (auto& record : reference.records) {
    if (!record.place) record.place = place;
    if (!record.height || height_is_assumed) record.height = height;
  }
}

}  // namespace quadsonde::ingest
