#include "export/bufr/bufr.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "export/bufr/bufr_message.h"
#include "export/bufr/elements.h"
#include "export/cf_netcdf/profile_records.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using ingest::fail;
using ingest::Kind;
using ingest::Result;
using ingest::UtcTime;
using profiles::Bin;
using profiles::LegName;
using Values = std::vector<std::optional<double>>;

constexpr std::size_t most_levels = 254;    // of one 0 31 001
constexpr std::size_t most_subsets = 2000;  // of one message, which then has about 100 kB at most

ingest::GeoPoint in_range(ingest::GeoPoint p) { return {p.lat_deg, std::remainder(p.lon_deg, 360)}; }

std::optional<double> sd_of(const Bin& bin, int axis) {
  const auto* wind = std::get_if<WindEstimate>(&bin.wind);
  if (!wind || !wind->has_covariance) return std::nullopt;
  return std::sqrt(wind->covariance(axis, axis));
}

/// One level of a leg that is written.
struct Level {
  const Bin* bin;
  double altitude;  ///< of the middle of the bin [m]
};

struct LegLevels {
  const ProfileRecord* record;
  std::vector<Level> levels;
};

Result<std::vector<LegLevels>> levels_of(const ProfileRecords& records, const BufrRequest& request) {
  std::vector<LegLevels> legs;
  bool any_wind = false;
  for (const auto& record : records.records) {
    LegLevels leg{&record, {}};
    for (std::size_t i = 0; i < record.leg->bins.size(); ++i) {
      const auto& bin = record.leg->bins[i];
      if (bin.quality == estimator::Quality::bad && !request.keep_bad) continue;
      leg.levels.push_back({&bin, records.altitude[i]});
    }
    const bool has_wind = std::any_of(leg.levels.begin(), leg.levels.end(), [](const Level& level) {
      return std::holds_alternative<WindEstimate>(level.bin->wind);
    });
    if (has_wind) legs.push_back(std::move(leg));
    any_wind = any_wind || has_wind;
  }
  if (!any_wind)
    return fail(Kind::no_answer, "no BUFR: every wind of this flight is of quality bad", {},
                "see the reasons in the CSV, or give --keep-bad");
  return legs;
}

void set_place(BufrMessage& message, std::size_t rank, const std::optional<ingest::GeoPoint>& place) {
  const auto p = place ? std::optional(in_range(*place)) : std::nullopt;
  message.set(rank, "latitude", p ? within(element::latitude, p->lat_deg) : std::nullopt);
  message.set(rank, "longitude", p ? within(element::longitude, p->lon_deg) : std::nullopt);
}

/// Height of the ground at the site; where take-off is not known, neither is it.
std::optional<double> ground(const ProfileRecords& records) {
  return records.takeoff_msl ? within(element::station_height, records.takeoff_msl->m) : std::nullopt;
}

/// 0-20000-0-IIiii is the old index of a station: block and number. Source: WMO-No. 1160, section 2.2.1.
void set_old_index(BufrMessage& message, const Station& station) {
  std::optional<double> block, number;
  const auto id = parse_wigos_id(station.wigos_id);
  const auto digits = [](const std::string& s) { return s.find_first_not_of("0123456789") == std::string::npos; };
  if (id && id->series == 0 && id->issuer == 20000 && id->number == 0 && id->local.size() == 5 && digits(id->local)) {
    block = std::stoi(id->local.substr(0, 2));
    number = std::stoi(id->local.substr(2));
  }
  message.set("blockNumber", block);
  message.set("stationNumber", number);
}

/// Levels of 3 09 021, ranks from 1; the latitude of the station is the first.
void set_profiler_level(BufrMessage& message, std::size_t rank, const Level& level, double bin_m) {
  const auto& bin = *level.bin;
  const auto* wind = std::get_if<WindEstimate>(&bin.wind);
  auto north = wind ? within(element::wind_component, wind->v_NA_N.x()) : std::nullopt;
  auto east = wind ? within(element::wind_component, wind->v_NA_N.y()) : std::nullopt;
  if (!north || !east) north = east = std::nullopt;
  const auto sd = [&](int axis) { return east ? within(element::wind_component, sd_of(bin, axis)) : std::nullopt; };
  message.set(rank, "height", within(element::height, level.altitude));
  set_place(message, rank + 1, bin.place);
  message.set(rank, "u", east);
  message.set(rank, "uncertaintyInUComponent", sd(1));
  message.set(rank, "v", north);
  message.set(rank, "uncertaintyInVComponent", sd(0));
  message.set(2 * rank - 1, "qualityInformation", east ? quality_0_33_002(bin.quality) : std::nullopt);
  message.set(rank, "w", std::nullopt);
  message.set(rank, "uncertaintyInWComponent", std::nullopt);
  message.set(2 * rank, "qualityInformation", std::nullopt);
  message.set(rank, "verticalResolution", within(element::vertical_resolution, bin_m));
  message.set(rank, "horizontalWidthOfSampledVolume", std::nullopt);
}

/// 3 01 014 is a period, begin and end to the minute: it holds the whole leg.
Result<std::string> profiler_message(const ProfileRecords& records, const ProfileRecord& leg,
                                     std::span<const Level> levels, const Station& station, double bin_m) {
  BufrMessage message({leg.from, {301150, 309021}, {static_cast<long>(levels.size())}});
  set_wigos(message, station);
  set_old_index(message, station);
  set_place(message, 1, records.place);
  message.set("heightOfStationGroundAboveMeanSeaLevel", ground(records));
  const auto almost_a_minute = ingest::Duration(59'999'999'999);
  set_time(message, 1, leg.from, false);
  set_time(message, 2, leg.to + almost_a_minute, false);
  message.set("measuringEquipmentType", std::nullopt);  // 0 02 003 has no number for a tilted multirotor
  message.set("meanFrequency", std::nullopt);
  for (std::size_t i = 0; i < levels.size(); ++i) set_profiler_level(message, i + 1, levels[i], bin_m);
  return message.finish();
}

/// Averages over a leg, whose end is the message's time: the period before it, and where in it each level lies.
Result<std::string> own_message(const ProfileRecords& records, const ProfileRecord& leg, std::span<const Level> levels,
                                const Station& station) {
  BufrMessage message(
      {leg.from,
       {301150, 1008,   1095,  301011, 301013, 301021, 7030,   8021,  4026,   116000, 31001, 7007,  301021, 4026,
        202129, 201132, 11001, 202000, 201000, 202129, 201132, 11002, 201000, 202000, 11110, 11111, 33003},
       {static_cast<long>(levels.size())}});
  set_wigos(message, station);
  message.set_text("aircraftRegistrationNumberOrOtherIdentification", station.airframe_id);
  message.set_text("observerIdentification", station.operator_id);
  set_time(message, 1, leg.to, true);
  set_place(message, 1, records.place);
  message.set("heightOfStationGroundAboveMeanSeaLevel", ground(records));
  message.set("timeSignificance", 2);  // time averaged
  message.set(1, "timePeriod", within(element::time_period, ingest::to_seconds(leg.from - leg.to)));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto& bin = *levels[i].bin;
    const auto wind = bufr_wind(bin.wind, element::fine_wind_speed, element::fine_wind_from, true);
    const auto sd = [&](int axis) {
      return wind.speed_m_s ? within(element::wind_component, sd_of(bin, axis)) : std::nullopt;
    };
    message.set(i + 1, "height", within(element::height, levels[i].altitude));
    set_place(message, i + 2, bin.place);
    message.set(i + 2, "timePeriod",
                bin.utc ? within(element::time_period, ingest::to_seconds(*bin.utc - leg.to)) : std::nullopt);
    message.set(i + 1, "windDirection", wind.from_deg);
    message.set(i + 1, "windSpeed", wind.speed_m_s);
    message.set(i + 1, "uncertaintyInUComponent", sd(1));
    message.set(i + 1, "uncertaintyInVComponent", sd(0));
    message.set(i + 1, "qualityInformation", wind.speed_m_s ? quality_0_33_003(bin.quality) : std::nullopt);
  }
  return message.finish();
}

/// 0 08 009, detailed phase of flight: 5 ascending, 6 descending.
std::optional<double> phase(LegName leg) {
  if (leg == LegName::all) return std::nullopt;
  return leg == LegName::up ? 5.0 : 6.0;
}

BufrWind coded(const Observation& o) { return bufr_wind(o.wind, element::wind_speed, element::wind_from, false); }

/// One subset per observation, compressed. Both elements of its height (0 07 002, 0 07 010) hold the altitude.
Result<std::string> uasdc_message(std::span<const Observation> all, const Station& station) {
  BufrMessage message({all.front().utc,
                       {301150, 12103,  7004,   10003,  7002,  7009,   1008,   1095,  301011, 301013, 301021,
                        1013,   8009,   7010,   33003,  11001, 11002,  12101,  2170,  201135, 202130, 13003,
                        202000, 201000, 201144, 202133, 13002, 202000, 201000, 11073, 11075},
                       {},
                       all.size()});
  const auto put = [&](const char* key, auto value_of) {
    Values values;
    for (const auto& o : all) values.push_back(value_of(o));
    message.set(key, values);
  };
  set_wigos(message, station);
  message.set_text("aircraftRegistrationNumberOrOtherIdentification", station.airframe_id);
  message.set_text("observerIdentification", station.operator_id);
  using O = const Observation&;
  put("year", [](O o) { return split_utc(o.utc).year; });
  put("month", [](O o) { return split_utc(o.utc).month; });
  put("day", [](O o) { return split_utc(o.utc).day; });
  put("hour", [](O o) { return split_utc(o.utc).hour; });
  put("minute", [](O o) { return split_utc(o.utc).minute; });
  put("second", [](O o) { return split_utc(o.utc).second; });
  put("latitude", [](O o) { return within(element::latitude, in_range(o.place).lat_deg); });
  put("longitude", [](O o) { return within(element::longitude, in_range(o.place).lon_deg); });
  put("height", [](O o) { return within(element::altitude, o.altitude.m); });
  put("flightLevel", [](O o) { return within(element::flight_level, o.altitude.m); });
  put("detailedPhaseOfFlight", [](O o) { return phase(o.leg); });
  put("windSpeed", [](O o) { return coded(o).speed_m_s; });
  put("windDirection", [](O o) { return coded(o).from_deg; });
  put("qualityInformation", [](O o) { return coded(o).speed_m_s ? quality_0_33_003(o.quality) : std::nullopt; });
  put("airTemperature", [](O o) { return within(element::temperature, o.air.temperature_k); });
  put("dewpointTemperature", [](O o) { return within(element::temperature, o.air.dew_point_k); });
  put("relativeHumidity", [](O o) { return within(element::humidity, o.air.relative_humidity_pct); });
  put("mixingRatio", [](O o) { return within(element::mixing_ratio, o.air.mixing_ratio); });
  put("pressure", [](O o) { return within(element::pressure, o.air.pressure_pa); });
  return message.finish();
}

Result<std::string> uasdc_messages(const Observations& observations, const Station& station) {
  const auto& list = observations.all;
  if (std::none_of(list.begin(), list.end(), [](const Observation& o) { return coded(o).speed_m_s.has_value(); }))
    return fail(Kind::no_answer, "no BUFR of speeds and directions: no direction of this flight is determined", {},
                "give --bufr profiler, which has the components of the wind");
  std::string bytes;
  const std::span<const Observation> all(observations.all);
  for (std::size_t at = 0; at < all.size(); at += most_subsets) {
    auto message = uasdc_message(all.subspan(at, std::min(most_subsets, all.size() - at)), station);
    if (!message) return message;
    bytes += *message;
  }
  return bytes;
}

}  // namespace

Result<std::string> profile_bufr(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                 const AirRecord& record, const NetcdfMetadata& metadata, const BufrRequest& request) {
  if (profile.bin_m < 1)
    return fail(Kind::usage, "BUFR counts heights in whole metres: bins below 1 m would collide", {},
                "give --bin-m 1 or more");
  if (request.form == BufrForm::uasdc) {
    const auto observations = profile_observations(profile, series, record, metadata, request.keep_bad, "BUFR");
    if (!observations) return fail(observations.error());
    return uasdc_messages(*observations, metadata.station);
  }
  const auto records = profile_records(profile, metadata, "BUFR");
  if (!records) return fail(records.error());
  const auto legs = levels_of(*records, request);
  if (!legs) return fail(legs.error());
  std::string bytes;
  for (const auto& leg : *legs) {
    const std::span<const Level> all(leg.levels);
    for (std::size_t at = 0; at < all.size(); at += most_levels) {
      const auto levels = all.subspan(at, std::min(most_levels, all.size() - at));
      auto message = request.form == BufrForm::own
                         ? own_message(*records, *leg.record, levels, metadata.station)
                         : profiler_message(*records, *leg.record, levels, metadata.station, profile.bin_m);
      if (!message) return message;
      bytes += *message;
    }
  }
  return bytes;
}

}  // namespace quadsonde::product
