#pragma once
// An answer in the form that an output's ending asks for.
#include <filesystem>
#include <optional>
#include <string>

#include "export/pipeline/analyse.h"

namespace quadsonde::product {

enum class Format { csv, json, svg, html, netcdf };

/// By the ending of a name; empty for one that is not written here.
std::optional<Format> format_of(const std::filesystem::path& path);

/// Only netCDF can fail: without UTC, place or height above the sea.
ingest::Result<std::string> render_wind(const FlightAnswer& answer, Format format);
/// The answer must have a profile, except for html, whose page then shows the wind along the flight only.
ingest::Result<std::string> render_profile(const FlightAnswer& answer, Format format);

}  // namespace quadsonde::product
