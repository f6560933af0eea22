#include "export/uasdc/observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/cf_netcdf/profile_records.h"
#include "export/uasdc/humidity.h"
#include "profiles/legs.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using estimator::WindPoint;
using ingest::fail;
using ingest::Kind;
using ingest::Result;
using profiles::LegName;

/// A mean that stays empty where nothing was added.
struct Mean {
  double sum = 0, count = 0;
  void add(const std::optional<double>& value) {
    if (value && std::isfinite(*value)) sum += *value, count += 1;
  }
  std::optional<double> value() const { return count > 0 ? std::optional(sum / count) : std::nullopt; }
};

struct AirMean {
  Mean temperature, humidity, pressure, barometer;
  AirState state() const {
    AirState s{temperature.value(), humidity.value(), pressure.value(), {}, {}};
    if (!s.pressure_pa) s.pressure_pa = barometer.value();
    return s;
  }
};

AirState with_vapour(AirState s) {
  if (!s.temperature_k || !s.relative_humidity_pct) return s;
  s.dew_point_k = dew_point_k(*s.temperature_k, *s.relative_humidity_pct);
  if (s.pressure_pa) s.mixing_ratio = mixing_ratio(*s.temperature_k, *s.relative_humidity_pct, *s.pressure_pa);
  return s;
}

template <class T>
bool has(const ingest::Stream<T>* stream) {
  return stream && !stream->empty();
}

/// Which sensors there are, in words.
void name_sensors(Observations& out, const AirRecord& record) {
  const auto any = [&](auto of) {
    return has(record.air) && std::any_of(record.air->value.begin(), record.air->value.end(), of);
  };
  if (any([](const ingest::AirSample& a) { return a.temperature_k || a.relative_humidity_pct; }))
    out.air_from = record.air->source;
  if (any([](const ingest::AirSample& a) { return a.pressure_pa.has_value(); }))
    out.pressure_from = record.air->source;
  else if (has(record.barometer) && std::any_of(record.barometer->value.begin(), record.barometer->value.end(),
                                                [](const auto& b) { return b.pressure_pa.has_value(); }))
    out.pressure_from = "barometer of the autopilot (" + record.barometer->source + ")";
}

/// Means over the bins of the three legs.
class BinAir {
 public:
  BinAir(const profiles::WindProfile& profile, const estimator::WindSeries& series, const AirRecord& record)
      : points_(series.points), bin_m_(profile.bin_m) {
    if (points_.empty() || profile.legs.empty() || profile.legs.front().bins.empty()) return;
    bins_ = profile.legs.front().bins.size();
    lowest_ = std::lround(profile.legs.front().bins.front().bottom / bin_m_);
    for (auto& leg : means_) leg.resize(bins_);
    for (const auto& p : points_) heights_.push_back(height_in(p, profile.datum));
    parts_ = profiles::find_parts(points_, heights_, bin_m_);
    if (has(record.air))
      for (std::size_t i = 0; i < record.air->size(); ++i)
        add(record.air->time[i], [&, i](AirMean& mean) {
          const auto& sample = record.air->value[i];
          mean.temperature.add(sample.temperature_k), mean.humidity.add(sample.relative_humidity_pct);
          mean.pressure.add(sample.pressure_pa);
        });
    if (has(record.barometer))
      for (std::size_t i = 0; i < record.barometer->size(); ++i)
        add(record.barometer->time[i],
            [&, i](AirMean& mean) { mean.barometer.add(record.barometer->value[i].pressure_pa); });
  }

  AirState state(LegName leg, std::size_t bin) const {
    const auto& means = means_[static_cast<std::size_t>(leg)];
    return bin < means.size() ? with_vapour(means[bin].state()) : AirState{};
  }

 private:
  static std::optional<double> height_in(const WindPoint& p, profiles::Datum datum) {
    if (datum == profiles::Datum::agl) return p.height_agl ? std::optional(p.height_agl->m) : std::nullopt;
    return p.height_msl ? std::optional(p.height_msl->m) : std::nullopt;
  }

  /// Adds a sample to the bins that hold its instant; one that is over a second from every step is in none.
  template <class Add>
  void add(ingest::LogTime time, Add add_to) {
    auto after = std::lower_bound(points_.begin(), points_.end(), time,
                                  [](const WindPoint& p, ingest::LogTime t) { return p.time < t; });
    if (after == points_.end() || (after != points_.begin() && time - (after - 1)->time < after->time - time)) --after;
    if (std::abs(ingest::to_seconds(after->time - time)) > 1) return;
    const auto i = static_cast<std::size_t>(after - points_.begin());
    if (!heights_[i]) return;
    const double bin = std::floor(*heights_[i] / bin_m_) - static_cast<double>(lowest_);
    if (!(bin >= 0 && bin < static_cast<double>(bins_))) return;
    const auto b = static_cast<std::size_t>(bin);
    add_to(means_[static_cast<std::size_t>(LegName::all)][b]);
    if (parts_[i] == profiles::Part::up) add_to(means_[static_cast<std::size_t>(LegName::up)][b]);
    if (parts_[i] == profiles::Part::down) add_to(means_[static_cast<std::size_t>(LegName::down)][b]);
  }

  const std::vector<WindPoint>& points_;
  double bin_m_;
  std::size_t bins_ = 0;
  long lowest_ = 0;
  std::vector<std::optional<double>> heights_;
  std::vector<profiles::Part> parts_;
  std::array<std::vector<AirMean>, 3> means_;
};

Result<Observations> finished(Observations out, std::string_view product) {
  if (out.all.empty() && out.bad_left_out)
    return fail(Kind::no_answer, fmt::format("no {}: every wind of this flight is of quality bad", product), {},
                "see the reasons in the CSV, or give --keep-bad");
  if (out.all.empty())
    return fail(Kind::no_answer, fmt::format("no {}: no wind has a time, a place and a height above the sea", product),
                {}, "see the CSV for what is missing");
  std::vector<const Observation*> order;
  for (const auto& o : out.all) order.push_back(&o);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->utc < b->utc; });
  std::vector<Observation> sorted;
  for (const auto* o : order) sorted.push_back(*o);
  out.all = std::move(sorted);
  return out;
}

std::optional<ingest::MslHeight> altitude_of(const profiles::Bin& bin,
                                             const std::optional<ingest::MslHeight>& takeoff) {
  if (bin.height_msl) return bin.height_msl;
  if (bin.height_agl && takeoff) return ingest::above_sea(*bin.height_agl, *takeoff);
  return std::nullopt;
}

bool is_place(ingest::GeoPoint p) {
  return std::abs(p.lat_deg) <= 90 && std::isfinite(p.lon_deg) && std::abs(p.lon_deg) <= 360;
}

/// The last sample at or before a time, if it is fresh.
template <class T>
const T* fresh(const ingest::Stream<T>* stream, ingest::LogTime time) {
  if (!has(stream)) return nullptr;
  const auto at = ingest::last_at_or_before(*stream, time);
  if (at < 0 || time - stream->time[static_cast<std::size_t>(at)] > ingest::seconds(2)) return nullptr;
  return &stream->value[static_cast<std::size_t>(at)];
}

AirState air_at(const AirRecord& record, ingest::LogTime time) {
  AirState s;
  if (const auto* air = fresh(record.air, time))
    s = {air->temperature_k, air->relative_humidity_pct, air->pressure_pa, {}, {}};
  if (const auto* barometer = fresh(record.barometer, time); barometer && !s.pressure_pa)
    s.pressure_pa = barometer->pressure_pa;
  return with_vapour(s);
}

}  // namespace

CodedWind coded_wind(const estimator::MaybeWind& maybe) {
  const auto* wind = std::get_if<WindEstimate>(&maybe);
  if (!wind) return {};
  const auto report = estimator::to_report(*wind);
  if (!std::isfinite(report.speed_m_s)) return {};
  if (report.speed_m_s < 0.05) return {0.0, 0.0};
  return {report.speed_m_s, report.from_deg};
}

Result<Observations> profile_observations(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                          const AirRecord& record, const NetcdfMetadata& metadata, bool keep_bad,
                                          std::string_view product) {
  const auto records = profile_records(profile, metadata, product);
  if (!records) return fail(records.error());
  const BinAir air(profile, series, record);
  Observations out;
  name_sensors(out, record);
  for (const auto& r : records->records) {
    for (std::size_t i = 0; i < r.leg->bins.size(); ++i) {
      const auto& bin = r.leg->bins[i];
      const bool has_wind = std::holds_alternative<WindEstimate>(bin.wind);
      if (bin.quality == estimator::Quality::bad && !keep_bad) {
        ++out.bad_left_out;
        continue;
      }
      const auto altitude = altitude_of(bin, records->takeoff_msl);
      if (!bin.utc || !bin.place || !altitude || !is_place(*bin.place)) {
        out.unplaced += has_wind;  // an empty bin was never anywhere
        continue;
      }
      out.all.push_back(
          {*bin.utc, *bin.place, *altitude, r.leg->name, bin.wind, bin.quality, air.state(r.leg->name, i)});
    }
  }
  return finished(std::move(out), product);
}

Result<Observations> series_observations(const estimator::WindSeries& series, const AirRecord& record, bool keep_bad,
                                         std::string_view product) {
  const auto has_utc = [](const WindPoint& p) { return p.utc.has_value(); };
  if (!series.points.empty() && std::none_of(series.points.begin(), series.points.end(), has_utc))
    return fail(Kind::missing, fmt::format("no {} without UTC: the log's clock never saw it", product), {},
                "give --start-utc T");
  Observations out;
  name_sensors(out, record);
  for (const auto& p : series.points) {
    if (p.quality == estimator::Quality::bad && !keep_bad) {
      ++out.bad_left_out;
    } else if (!p.utc || !p.place || !p.height_msl || !is_place(*p.place)) {
      out.unplaced += std::holds_alternative<WindEstimate>(p.wind);
    } else {
      out.all.push_back({*p.utc, *p.place, *p.height_msl, LegName::all, p.wind, p.quality, air_at(record, p.time)});
    }
  }
  return finished(std::move(out), product);
}

}  // namespace quadsonde::product
