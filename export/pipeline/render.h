#pragma once
// An answer in the form that an output's ending asks for.
#include <filesystem>
#include <optional>
#include <string>

#include "export/pipeline/analyse.h"

namespace quadsonde::product {

enum class Format { csv, json, svg, html, netcdf, bufr, geojson, kml, met_point, mcap };

/// By the ending of a name; empty for one that is not written here.
std::optional<Format> format_of(const std::filesystem::path& path);

/// Can fail are netCDF, without UTC, place or height above the sea; GeoJSON and KML without a place; BUFR and
/// met_point, which hold profiles only. answer.product tells which netCDF and which BUFR.
ingest::Result<std::string> render_wind(const FlightAnswer& answer, Format format);
/// SVG of the filters' state along the flight: airspeed and wind, north and east.
std::string render_state(const FlightAnswer& answer);
/// As render_wind. The answer must have a profile, except for html, whose page then shows the wind along the flight only.
ingest::Result<std::string> render_profile(const FlightAnswer& answer, Format format);

/// The answer's section, which it must have, as CSV, JSON, netCDF, SVG or, where it has a profile too, a page.
ingest::Result<std::string> render_section(const FlightAnswer& answer, Format format);
/// Whether a format can hold a section.
bool holds_sections(Format format);

}  // namespace quadsonde::product
