#include "export/met_point/met_point.h"

#include <fmt/format.h>

#include <cmath>

#include "export/csv/numbers.h"

namespace quadsonde::product {
namespace {

constexpr std::size_t longest_station = 40;

/// One word of at most 40 characters: ascii2nc splits lines at blanks.
std::string station_word(const NetcdfMetadata& metadata, ingest::GeoPoint first) {
  auto word = metadata.station.site();
  if (word.empty()) {
    const auto place = metadata.takeoff.value_or(first);
    word = fmt::format("{:.4f},{:.4f}", place.lat_deg, place.lon_deg);
  }
  for (auto& c : word)
    if (c <= ' ' || c > '~') c = '_';
  return word.substr(0, longest_station);
}

/// YYYYMMDD_HHMMSS, the nearest second.
std::string valid_time(ingest::UtcTime time) {
  std::string text;
  for (const char c : ingest::to_iso8601(time + ingest::Duration(500'000'000), 0)) {
    if (c >= '0' && c <= '9') text += c;
    if (c == 'T') text += '_';
  }
  return text;
}

std::string or_na(const std::optional<double>& value, int digits) {
  const auto text = fixed(value, digits);
  return text.empty() ? "NA" : text;
}

const char* quality_word(estimator::Quality quality) {
  constexpr const char* words[] = {"0", "1", "3", "NA"};
  return words[static_cast<std::size_t>(quality)];
}

}  // namespace

std::string met_point(const Observations& observations, const NetcdfMetadata& metadata) {
  std::string text;
  if (observations.all.empty()) return text;
  const auto station = station_word(metadata, observations.all.front().place);
  const auto elevation =
      or_na(metadata.takeoff_msl ? std::optional(metadata.takeoff_msl->m) : std::nullopt, digits::metres);
  for (const auto& o : observations.all) {
    const auto head =
        fmt::format("ADPUPA {} {} {} {} {}", station, valid_time(o.utc), fixed(o.place.lat_deg, digits::degrees),
                    fixed(std::remainder(o.place.lon_deg, 360), digits::degrees), elevation);
    const auto pressure_hpa = o.air.pressure_pa ? std::optional(*o.air.pressure_pa / 100) : std::nullopt;
    const auto put = [&](const char* name, const std::optional<double>& value, int places, const char* quality) {
      const auto number = fixed(value, places);
      if (!number.empty())
        text += fmt::format("{} {} {} {} {} {}\n", head, name, or_na(pressure_hpa, 2),
                            fixed(o.altitude.m, digits::metres), quality, number);
    };
    const auto* wind = std::get_if<estimator::WindEstimate>(&o.wind);
    const auto coded = coded_wind(o.wind);
    const auto* quality = quality_word(o.quality);
    put("UGRD", wind ? std::optional(wind->v_NA_N.y()) : std::nullopt, digits::speed, quality);
    put("VGRD", wind ? std::optional(wind->v_NA_N.x()) : std::nullopt, digits::speed, quality);
    put("WIND", coded.speed_m_s, digits::speed, quality);
    put("WDIR", coded.from_deg, digits::direction, quality);
    put("TMP", o.air.temperature_k, 2, "NA");
    put("DPT", o.air.dew_point_k, 2, "NA");
    put("RH", o.air.relative_humidity_pct, 2, "NA");
    put("MIXR", o.air.mixing_ratio, 7, "NA");
  }
  return text;
}

}  // namespace quadsonde::product
