#include "export/pipeline/compare_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "export/cf_netcdf/read_profile.h"
#include "export/csv/read_tables.h"
#include "export/report/text_answer.h"
#include "profiles/make_profile.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;

/// What is known of a flight from its rows: first time, first place, how long.
struct Extent {
  std::optional<ingest::UtcTime> from, to;
  std::optional<ingest::GeoPoint> place;
  void add(const std::optional<ingest::UtcTime>& utc, const std::optional<ingest::GeoPoint>& at) {
    if (at && !place) place = at;
    if (!utc) return;
    from = std::min(from.value_or(*utc), *utc);
    to = std::max(to.value_or(*utc), *utc);
  }
};

FlightTitle title_of(const ReadTable& table, const std::string& file) {
  Extent extent;
  FlightTitle title;
  if (const auto* series = std::get_if<estimator::WindSeries>(&table.content)) {
    for (const auto& p : series->points) extent.add(p.utc, p.place);
    title.duration_s = ingest::to_seconds(series->points.back().time - series->points.front().time);
  } else {
    for (const auto& leg : std::get<profiles::WindProfile>(table.content).legs)
      for (const auto& bin : leg.bins) extent.add(bin.utc, bin.place);
    if (extent.from) title.duration_s = ingest::to_seconds(*extent.to - *extent.from);
  }
  title.file = file + (table.made_of.empty() ? "" : " of " + table.made_of);
  title.start = extent.from;
  title.place = extent.place;
  return title;
}

ComparedFlight flight_of(ReadTable table, const std::string& file) {
  ComparedFlight flight;
  flight.title = title_of(table, file);
  flight.flight = table.flight;
  if (auto* profile = std::get_if<profiles::WindProfile>(&table.content)) {
    flight.profile = std::move(*profile);
    return flight;
  }
  flight.series = std::move(std::get<estimator::WindSeries>(table.content));
  if (auto made = profiles::make_profile(*flight.series)) flight.profile = std::move(*made);
  return flight;
}

estimator::WindEstimate wind_of(const StoredBin& bin) {
  estimator::WindEstimate wind;
  wind.v_NA_N = {*bin.north, *bin.east};
  wind.has_covariance = bin.se_east && bin.se_north;
  if (!wind.has_covariance) return wind;
  const double both = bin.covariance.value_or(0);
  wind.covariance << *bin.se_north * *bin.se_north, both, both, *bin.se_east * *bin.se_east;
  return wind;
}

bool is_netcdf(std::string_view text) { return text.starts_with("CDF") || text.starts_with("\x89HDF"); }

/// Bins are above sea level there; the time of each is the middle of its leg.
profiles::WindProfile profile_of(const StoredProfile& stored) {
  profiles::WindProfile profile;
  profile.datum = profiles::Datum::msl;
  for (const auto& record : stored.records) {
    const auto utc = [](double s) { return ingest::UtcTime{0} + ingest::seconds(s); };
    profiles::Leg leg{record.leg == 0   ? profiles::LegName::up
                      : record.leg == 1 ? profiles::LegName::down
                                        : profiles::LegName::all,
                      {},
                      utc(record.from_s),
                      utc(record.to_s)};
    for (std::size_t i = 0; i < std::min(record.bins.size(), stored.bottom_msl_m.size()); ++i) {
      const auto& from = record.bins[i];
      profiles::Bin bin;
      bin.bottom = stored.bottom_msl_m[i], bin.top = stored.top_msl_m[i];
      const double middle = (bin.bottom + bin.top) / 2;
      bin.height_msl = ingest::MslHeight{middle};
      if (stored.surface_msl_m) bin.height_agl = ingest::GroundHeight{middle - *stored.surface_msl_m};
      bin.utc = utc(record.mid_s);
      bin.place = ingest::GeoPoint{stored.lat_deg, stored.lon_deg};
      bin.samples = static_cast<std::size_t>(std::max<std::int64_t>(0, from.samples));
      if (from.has_wind()) bin.wind = wind_of(from);
      bin.sd_noise = from.noise, bin.sd_calibration = from.calibration, bin.sd_trim = from.trim;
      bin.sd_climb_law = from.climb_law, bin.sd_sampling = from.sampling;
      bin.effective_samples = from.effective_samples, bin.spread_from_deg = from.spread_from_deg;
      if (from.sigma_north && from.sigma_east) bin.sigma = Eigen::Vector2d(*from.sigma_north, *from.sigma_east);
      bin.resolution_m = from.resolution_m, bin.freedom = from.freedom;
      bin.pressure_pa = from.pressure_pa, bin.temperature_k = from.temperature_k;
      bin.relative_humidity_pct = from.relative_humidity_pct;
      bin.reasons = from.reasons;
      bin.quality = from.quality == 1   ? estimator::Quality::good
                    : from.quality == 3 ? estimator::Quality::doubtful
                    : from.quality == 4 ? estimator::Quality::bad
                                        : estimator::Quality::none;
      leg.bins.push_back(std::move(bin));
    }
    profile.legs.push_back(std::move(leg));
  }
  profile.bin_m = stored.bottom_msl_m.empty() ? 10 : stored.top_msl_m[0] - stored.bottom_msl_m[0];
  return profile;
}

void take_netcdf(const std::filesystem::path& path, std::string_view text, CompareResult& result) {
  const auto stored = read_profile_netcdf(ingest::as_bytes(text), path.string());
  if (!stored) {
    result.failures.push_back(stored.error());
    return;
  }
  const auto name = path.filename().string();
  result.taken.push_back(name + ": a profile of ours");
  result.flights.push_back(flight_of({stored->input_flight, stored->input_file, profile_of(*stored)}, name));
}

/// Takes one file as what it is.
void take(const std::filesystem::path& path, CompareResult& result, std::vector<ReferenceFile>& references) {
  const auto name = path.filename().string();
  const auto text = read_whole(path);
  if (!text) {
    result.failures.push_back(text.error());
    return;
  }
  if (is_netcdf(*text)) return take_netcdf(path, *text, result);
  if (table_kind(*text) != TableKind::none) {
    auto tables = read_tables(*text, path.string());
    if (!tables) {
      result.failures.push_back(tables.error());
      return;
    }
    const bool series = std::holds_alternative<estimator::WindSeries>(tables->front().content);
    result.taken.push_back(fmt::format("{}: {} of ours", name, series ? "a wind" : "a profile"));
    for (auto& table : *tables) result.flights.push_back(flight_of(std::move(table), name));
    return;
  }
  auto reference = reference_of(path, *text);
  if (!reference) {
    result.failures.push_back(reference.error());
    return;
  }
  const bool truth = std::holds_alternative<ingest::Truth>(reference->content);
  result.taken.push_back(fmt::format("{}: {}", name, truth ? "a table of the true wind" : "reports of a station"));
  references.push_back(std::move(*reference));
}

}  // namespace

bool CompareResult::with_doubts() const {
  return !failures.empty() || std::any_of(flights.begin(), flights.end(), [](const ComparedFlight& flight) {
    return !flight.comparison.problems().empty();
  });
}

ingest::Result<CompareResult> compare_files(const std::vector<std::filesystem::path>& files,
                                            const ReferenceSettings& settings, const Control& control) {
  if (const auto place = reference_place(settings.reference_at); !place) return fail(place.error());
  CompareResult result;
  std::vector<ReferenceFile> references;
  control.report("reading", 0);
  for (const auto& file : files) {
    if (control.stopped()) return fail(stopped_problem());
    take(file, result, references);
  }
  const bool no_profile = result.flights.empty(), no_reference = references.empty();
  if (no_profile || no_reference) {
    if (!result.failures.empty()) {
      result.flights.clear();
      return result;
    }
    return fail(Kind::usage, fmt::format("there is no {} among these files", no_profile ? "profile" : "reference"), {},
                no_profile ? "add a profile or wind that quadsonde wrote as .csv or .json"
                           : "add a table of the true wind, a METAR list or a table of a station");
  }
  for (auto& flight : result.flights) {
    if (control.stopped()) return fail(stopped_problem());
    flight.comparison =
        compare_with({flight.series ? &*flight.series : nullptr, nullptr, flight.profile ? &*flight.profile : nullptr},
                     references, settings);
  }
  return result;
}

std::string compared_text(const ComparedFlight& flight) {
  const auto& title = flight.title;
  auto text = title_text(title) + ", " + (title.start ? minute_text(*title.start) : "date not known");
  if (title.place) text += ", " + place_text(*title.place);
  return wrapped(text) + "\n\n" + comparison_text(flight.comparison);
}

std::string compared_svg(const ComparedFlight& flight) {
  ProfilePicture picture{flight.title, "", flight.comparison.levels, "true wind", "profile", flight.comparison.marks};
  return profile_svg(flight.profile ? *flight.profile : profiles::WindProfile{}, picture);
}

}  // namespace quadsonde::product
