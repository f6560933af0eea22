#include "export/cf_netcdf/profile_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Result;
using profiles::Bin;
using profiles::Leg;

bool has_samples(const Leg& leg) {
  return std::any_of(leg.bins.begin(), leg.bins.end(),
                     [](const Bin& bin) { return std::holds_alternative<estimator::WindEstimate>(bin.wind); });
}

/// Up and down where there are such, else all.
std::vector<const Leg*> legs_to_write(const profiles::WindProfile& profile) {
  std::vector<const Leg*> parts, merged;
  for (const auto& leg : profile.legs)
    if (has_samples(leg)) (leg.name == profiles::LegName::all ? merged : parts).push_back(&leg);
  return parts.empty() ? merged : parts;
}

/// Its own first and last sample, else what its bins know.
std::optional<std::pair<ingest::UtcTime, ingest::UtcTime>> span_of(const Leg& leg) {
  if (leg.utc_from && leg.utc_to) return std::pair{*leg.utc_from, *leg.utc_to};
  std::optional<std::pair<ingest::UtcTime, ingest::UtcTime>> span;
  for (const auto& bin : leg.bins) {
    if (!bin.utc) continue;
    if (!span) span = {*bin.utc, *bin.utc};
    span->first = std::min(span->first, *bin.utc);
    span->second = std::max(span->second, *bin.utc);
  }
  return span;
}

/// Take-off lies where the two heights of any bin differ from each other by.
std::optional<ingest::MslHeight> takeoff_of(const std::vector<ProfileRecord>& records, const NetcdfMetadata& metadata) {
  if (metadata.takeoff_msl) return metadata.takeoff_msl;
  for (const auto& record : records)
    for (const auto& bin : record.leg->bins)
      if (bin.height_agl && bin.height_msl) return ingest::MslHeight{bin.height_msl->m - bin.height_agl->m};
  return std::nullopt;
}

bool find_place(ProfileRecords& out, const std::optional<ingest::GeoPoint>& takeoff) {
  if (takeoff) {
    out.place = *takeoff;
    out.place_is_takeoff = true;
    return true;
  }
  double lat = 0, lon = 0, count = 0;
  std::optional<double> first_lon;
  for (const auto& record : out.records) {
    for (const auto& bin : record.leg->bins) {
      if (!bin.place) continue;
      if (!first_lon) first_lon = bin.place->lon_deg;
      // Differences, so that a flight across the date line stays there.
      lat += bin.place->lat_deg, lon += std::remainder(bin.place->lon_deg - *first_lon, 360), count += 1;
    }
  }
  if (count > 0) out.place = {lat / count, std::remainder(*first_lon + lon / count, 360)};
  return count > 0;
}

Result<void> fill_axis(ProfileRecords& out, profiles::Datum datum, std::string_view product) {
  if (datum == profiles::Datum::agl && !out.takeoff_msl)
    return fail(Kind::missing,
                fmt::format("no {} without heights above the sea: that of the take-off point is not known", product),
                {}, "give --takeoff-msl M");
  const double base = datum == profiles::Datum::agl ? out.takeoff_msl->m : 0;
  const auto& bins = out.records.front().leg->bins;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const bool follows = i == 0 || std::abs(bins[i].bottom - bins[i - 1].top) < 1e-6;
    if (!(bins[i].top > bins[i].bottom) || !follows || !std::isfinite(base + bins[i].bottom + bins[i].top))
      return fail(Kind::inconsistent, "the bins of the profile do not follow each other", {},
                  "report this together with the log");
    out.bottom.push_back(base + bins[i].bottom);
    out.top.push_back(base + bins[i].top);
    out.altitude.push_back(base + (bins[i].bottom + bins[i].top) / 2);
  }
  for (const auto& record : out.records) {
    const auto& other = record.leg->bins;
    if (!std::equal(bins.begin(), bins.end(), other.begin(), other.end(),
                    [](const Bin& a, const Bin& b) { return a.bottom == b.bottom && a.top == b.top; }))
      return fail(Kind::inconsistent, "the legs of the profile have different bins", {},
                  "report this together with the log");
  }
  return {};
}

/// With their altitudes and their place.
Result<ProfileRecords> placed(ProfileRecords out, profiles::Datum datum, const NetcdfMetadata& metadata,
                              std::string_view product) {
  out.takeoff_msl = takeoff_of(out.records, metadata);
  if (auto filled = fill_axis(out, datum, product); !filled) return fail(filled.error());
  if (!find_place(out, metadata.takeoff))
    return fail(Kind::missing, fmt::format("no {} without a place: the flight has no latitude and longitude", product),
                {}, "log the position of the GNSS receiver");
  return out;
}

}  // namespace

double ProfileRecord::mid_s() const { return static_cast<double>(from.ns / 2 + to.ns / 2) * 1e-9; }

Result<ProfileRecords> profile_records(const profiles::WindProfile& profile, const NetcdfMetadata& metadata,
                                       std::string_view product) {
  ProfileRecords out;
  for (const auto* leg : legs_to_write(profile)) {
    const auto span = span_of(*leg);
    if (!span)
      return fail(Kind::missing, fmt::format("no {} without UTC: the log's clock never saw it", product), {},
                  "give --start-utc T");
    out.records.push_back({leg, std::string(profiles::name(leg->name)), span->first, span->second});
  }
  if (out.records.empty())
    return fail(Kind::no_answer, "no bin of the profile has a wind, so there is nothing to write", {},
                "see the reasons in the CSV (-o X.csv)");
  std::stable_sort(out.records.begin(), out.records.end(),
                   [](const auto& a, const auto& b) { return a.mid_s() < b.mid_s(); });
  return placed(std::move(out), profile.datum, metadata, product);
}

Result<ProfileRecords> section_records(const profiles::Section& section, const NetcdfMetadata& metadata) {
  ProfileRecords out;
  for (std::size_t i = 0; i < section.columns.size(); ++i) {
    const auto& column = section.columns[i];
    // The stem of the flight's name: letters that an identifier may hold are seen to by whoever writes it.
    const auto stem = column.flight.substr(0, column.flight.find('.'));
    out.records.push_back(
        {&column.leg, fmt::format("{}-{}-{}", stem, i + 1, profiles::name(column.leg.name)), column.from, column.to});
    if (i > 0 && out.records[i].mid_s() <= out.records[i - 1].mid_s())
      return fail(Kind::inconsistent,
                  fmt::format("two legs of {} and {} share their mid time, and a time axis must grow",
                              section.columns[i - 1].flight, column.flight),
                  {}, "leave one of the flights out");
  }
  if (out.records.empty())
    return fail(Kind::no_answer, "the section has no column", {}, "give flights that have a wind");
  return placed(std::move(out), section.datum, metadata, "netCDF");
}

}  // namespace quadsonde::product
