#pragma once
// What a netCDF file says of itself as a whole.
#include <optional>
#include <string>

#include "export/cf_netcdf/cf_netcdf.h"
#include "export/cf_netcdf/nc_file.h"

namespace quadsonde::product {

/// Smallest and largest of what was added.
struct Extent {
  std::optional<double> low, high;
  void add(double value);
};

/// What the data cover, and in which words the product names itself.
struct ProductText {
  std::string feature_type, cdm_data_type, title, summary, processing_level, comment;
  Extent lat, lon, altitude;
  ingest::UtcTime from, to;
  std::optional<double> time_step_s;  ///< between two values
  std::string vertical_resolution;
};

/// SOURCE_DATE_EPOCH where it is set and a number, else the end of the log, else the last sample.
ingest::UtcTime made_at(const NetcdfMetadata& metadata, ingest::UtcTime last_sample);
/// The flight's name in identifiers: letters, digits and ._- only.
std::string flight_id(const NetcdfMetadata& metadata, const ProductSource& source);
/// With "_" for everything else.
std::string identifier(std::string text);
/// Where heights above the sea come from and which grid gave the geoid, for a file's comment.
std::string heights_text(const ProductSource& source, const std::string& geoid);
/// The platform in words: its type and its name, as the station file or else the log has them.
std::string platform_text(const NetcdfMetadata& metadata);
/// "PT2M", "PT2.5S": ISO 8601.
std::string iso_duration(double seconds);
/// Conventions, ACDD and where the numbers come from.
void write_global_attributes(NcFile& file, const ProductText& text, const ProductSource& source,
                             const NetcdfMetadata& metadata);
/// The same without where the numbers come from.
void write_common_attributes(NcFile& file, const ProductText& text, const NetcdfMetadata& metadata,
                             const std::string& id);
/// Input, settings, vehicle, station and problems: what the numbers were made of.
void write_provenance(NcFile& file, const ProductSource& source, const NetcdfMetadata& metadata);
/// Texts of one length, as netCDF arrays of characters want them.
std::string padded(std::string text, std::size_t length);

}  // namespace quadsonde::product
