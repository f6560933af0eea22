#include "export/mcap/product_tracks.h"

#include <cmath>

#include "export/csv/json.h"
#include "export/version.h"
#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/proto/products.pb.h"

namespace quadsonde::product {
namespace {

using estimator::NoEstimate;
using estimator::WindEstimate;
using google::protobuf::Message;
using google::protobuf::Timestamp;
namespace own = ingest::own;

/// For fields that are absent while unknown; what is not finite is unknown, too.
template <class Pb>
void set(Pb& message, void (Pb::*setter)(double), std::optional<double> value) {
  if (value && std::isfinite(*value)) (message.*setter)(*value);
}

/// Seconds round down, so that instants before 1970 have the nanos that the format wants.
void set_time(Timestamp& stamp, ingest::UtcTime time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const auto nanos = (time.ns % kSecond + kSecond) % kSecond;
  stamp.set_seconds((time.ns - nanos) / kSecond);
  stamp.set_nanos(static_cast<std::int32_t>(nanos));
}

template <class Height>
std::optional<double> metres(const std::optional<Height>& height) {
  return height ? std::optional(height->m) : std::nullopt;
}

/// Place, wind and quality: fields that a wind and a bin have under the same names.
template <class Pb, class From>
void set_common(Pb& m, const From& from) {
  if (from.utc) set_time(*m.mutable_utc(), *from.utc);
  if (from.place) {
    set(m, &Pb::set_lat_deg, from.place->lat_deg);
    set(m, &Pb::set_lon_deg, from.place->lon_deg);
  }
  set(m, &Pb::set_height_msl_m, metres(from.height_msl));
  set(m, &Pb::set_height_agl_m, metres(from.height_agl));
  m.set_quality(std::string(estimator::name(from.quality)));
  auto reasons = from.reasons;
  if (const auto* none = std::get_if<NoEstimate>(&from.wind)) reasons.add(none->reason);
  for (const auto reason : reasons.list()) m.add_reasons(std::string(estimator::name(reason)));
  const auto* wind = std::get_if<WindEstimate>(&from.wind);
  if (!wind) return;
  const auto report = estimator::to_report(*wind);
  set(m, &Pb::set_wind_north_m_s, wind->v_NA_N.x());
  set(m, &Pb::set_wind_east_m_s, wind->v_NA_N.y());
  set(m, &Pb::set_wind_speed_m_s, report.speed_m_s);
  set(m, &Pb::set_wind_from_deg, report.from_deg);
  if (!wind->has_covariance) return;
  set(m, &Pb::set_sd_wind_north_m_s, std::sqrt(wind->covariance(0, 0)));
  set(m, &Pb::set_sd_wind_east_m_s, std::sqrt(wind->covariance(1, 1)));
  set(m, &Pb::set_cov_wind_east_north_m2_s2, wind->covariance(0, 1));
}

void fill_bin(const profiles::Bin& bin, ProfileBin& m) {
  set_common(m, bin);
  m.set_bin_bottom_m(bin.bottom);
  m.set_bin_top_m(bin.top);
  if (const auto* wind = std::get_if<WindEstimate>(&bin.wind); wind && wind->has_covariance) {
    set(m, &ProfileBin::set_sd_wind_speed_m_s, estimator::speed_sd(*wind));
    set(m, &ProfileBin::set_sd_wind_from_deg, estimator::direction_sd_deg(*wind));
  }
  if (bin.sigma) {
    set(m, &ProfileBin::set_sigma_north_m_s, bin.sigma->x());
    set(m, &ProfileBin::set_sigma_east_m_s, bin.sigma->y());
  }
  m.set_samples(static_cast<std::uint32_t>(bin.samples));
  set(m, &ProfileBin::set_effective_samples, bin.effective_samples);
  set(m, &ProfileBin::set_sd_sampling_m_s, bin.sd_sampling);
  set(m, &ProfileBin::set_sd_calibration_m_s, bin.sd_calibration);
  set(m, &ProfileBin::set_sd_trim_m_s, bin.sd_trim);
  set(m, &ProfileBin::set_spread_from_deg, bin.spread_from_deg);
}

void fill_leg(const profiles::WindProfile& profile, const profiles::Leg& leg, ProfileLeg& m) {
  m.set_leg(std::string(profiles::name(leg.name)));
  m.set_datum(std::string(profiles::name(profile.datum)));
  m.set_bin_m(profile.bin_m);
  if (leg.utc_from) set_time(*m.mutable_utc_from(), *leg.utc_from);
  if (leg.utc_to) set_time(*m.mutable_utc_to(), *leg.utc_to);
  for (const auto& bin : leg.bins) fill_bin(bin, *m.add_bins());
  if (!profile.up_down) return;
  set(m, &ProfileLeg::set_up_down_chi2, profile.up_down->chi2);
  m.set_up_down_degrees_of_freedom(profile.up_down->degrees_of_freedom);
  set(m, &ProfileLeg::set_up_down_p_value, profile.up_down->p_value);
}

Track wind_track(const estimator::WindSeries& series) {
  Track track{std::string(own::kTopicPrefix) + "wind",
              {},
              {},
              std::make_unique<Wind>(),
              [&series](std::size_t i, std::uint64_t, Message& message) {
                auto& m = static_cast<Wind&>(message);
                const auto& point = series.points[i];
                m.set_time_s(ingest::to_seconds(point.time - ingest::LogTime{}));
                set_common(m, point);
                m.set_mode(std::string(estimator::name(series.mode)));
              }};
  for (const auto& point : series.points) track.times.push_back(point.time);
  return track;
}

Track leg_track(const profiles::WindProfile& profile, const profiles::Leg& leg, ingest::LogTime start) {
  return {std::string(own::kTopicPrefix) + "profile/" + std::string(profiles::name(leg.name)),
          {},
          {start},
          std::make_unique<ProfileLeg>(),
          [&profile, &leg](std::size_t, std::uint64_t, Message& message) {
            fill_leg(profile, leg, static_cast<ProfileLeg&>(message));
          }};
}

/// Texts of a record must be UTF-8; names out of a log may be none.
std::string compact(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

void add_product_tracks(std::vector<Track>& tracks, const FlightProducts& products, ingest::LogTime start,
                        const FlightFileSettings& settings) {
  const auto add = [&](Track track) {
    track.json = settings.encoding == FlightFileSettings::Encoding::json;
    tracks.push_back(std::move(track));
  };
  if (products.wind) add(wind_track(*products.wind));
  if (!products.profile) return;
  for (const auto& leg : products.profile->legs) add(leg_track(*products.profile, leg, start));
}

ingest::Result<void> write_product_metadata(ingest::mcap::Writer& writer, const FlightProducts& products) {
  if (!products.source) return {};
  const auto& source = *products.source;
  ingest::mcap::Writer::Pairs pairs{{"version", std::string(version())},
                                    {"file", own::utf8(source.file)},
                                    {"sha256", source.sha256},
                                    {"flight", std::to_string(source.flight)},
                                    {"vehicle", compact(json_vehicle(source.vehicle))},
                                    {"settings", compact(json_settings(source.settings))},
                                    {"problems", compact(json_problems(source.problems))}};
  if (products.wind) pairs.emplace_back("diagnostics", compact(json_diagnostics(products.wind->diagnostics)));
  return writer.add_metadata(own::kProduct, pairs);
}

}  // namespace quadsonde::product
