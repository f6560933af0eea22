#include "export/atomic_file.h"
#include "export/cf_netcdf/cf_netcdf.h"

namespace quadsonde::product {
namespace {

ingest::Result<void> write_bytes(const std::filesystem::path& path, const ingest::Result<std::string>& bytes,
                                 bool overwrite) {
  if (!bytes) return ingest::fail(bytes.error());
  return write_file(path, *bytes, overwrite);
}

}  // namespace

ingest::Result<void> write_profile_netcdf(const std::filesystem::path& path, const profiles::WindProfile& profile,
                                          const ProductSource& source, const NetcdfMetadata& metadata, bool overwrite) {
  return write_bytes(path, profile_netcdf(profile, source, metadata), overwrite);
}

ingest::Result<void> write_wind_netcdf(const std::filesystem::path& path, const estimator::WindSeries& series,
                                       const ProductSource& source, const NetcdfMetadata& metadata, bool overwrite) {
  return write_bytes(path, wind_netcdf(series, source, metadata), overwrite);
}

}  // namespace quadsonde::product
