#include "export/csv/read_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "ingest/reference/text_table.h"
#include "profiles/legs.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using ingest::fail;
using ingest::Kind;
using ingest::Problem;

/// Rows of named fields, whatever file they stood in. The first wrong field is remembered; later ones read as unknown.
class Fields {
 public:
  Fields(std::vector<std::string> names, std::string file) : names_(std::move(names)), file_(std::move(file)) {
    for (std::size_t i = 0; i < names_.size(); ++i) index_.emplace(names_[i], i);
  }
  void begin_row(std::vector<std::string> cells, std::uint64_t line, std::size_t row) {
    cells_ = std::move(cells);
    line_ = line, row_ = row;
  }

  bool has(std::string_view name) const { return index_.contains(name); }
  std::string_view text(std::string_view name) const {
    const auto found = index_.find(name);
    return found == index_.end() || found->second >= cells_.size() ? std::string_view() : cells_[found->second];
  }
  /// @param most  no magnitude beyond it can be meant; it keeps what is binned and counted later within bounds
  std::optional<double> number(std::string_view name, double most = 1e15) {
    const auto cell = text(name);
    if (cell.empty()) return std::nullopt;
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error == std::errc{} && end == cell.data() + cell.size() && std::abs(value) <= most) return value;
    return wrong(name, fmt::format("a number up to {:g}", most));
  }
  /// A number that no row can be without.
  double needed(std::string_view name, double most = 1e15) {
    if (text(name).empty()) wrong(name, "a number");
    return number(name, most).value_or(0);
  }
  std::optional<ingest::UtcTime> utc(std::string_view name) {
    const auto cell = text(name);
    if (cell.empty()) return std::nullopt;
    constexpr std::int64_t year_2200 = 7'258'118'400'000'000'000;
    const auto time = ingest::parse_iso8601(cell);
    if (!time || time->ns < 0 || time->ns > year_2200) return wrong(name, "a time like 2026-06-01T06:00:00Z");
    return time;
  }
  const std::optional<Problem>& problem() const { return problem_; }
  std::nullopt_t wrong(std::string_view name, std::string_view expected) {
    if (problem_) return std::nullopt;
    problem_ = Problem{Kind::damaged,
                       fmt::format("expected {} here{}", expected, line_ ? "" : fmt::format(", in row {}", row_)),
                       {file_, {}, line_ ? std::optional(line_) : std::nullopt, std::string(name)},
                       "correct or remove the row"};
    return std::nullopt;
  }

 private:
  std::vector<std::string> names_;
  std::string file_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::vector<std::string> cells_;
  std::uint64_t line_ = 0;
  std::size_t row_ = 0;
  std::optional<Problem> problem_;
};

template <class Word, std::size_t n>
std::optional<Word> word_of(std::string_view text, const Word (&words)[n]) {
  for (const auto w : words)
    if (name(w) == text) return w;
  return std::nullopt;
}

estimator::Quality quality_of(std::string_view text) {
  using enum estimator::Quality;
  return word_of(text, {good, doubtful, bad}).value_or(none);
}

constexpr double highest = 1e5, fastest = 1e3;  ///< [m], [m/s]

estimator::MaybeWind wind_of(Fields& f) {
  const auto east = f.number("wind_east_m_s", fastest), north = f.number("wind_north_m_s", fastest);
  if (!east || !north) return estimator::NoEstimate{};
  WindEstimate wind;
  wind.v_NA_N = {*north, *east};
  const auto sd_east = f.number("sd_wind_east_m_s"), sd_north = f.number("sd_wind_north_m_s");
  wind.has_covariance = sd_east && sd_north;
  if (!wind.has_covariance) return wind;
  const double both = f.number("cov_wind_east_north_m2_s2").value_or(0);
  wind.covariance << *sd_north * *sd_north, both, both, *sd_east * *sd_east;
  return wind;
}

template <class Row>
void read_place(Fields& f, Row& row, std::optional<ingest::GeoPoint>& place) {
  row.utc = f.utc("utc");
  if (const auto h = f.number("height_msl_m", highest)) row.height_msl = ingest::MslHeight{*h};
  if (const auto h = f.number("height_agl_m", highest)) row.height_agl = ingest::GroundHeight{*h};
  const auto lat = f.number("lat_deg"), lon = f.number("lon_deg");
  if (lat && lon && std::abs(*lat) <= 90 && std::abs(*lon) <= 360) place = ingest::GeoPoint{*lat, *lon};
  row.wind = wind_of(f);
  row.quality = quality_of(f.text("quality"));
}

void add_point(Fields& f, estimator::WindSeries& series) {
  using enum estimator::Mode;
  estimator::WindPoint point;
  point.time = ingest::LogTime{ingest::seconds(f.needed("time_s", 1e9)).count()};
  read_place(f, point, point.place);
  if (const auto mode = word_of(f.text("mode"), {smoothed, causal, classic})) series.mode = *mode;
  series.points.push_back(point);
}

void add_bin(Fields& f, profiles::WindProfile& profile) {
  using enum profiles::LegName;
  const auto leg = word_of(f.text("leg"), {up, down, all});
  profiles::Bin bin;
  bin.bottom = f.needed("bin_bottom_m", highest), bin.top = f.needed("bin_top_m", highest);
  if (!leg) f.wrong("leg", "up, down or all");
  if (!(bin.top - bin.bottom >= 0.1)) f.wrong("bin_top_m", "a top above the bottom");
  if (f.problem()) return;
  read_place(f, bin, bin.place);
  const auto sigma_east = f.number("sigma_east_m_s"), sigma_north = f.number("sigma_north_m_s");
  if (sigma_east && sigma_north) bin.sigma = Eigen::Vector2d(*sigma_north, *sigma_east);
  bin.samples = static_cast<std::size_t>(std::clamp(f.number("samples").value_or(0), 0.0, 1e15));
  bin.effective_samples = f.number("effective_samples");
  bin.sd_sampling = f.number("sd_sampling_m_s");
  bin.sd_calibration = f.number("sd_calibration_m_s");
  bin.sd_trim = f.number("sd_trim_m_s");
  bin.spread_from_deg = f.number("spread_from_deg");
  bin.sd_noise = f.number("sd_noise_m_s");
  bin.sd_climb_law = f.number("sd_climb_law_m_s");
  bin.resolution_m = f.number("resolution_m");
  bin.freedom = f.number("freedom");
  bin.pressure_pa = f.number("air_pressure_pa");
  bin.temperature_k = f.number("air_temperature_k");
  bin.relative_humidity_pct = f.number("relative_humidity_pct");
  if (profile.legs.empty() || profile.legs.back().name != *leg) profile.legs.push_back({*leg, {}});
  auto& to = profile.legs.back();
  if (bin.utc) {
    to.utc_from = std::min(to.utc_from.value_or(*bin.utc), *bin.utc);
    to.utc_to = std::max(to.utc_to.value_or(*bin.utc), *bin.utc);
  }
  to.bins.push_back(std::move(bin));
}

/// The datum in which the mean heights lie inside their bins.
profiles::Datum datum_of(const profiles::WindProfile& profile) {
  long agl = 0, msl = 0;
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins) {
      const auto inside = [&](double h) { return h >= bin.bottom - 0.01 && h <= bin.top + 0.01; };
      agl += bin.height_agl && inside(bin.height_agl->m);
      msl += bin.height_msl && inside(bin.height_msl->m);
    }
  return msl > agl ? profiles::Datum::msl : profiles::Datum::agl;
}

/// Tables do not carry them, and legs are found by them.
void add_climb_rates(estimator::WindSeries& series) {
  std::vector<std::optional<double>> heights;
  for (const auto& p : series.points)
    heights.push_back(p.height_agl   ? std::optional(p.height_agl->m)
                      : p.height_msl ? std::optional(p.height_msl->m)
                                     : std::nullopt);
  profiles::add_climb_rates(series.points, heights);
}

constexpr std::string_view wind_columns[] = {"time_s", "utc", "wind_east_m_s", "wind_north_m_s", "quality", "mode"};
constexpr std::string_view profile_columns[] = {"leg", "bin_bottom_m", "bin_top_m", "wind_east_m_s", "wind_north_m_s"};

template <class Columns, class Names>
std::optional<std::string_view> missing_of(const Columns& columns, const Names& has) {
  for (const auto column : columns)
    if (!has(column)) return column;
  return std::nullopt;
}

/// Reads rows one by one as `next` gives them to the fields, into what they are.
template <class Next>
ingest::Result<ReadTable> read_rows(Fields& fields, bool is_profile, const std::string& file, Next&& next) {
  const auto has = [&](std::string_view name) { return fields.has(name); };
  if (const auto missing = is_profile ? missing_of(profile_columns, has) : missing_of(wind_columns, has))
    return fail(Kind::missing, fmt::format("the column {} is not there", *missing),
                {file, {}, {}, std::string(*missing)}, "give the table as it was written");
  ReadTable table;
  estimator::WindSeries series;
  profiles::WindProfile profile;
  while (next()) {
    if (is_profile)
      add_bin(fields, profile);
    else
      add_point(fields, series);
    if (fields.problem()) return fail(*fields.problem());
  }
  if (is_profile ? profile.legs.empty() : series.points.empty())
    return fail(Kind::missing, "the table has no rows", {file, {}, {}, {}}, "give a table with at least one row");
  if (is_profile) {
    profile.datum = datum_of(profile);
    profile.bin_m = profile.legs.front().bins.front().top - profile.legs.front().bins.front().bottom;
    table.content = std::move(profile);
  } else {
    add_climb_rates(series);
    table.content = std::move(series);
  }
  return table;
}

ingest::Result<ReadTable> read_csv(std::string_view text, bool is_profile, const std::string& file) {
  const auto lines = ingest::split_lines(text);
  std::vector<std::string> names;
  for (const auto name : ingest::split_cells(lines.text.at(0), ',')) names.emplace_back(name);
  Fields fields(names, file);
  std::size_t i = 0;
  return read_rows(fields, is_profile, file, [&] {
    if (++i >= lines.text.size()) return false;
    std::vector<std::string> cells;
    for (const auto cell : ingest::split_cells(lines.text[i], ',')) cells.emplace_back(cell);
    fields.begin_row(std::move(cells), lines.number[i], i);
    return true;
  });
}

using Json = nlohmann::json;

bool is_ours(const Json& object) {
  if (!object.is_object() || !object.contains("rows") || !object["rows"].is_array()) return false;
  const auto schema = object.value("schema", Json());
  return schema == "quadsonde.wind/1" || schema == "quadsonde.profile/1";
}

/// The object itself, or those of a list; empty if it is neither a wind nor a profile.
std::vector<const Json*> objects_of(const Json& json) {
  if (is_ours(json)) return {&json};
  std::vector<const Json*> all;
  if (!json.is_array()) return {};
  for (const auto& object : json) {
    if (!is_ours(object)) return {};
    all.push_back(&object);
  }
  return all;
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_number() ? value.dump() : std::string();
}

/// Those of each row that this version knows. Rows and bins have the same order.
void read_reasons(const Json& rows, profiles::WindProfile& profile) {
  auto row = rows.begin();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) {
      const auto list = row != rows.end() && row->is_object() ? row->value("reasons", Json()) : Json();
      if (row != rows.end()) ++row;
      if (!list.is_array()) continue;
      for (const auto& word : list)
        for (int i = 0; i < static_cast<int>(estimator::Reason::count); ++i)
          if (word == std::string(estimator::name(static_cast<estimator::Reason>(i))))
            bin.reasons.add(static_cast<estimator::Reason>(i));
    }
}

ingest::Result<ReadTable> read_object(const Json& object, const std::string& file) {
  const bool is_profile = object["schema"] == "quadsonde.profile/1";
  const auto& rows = object["rows"];
  std::vector<std::string> names;
  if (!rows.empty() && rows[0].is_object())
    for (const auto& [name, value] : rows[0].items()) names.push_back(name);
  Fields fields(names, file);
  std::size_t i = 0;
  auto table = read_rows(fields, is_profile, file, [&] {
    if (i >= rows.size()) return false;
    std::vector<std::string> cells;
    for (const auto& name : names)
      cells.push_back(rows[i].is_object() && rows[i].contains(name) ? text_of(rows[i][name]) : std::string());
    fields.begin_row(std::move(cells), 0, ++i);
    return true;
  });
  if (!table) return table;
  const auto source = object.value("source", Json());
  if (source.is_object()) {
    if (const auto name = source.value("file", Json()); name.is_string()) table->made_of = name.get<std::string>();
    if (const auto number = source.value("flight", Json()); number.is_number_integer())
      table->flight = static_cast<int>(std::clamp<std::int64_t>(number.get<std::int64_t>(), 1, 1'000'000));
  }
  const auto diagnostics = object.value("diagnostics", Json());
  if (auto* series = std::get_if<estimator::WindSeries>(&table->content); series && diagnostics.is_object())
    if (const auto sd = diagnostics.value("turbulence_sd_m_s", Json()); sd.is_number())
      series->diagnostics.sigma_u = std::max(0.0, sd.get<double>());
  if (auto* profile = std::get_if<profiles::WindProfile>(&table->content)) {
    if (object.value("datum", Json()) == "msl") profile->datum = profiles::Datum::msl;
    if (object.value("method", Json()) == "optimal") profile->method = profiles::Method::optimal;
    read_reasons(rows, *profile);
  }
  return table;
}

bool starts_json(std::string_view text) {
  const auto at = text.find_first_not_of(" \t\r\n");
  return at != std::string_view::npos && (text[at] == '{' || text[at] == '[');
}

}  // namespace

TableKind table_kind(std::string_view text) {
  if (starts_json(text)) {
    const bool ours = text.find("\"quadsonde.wind/1\"") != std::string_view::npos ||
                      text.find("\"quadsonde.profile/1\"") != std::string_view::npos;
    return ours ? TableKind::json : TableKind::none;
  }
  const auto header = ingest::split_cells(text.substr(0, text.find('\n')), ',');
  const auto has = [&](std::string_view name) { return ingest::column(header, name).has_value(); };
  if (has("leg") && has("bin_bottom_m")) return TableKind::profile_csv;
  if (has("time_s") && has("wind_east_m_s") && has("quality") && has("mode")) return TableKind::wind_csv;
  return TableKind::none;
}

ingest::Result<std::vector<ReadTable>> read_tables(std::string_view text, const std::string& file) {
  const auto kind = table_kind(text);
  const auto not_ours = [&] {
    return fail(Kind::not_a_log, "this is neither a wind nor a profile", {file, {}, {}, {}},
                "give a table that `quadsonde estimate`, `profile` or `run` wrote");
  };
  if (kind == TableKind::none) return not_ours();
  std::vector<ReadTable> tables;
  if (kind != TableKind::json) {
    auto table = read_csv(text, kind == TableKind::profile_csv, file);
    if (!table) return fail(table.error());
    tables.push_back(std::move(*table));
    return tables;
  }
  const auto json = Json::parse(text.begin(), text.end(), nullptr, false);
  if (json.is_discarded()) return fail(Kind::damaged, "this is no complete JSON", {file, {}, {}, {}}, "make it again");
  const auto objects = objects_of(json);
  if (objects.empty()) return not_ours();
  for (const auto* object : objects) {
    auto table = read_object(*object, file);
    if (!table) return fail(table.error());
    tables.push_back(std::move(*table));
  }
  return tables;
}

}  // namespace quadsonde::product
