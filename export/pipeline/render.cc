#include "export/pipeline/render.h"

#include "export/csv/tables.h"
#include "export/pipeline/netcdf.h"
#include "export/report/report.h"

namespace quadsonde::product {
namespace {

std::string drag_line(const ingest::Vehicle& vehicle) {
  if (vehicle.is_prior()) return "drag: class prior, so speeds are uncertain by about 35 %";
  return "drag: " + (vehicle.name.empty() ? vehicle.id : vehicle.name) + " (" + vehicle.method + ")";
}

std::string picture_of(const FlightAnswer& answer) {
  ProfilePicture picture{answer.title, drag_line(answer.source.vehicle), {}, "true wind", "profile"};
  if (answer.comparison) picture.reference = answer.comparison->levels;
  return profile_svg(*answer.profile, picture);
}

std::string page_of(const FlightAnswer& answer) {
  Report report;
  report.title = answer.title;
  report.series = &answer.series;
  report.classic = answer.classic ? &*answer.classic : nullptr;
  report.profile = answer.profile ? &*answer.profile : nullptr;
  report.source = answer.source;
  if (answer.comparison) {
    report.reference = answer.comparison->levels;
    report.comparison = comparison_sentences(*answer.comparison);
  }
  return report_html(report);
}

}  // namespace

std::optional<Format> format_of(const std::filesystem::path& path) {
  const auto ending = path.extension();
  if (ending == ".csv") return Format::csv;
  if (ending == ".json") return Format::json;
  if (ending == ".svg") return Format::svg;
  if (ending == ".html") return Format::html;
  if (ending == ".nc") return Format::netcdf;
  return std::nullopt;
}

ingest::Result<std::string> render_wind(const FlightAnswer& answer, Format format) {
  switch (format) {
    case Format::csv:
      return wind_csv(answer.series);
    case Format::json:
      return wind_json(answer.series, answer.source);
    case Format::svg:
      return series_svg(answer.series, {answer.title, answer.classic ? &*answer.classic : nullptr, "series"});
    case Format::netcdf:
      return wind_netcdf_of(answer);
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
      return profile_netcdf_of(answer);
    case Format::html:
      break;
  }
  return page_of(answer);
}

}  // namespace quadsonde::product
