#include "export/pipeline/render.h"

#include <fmt/format.h>

#include "export/csv/section_tables.h"
#include "export/csv/tables.h"
#include "export/geojson/geojson.h"
#include "export/kml/kml.h"
#include "export/mcap/products_to_mcap.h"
#include "export/pipeline/netcdf.h"
#include "export/report/report.h"
#include "export/report/state_picture.h"

namespace quadsonde::product {
namespace {

std::string drag_line(const ingest::Vehicle& vehicle) {
  if (vehicle.is_prior())
    return fmt::format("drag: class prior ({}), not calibrated, so speeds are uncertain by about {:.0f} %", vehicle.id,
                       100 * vehicle.parameter_sd(ingest::p_linear) / vehicle.drag.linear);
  return "drag: " + (vehicle.name.empty() ? vehicle.id : vehicle.name) + " (" + vehicle.method + ")";
}

std::string picture_of(const FlightAnswer& answer) {
  ProfilePicture picture{answer.title, drag_line(answer.source.vehicle), {}, "true wind", "profile"};
  if (answer.comparison) picture.reference = answer.comparison->levels, picture.marks = answer.comparison->marks;
  return profile_svg(*answer.profile, picture);
}

std::string series_of(const FlightAnswer& answer) {
  SeriesPicture picture{answer.title, answer.classic ? &*answer.classic : nullptr, "series", {}, "true wind"};
  if (answer.comparison) picture.reference = answer.comparison->along;
  return series_svg(answer.series, picture);
}

std::string page_of(const FlightAnswer& answer) {
  Report report;
  report.title = answer.title;
  report.series = &answer.series;
  report.classic = answer.classic ? &*answer.classic : nullptr;
  report.profile = answer.profile ? &*answer.profile : nullptr;
  report.section = answer.section ? &*answer.section : nullptr;
  report.source = answer.source;
  report.autopilot = answer.autopilot_wind;
  report.velocity = &answer.part.boot->velocity;
  if (answer.comparison) {
    report.reference = answer.comparison->levels;
    report.marks = answer.comparison->marks;
    report.along = answer.comparison->along;
    report.comparison = comparison_sentences(*answer.comparison);
  }
  return report_html(report);
}

ingest::Result<std::string> with_file(ingest::Result<std::string> text, const FlightAnswer& answer) {
  if (!text && text.error().where.file.empty()) text.error().where.file = answer.source.file;
  return text;
}

}  // namespace

std::string render_state(const FlightAnswer& answer) {
  StatePicture picture;
  picture.title = answer.title;
  picture.classic = answer.classic ? &*answer.classic : nullptr;
  picture.velocity = &answer.part.boot->velocity;
  if (answer.comparison) picture.reference = answer.comparison->along;
  return state_svg(answer.series, picture);
}

std::optional<Format> format_of(const std::filesystem::path& path) {
  const auto ending = path.extension();
  if (ending == ".csv") return Format::csv;
  if (ending == ".json") return Format::json;
  if (ending == ".svg") return Format::svg;
  if (ending == ".html") return Format::html;
  if (ending == ".nc") return Format::netcdf;
  if (ending == ".bufr") return Format::bufr;
  if (ending == ".geojson") return Format::geojson;
  if (ending == ".kml") return Format::kml;
  if (ending == ".ascii2nc") return Format::met_point;
  if (ending == ".mcap") return Format::mcap;
  return std::nullopt;
}

ingest::Result<std::string> render_wind(const FlightAnswer& answer, Format format) {
  switch (format) {
    case Format::csv:
      return wind_csv(answer.series);
    case Format::json:
      return wind_json(answer.series, answer.source);
    case Format::svg:
      return series_of(answer);
    case Format::netcdf:
      return answer.product.layout == "uasdc" ? uasdc_of(answer) : wind_netcdf_of(answer);
    case Format::bufr:
    case Format::met_point:
      return ingest::fail(ingest::Kind::usage, "this format holds profiles, not the wind along a flight", {},
                          "use `quadsonde profile`, or another ending");
    case Format::geojson:
      return with_file(wind_geojson(answer.series, answer.source), answer);
    case Format::kml:
      return with_file(wind_kml(answer.series, answer.source, answer.title), answer);
    case Format::mcap:
      return wind_mcap(answer.series, answer.source);
    case Format::html:
      break;
  }
  return page_of(answer);
}

ingest::Result<std::string> render_profile(const FlightAnswer& answer, Format format) {
  switch (format) {
    case Format::csv:
      return profile_csv(*answer.profile);
    case Format::json:
      return profile_json(*answer.profile, answer.source);
    case Format::svg:
      return picture_of(answer);
    case Format::netcdf:
      return answer.product.layout == "uasdc" ? uasdc_of(answer) : profile_netcdf_of(answer);
    case Format::bufr:
      return bufr_of(answer);
    case Format::met_point:
      return met_point_of(answer);
    case Format::geojson:
      return with_file(profile_geojson(*answer.profile, answer.series, answer.source), answer);
    case Format::kml:
      return with_file(profile_kml(*answer.profile, answer.series, answer.source, answer.title), answer);
    case Format::mcap:
      return profile_mcap(*answer.profile, answer.source);
    case Format::html:
      break;
  }
  return page_of(answer);
}

bool holds_sections(Format format) {
  return format == Format::csv || format == Format::json || format == Format::netcdf || format == Format::svg ||
         format == Format::html;
}

ingest::Result<std::string> render_section(const FlightAnswer& answer, Format format) {
  switch (format) {
    case Format::csv:
      return section_csv(*answer.section);
    case Format::json:
      return section_json(*answer.section, answer.source);
    case Format::svg:
      return section_svg(*answer.section, {answer.title, "section"});
    case Format::netcdf:
      return section_netcdf_of(answer);
    case Format::html:
      if (answer.profile) return page_of(answer);
      return ingest::fail(ingest::Kind::usage, "these flights have no profile together, so there is no page of them",
                          {}, "leave --leg out, or write the section as .svg");
    default:
      return ingest::fail(ingest::Kind::usage, "this format holds no section", {},
                          "write it as .csv, .json, .nc, .svg or .html");
  }
}

}  // namespace quadsonde::product
