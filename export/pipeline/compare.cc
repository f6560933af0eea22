#include "export/pipeline/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>

#include "export/csv/read_tables.h"
#include "export/csv/truth_csv.h"
#include "ingest/open/sniff.h"
#include "ingest/reference/text_table.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;

/// Whether the first line names one of these columns.
bool names_any(std::string_view text, std::initializer_list<std::string_view> columns) {
  const auto header = ingest::split_cells(text.substr(0, text.find('\n')), ',');
  return std::any_of(columns.begin(), columns.end(), [&](auto name) { return ingest::column(header, name); });
}

/// What a file that is no reference is instead.
Problem no_reference(const std::filesystem::path& path, std::string_view text) {
  const ingest::Where where{path.string(), {}, {}, {}};
  if (table_kind(text) != TableKind::none)
    return {Kind::not_a_log, "this is a wind or profile of ours, not a reference", where,
            "`quadsonde compare` takes it beside references"};
  const auto container = ingest::sniff(ingest::as_bytes(text));
  using C = ingest::Container;
  if (container == C::mcap || container == C::ulog || container == C::dataflash || container == C::mavlink ||
      container == C::paparazzi_data || names_any(text, {"qw", "roll_deg", "vn_m_s"}))
    return {Kind::not_a_log, "this is a flight log, not a reference", where,
            "compare a log with `quadsonde run LOG --reference FILE`"};
  return {Kind::not_a_log,
          "this is no reference: neither a table of the true wind, a METAR list, an IEM download nor a "
          "plain table",
          where, "a plain table begins with utc,speed_min_m_s,speed_max_m_s,wind_from_deg"};
}

/// An instant of the flight, for reports that do not tell their month.
std::optional<ingest::UtcTime> any_utc(const FlightWinds& ours) {
  if (ours.series)
    for (const auto& p : ours.series->points)
      if (p.utc) return p.utc;
  if (ours.profile)
    for (const auto& leg : ours.profile->legs)
      for (const auto& bin : leg.bins)
        if (bin.utc) return bin.utc;
  return std::nullopt;
}

/// A report as pictures show it, at its height in the profile's datum.
ReferenceMark mark_of(const profiles::MatchedReport& matched, const std::string& kind, double takeoff) {
  const auto& report = matched.report;
  ReferenceMark mark;
  mark.name = report.station.empty() ? kind : kind + " " + report.station;
  mark.height = (report.height ? report.height->m : 10) + takeoff;
  // Rounded values are drawn with the half step to which they were rounded.
  const double half = *report.speed_min < *report.speed_max ? 0 : report.speed_sd * std::sqrt(3.0);
  mark.speed = *report.speed();
  mark.low = std::max(0.0, *report.speed_min - half), mark.high = *report.speed_max + half;
  mark.from_deg = report.from_deg;
  mark.from_half_deg = report.from_sd_deg * std::sqrt(3.0);
  mark.sector_deg = report.sector_deg;
  mark.gust = report.gust;
  return mark;
}

void add_lines(ReferenceComparison& reference, const std::vector<Problem>& problems) {
  constexpr std::size_t shown = 3;
  for (std::size_t i = 0; i < std::min(shown, problems.size()); ++i) reference.problems.push_back(problems[i]);
  if (problems.size() > shown)
    reference.problems.push_back({Kind::damaged,
                                  fmt::format("{} further lines could not be read", problems.size() - shown),
                                  {problems[0].where.file, {}, {}, {}},
                                  "they were left out"});
}

void compare_truth(Comparison& comparison, ReferenceComparison& reference, const FlightWinds& ours,
                   const ingest::Truth& truth, const std::string& file) {
  const auto& match = comparison.settings.match;
  auto scores = ours.series ? profiles::score_against_truth(*ours.series, ours.classic, ours.profile, truth, match)
                            : profiles::score_against_truth(*ours.profile, truth, match);
  reference.kind = "truth";
  if (scores.whole().n == 0)
    reference.problems.push_back({Kind::missing,
                                  scores.by_height ? "the reference has no height in common with the profile"
                                                   : "the reference has no instant in common with the flight",
                                  {file, {}, {}, {}},
                                  "give the truth of this flight, on the same clock"});
  if (comparison.levels.empty() && !scores.legs.empty()) {
    const auto* leg = &scores.legs.front();
    for (const auto& l : scores.legs)
      if (l.name == profiles::LegName::all) leg = &l;
    for (const auto& bin : leg->bins) comparison.levels.push_back({(bin.bottom + bin.top) / 2, bin.reference});
  }
  if (comparison.along.empty() && ours.series && !ours.series->points.empty())
    for (const auto& sample : truth)
      if (sample.time >= ours.series->points.front().time && sample.time <= ours.series->points.back().time)
        comparison.along.push_back({sample.time, sample.v_NA_N.head<2>()});
  reference.scores = std::move(scores);
}

void compare_reports(Comparison& comparison, ReferenceComparison& reference, const FlightWinds& ours,
                     std::string_view text, const std::string& file, const std::optional<ReferencePlace>& place) {
  reference.scores = profiles::ReportScores{};
  reference.kind = "reports";
  auto read = ingest::read_reference(ingest::as_bytes(text), file, any_utc(ours));
  if (!read) {
    std::get<profiles::ReportScores>(reference.scores).no_score = read.error();
    reference.problems.push_back(read.error());
    return;
  }
  reference.kind = read->kind;
  add_lines(reference, read->problems);
  if (place) ingest::place_records(*read, place->place, place->height);
  std::set<std::string> stations;
  const auto& match = comparison.settings.match;
  auto scores = ours.series ? profiles::score_against_reports(*ours.series, *read, match)
                            : profiles::score_against_reports(*ours.profile, *read, match);
  if (scores.no_score) {
    scores.no_score->where.file = file;
    reference.problems.push_back(*scores.no_score);
  }
  const auto takeoff = ours.profile ? profiles::takeoff_in_datum(*ours.profile) : std::nullopt;
  for (const auto& matched : scores.pairs) {
    if (!matched.report.station.empty()) stations.insert(matched.report.station);
    if (takeoff) comparison.marks.push_back(mark_of(matched, reference.kind, *takeoff));
  }
  reference.stations.assign(stations.begin(), stations.end());
  reference.scores = std::move(scores);
}

}  // namespace

ingest::Result<std::optional<ReferencePlace>> reference_place(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto cells = ingest::split_cells(text, ',');
  const auto lat = ingest::cell_number(cells, 0), lon = ingest::cell_number(cells, 1),
             height = ingest::cell_number(cells, 2);
  const bool sound = cells.size() == 3 && lat && lon && height && std::abs(*lat) <= 90 && std::abs(*lon) <= 360 &&
                     *height >= 0 && *height <= 20000;
  if (!sound)
    return fail(Kind::usage, fmt::format("--reference-at {}: expected LAT,LON,HEIGHT_M", text), {},
                "give degrees north, degrees east and metres above the ground there: 48.2486,16.3564,10");
  return ReferencePlace{{*lat, *lon}, {*height}};
}

ingest::Result<std::string> read_whole(const std::filesystem::path& path) {
  constexpr std::uintmax_t largest = 256u << 20;
  std::error_code error;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, error))
    return fail(Kind::unreadable, "this file cannot be opened", {path.string(), {}, {}, {}}, "check the path");
  const auto size = std::filesystem::file_size(path, error);
  if (!error && size > largest)
    return fail(Kind::limit, "this file is larger than 256 MB", {path.string(), {}, {}, {}},
                "give the days of the flight only");
  return std::string{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

ingest::Result<ReferenceFile> reference_of(const std::filesystem::path& path, std::string text) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    return fail(Kind::not_a_log, "this file is empty", {path.string(), {}, {}, {}},
                "give a table of the true wind, a METAR list or a table of a station");
  const bool ours = table_kind(text) != TableKind::none;
  if (!ours && names_any(text, {"time_s"}) && !names_any(text, {"qw", "roll_deg", "vn_m_s"})) {
    auto truth = parse_truth_csv(text, path.string());
    if (!truth) return fail(truth.error());
    return ReferenceFile{path, std::move(*truth)};
  }
  if (ours || !ingest::looks_like_reference(ingest::as_bytes(text))) return fail(no_reference(path, text));
  return ReferenceFile{path, std::move(text)};
}

ingest::Result<ReferenceFile> read_reference_file(const std::filesystem::path& path) {
  auto text = read_whole(path);
  if (!text) return fail(text.error());
  return reference_of(path, std::move(*text));
}

ingest::Result<std::vector<ReferenceFile>> read_reference_files(const std::vector<std::filesystem::path>& paths) {
  std::vector<ReferenceFile> files;
  for (const auto& path : paths) {
    auto file = read_reference_file(path);
    if (!file) return fail(file.error());
    files.push_back(std::move(*file));
  }
  return files;
}

const profiles::Scores& ReferenceComparison::whole() const { return truth() ? truth()->whole() : reports()->scores; }

std::vector<Problem> Comparison::problems() const {
  std::vector<Problem> all;
  for (const auto& reference : references) all.insert(all.end(), reference.problems.begin(), reference.problems.end());
  return all;
}

Comparison compare_with(const FlightWinds& ours, const std::vector<ReferenceFile>& references,
                        const ReferenceSettings& settings) {
  Comparison comparison;
  comparison.settings = settings;
  const auto place = reference_place(settings.reference_at).value_or(std::nullopt);
  for (const auto& file : references) {
    ReferenceComparison reference;
    reference.file = file.path.filename().string();
    if (const auto* truth = std::get_if<ingest::Truth>(&file.content))
      compare_truth(comparison, reference, ours, *truth, file.path.string());
    else
      compare_reports(comparison, reference, ours, std::get<std::string>(file.content), file.path.string(), place);
    comparison.references.push_back(std::move(reference));
  }
  return comparison;
}

}  // namespace quadsonde::product
