#include "export/pipeline/netcdf.h"

#include "export/bufr/bufr.h"
#include "export/met_point/met_point.h"
#include "export/uasdc/uasdc.h"

namespace quadsonde::product {
namespace {

template <class T>
ingest::Result<T> with_file(ingest::Result<T> made, const FlightAnswer& answer) {
  if (!made && made.error().where.file.empty()) made.error().where.file = answer.source.file;
  return made;
}

AirRecord air_of(const FlightAnswer& answer) { return {&answer.part.boot->air, &answer.part.boot->barometer}; }

ingest::Result<Observations> observations_of(const FlightAnswer& answer, std::string_view product) {
  const bool keep_bad = answer.product.keep_bad;
  return answer.profile ? profile_observations(*answer.profile, answer.series, air_of(answer), metadata_of(answer),
                                               keep_bad, product)
                        : series_observations(answer.series, air_of(answer), keep_bad, product);
}

ingest::Result<NamedProduct> make_uasdc(const FlightAnswer& answer, bool named) {
  const auto observations = observations_of(answer, "UASDC netCDF");
  if (!observations) return ingest::fail(observations.error());
  NamedProduct made;
  if (named) {
    auto name = uasdc_file_name(answer.station, observations->all.front().utc);
    if (!name) return ingest::fail(name.error());
    made.name = std::move(*name);
  }
  auto bytes = uasdc_netcdf(*observations, answer.source, metadata_of(answer));
  if (!bytes) return ingest::fail(bytes.error());
  made.bytes = std::move(*bytes);
  return made;
}

}  // namespace

NetcdfMetadata metadata_of(const FlightAnswer& answer) {
  NetcdfMetadata metadata;
  metadata.station = answer.station;
  metadata.vehicle = answer.title.vehicle;
  metadata.autopilot = answer.title.autopilot;
  metadata.takeoff = answer.title.place;
  metadata.takeoff_msl = answer.part.takeoff;
  const auto& boot = *answer.part.boot;
  if (const auto span = ingest::time_span(boot)) metadata.log_end = boot.clock.to_utc(span->second);
  return metadata;
}

ingest::Result<std::string> profile_netcdf_of(const FlightAnswer& answer) {
  return with_file(profile_netcdf(*answer.profile, answer.source, metadata_of(answer)), answer);
}

ingest::Result<std::string> section_netcdf_of(const FlightAnswer& answer) {
  return with_file(section_netcdf(*answer.section, answer.source, metadata_of(answer)), answer);
}

ingest::Result<std::string> wind_netcdf_of(const FlightAnswer& answer) {
  return with_file(wind_netcdf(answer.series, answer.source, metadata_of(answer)), answer);
}

ingest::Result<std::string> uasdc_of(const FlightAnswer& answer) {
  auto made = with_file(make_uasdc(answer, false), answer);
  if (!made) return ingest::fail(made.error());
  return std::move(made->bytes);
}

ingest::Result<NamedProduct> named_uasdc_of(const FlightAnswer& answer) {
  return with_file(make_uasdc(answer, true), answer);
}

ingest::Result<std::string> bufr_of(const FlightAnswer& answer) {
  BufrRequest request;
  const auto& form = answer.product.bufr;
  request.form = form == "uasdc" ? BufrForm::uasdc : form == "own" ? BufrForm::own : BufrForm::profiler;
  request.keep_bad = answer.product.keep_bad;
  return with_file(profile_bufr(*answer.profile, answer.series, air_of(answer), metadata_of(answer), request), answer);
}

ingest::Result<std::string> met_point_of(const FlightAnswer& answer) {
  const auto observations = observations_of(answer, "met_point");
  if (!observations) return with_file(ingest::Result<std::string>(ingest::fail(observations.error())), answer);
  return met_point(*observations, metadata_of(answer));
}

}  // namespace quadsonde::product
