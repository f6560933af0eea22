#include "ingest/reference/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ingest/reference/metar.h"
#include "ingest/reference/text_table.h"

namespace quadsonde::ingest {
namespace {

using Cells = std::vector<std::string_view>;

Problem bad_line(const std::string& file, std::uint64_t line, std::string what) {
  return {Kind::damaged, std::move(what), {file, {}, line, {}}, "the line was left out"};
}

/// Direction of a report as we keep it: 0 < d <= 360.
std::optional<double> kept_direction(std::optional<double> from) {
  if (!from || *from < 0 || *from > 360) return std::nullopt;
  return *from == 0 ? 360 : *from;
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
    if (!time || !wind.speed_min || *wind.speed_min < 0 || *wind.speed_max < *wind.speed_min) {
      reference.problems.push_back(bad_line(file, lines.number[i], "expected utc, a least and a largest speed in m/s"));
      continue;
    }
    wind.utc = *time;
    wind.calm = *wind.speed_max == 0;
    wind.from_deg = wind.calm ? std::nullopt : kept_direction(cell_number(cells, from));
    // A range is a uniform distribution: its sd is the width over sqrt(12).
    wind.speed_sd = (*wind.speed_max - *wind.speed_min) / std::sqrt(12.0);
    if (const auto h = cell_number(cells, height)) wind.height = GroundHeight{*h};
    const auto at_lat = cell_number(cells, lat), at_lon = cell_number(cells, lon);
    if (at_lat && at_lon) wind.place = GeoPoint{*at_lat, *at_lon};
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
      wind.emplace();
      wind->height = GroundHeight{10};
      wind->speed_min = wind->speed_max = *knots * knot;
      wind->calm = *knots == 0;
      if (!wind->calm) wind->from_deg = kept_direction(cell_number(cells, from));
      if (const auto g = cell_number(cells, gust)) wind->gust = *g * knot;
      wind->speed_sd = knot / std::sqrt(12.0);
      wind->from_sd_deg = 10 / std::sqrt(12.0);
    }
    wind->utc = *time;
    if (station && *station < cells.size()) wind->station = cells[*station];
    const auto at_lat = cell_number(cells, lat), at_lon = cell_number(cells, lon);
    if (at_lat && at_lon) wind->place = GeoPoint{*at_lat, *at_lon};
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

}  // namespace

Result<Reference> read_reference(Bytes bytes, const std::string& file_name, std::optional<UtcTime> near) {
  const auto lines = split_lines(as_text(bytes));
  if (lines.text.empty())
    return fail(Kind::not_a_log, "the reference is empty", {file_name, {}, {}, {}}, "give a METAR list or a table");
  const char delimiter = lines.text[0].find('\t') != std::string_view::npos ? '\t' : ',';
  const auto header = split_cells(lines.text[0], delimiter);
  Reference reference;
  if (column(header, "utc") && (column(header, "speed_min_m_s") || column(header, "speed_max_m_s")))
    reference = read_plain_table(lines, header, delimiter, file_name);
  else if (column(header, "station") && column(header, "valid"))
    reference = read_iem(lines, header, delimiter, file_name);
  else
    reference = read_raw_list(lines, file_name, near);
  if (reference.records.empty()) {
    if (!reference.problems.empty()) return fail(reference.problems.front());
    return fail(Kind::not_a_log, "no wind was found: this is neither a METAR list, an IEM download nor a plain table",
                {file_name, {}, {}, {}},
                "a plain table begins with utc,speed_min_m_s,speed_max_m_s,wind_from_deg");
  }
  std::stable_sort(reference.records.begin(), reference.records.end(),
                   [](const auto& a, const auto& b) { return a.utc < b.utc; });
  return reference;
}

void place_records(Reference& reference, GeoPoint place) {
  for (auto& record : reference.records)
    if (!record.place) record.place = place;
}

}  // namespace quadsonde::ingest
