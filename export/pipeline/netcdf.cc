#include "export/pipeline/netcdf.h"

#include "export/cf_netcdf/cf_netcdf.h"

namespace quadsonde::product {
namespace {

NetcdfMetadata metadata_of(const FlightAnswer& answer) {
  NetcdfMetadata metadata;
  metadata.vehicle = answer.title.vehicle;
  metadata.autopilot = answer.title.autopilot;
  metadata.takeoff = answer.title.place;
  metadata.takeoff_msl = answer.part.takeoff;
  const auto& boot = *answer.part.boot;
  if (const auto span = ingest::time_span(boot)) metadata.log_end = boot.clock.to_utc(span->second);
  return metadata;
}

ingest::Result<std::string> with_file(ingest::Result<std::string> bytes, const FlightAnswer& answer) {
  if (!bytes && bytes.error().where.file.empty()) bytes.error().where.file = answer.source.file;
  return bytes;
}

}  // namespace

ingest::Result<std::string> profile_netcdf_of(const FlightAnswer& answer) {
  return with_file(profile_netcdf(*answer.profile, answer.source, metadata_of(answer)), answer);
}

ingest::Result<std::string> wind_netcdf_of(const FlightAnswer& answer) {
  return with_file(wind_netcdf(answer.series, answer.source, metadata_of(answer)), answer);
}

}  // namespace quadsonde::product
