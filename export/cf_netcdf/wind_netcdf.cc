#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "export/cf_netcdf/cf_netcdf.h"
#include "export/cf_netcdf/global_attributes.h"
#include "export/cf_netcdf/wind_variables.h"
#include "export/geoid/geoid.h"

namespace quadsonde::product {
namespace {

using estimator::WindPoint;
using Type = NcFile::Type;

constexpr std::size_t chunk = 4096;
constexpr const char* coordinates = "time lat lon altitude trajectory_id";

/// CF-1.8 section 9.6: coordinates may be missing only where nothing is stored at all. So what has no time, no place
/// or no height cannot stand here.
bool can_stand(const WindPoint& p) {
  return p.utc && p.place && p.height_msl && std::isfinite(p.place->lat_deg) && std::isfinite(p.place->lon_deg) &&
         std::isfinite(p.height_msl->m);
}

ingest::Result<std::vector<const WindPoint*>> points_of(const estimator::WindSeries& series) {
  std::vector<const WindPoint*> points;
  const auto any = [&](auto has) { return std::any_of(series.points.begin(), series.points.end(), has); };
  for (const auto& p : series.points)
    if (can_stand(p)) points.push_back(&p);
  if (!points.empty()) return points;
  using ingest::fail;
  using ingest::Kind;
  if (series.points.empty())
    return fail(Kind::no_answer, "the flight has no step to write", {}, "see `quadsonde info` for what the log lacks");
  if (!any([](const WindPoint& p) { return p.utc.has_value(); }))
    return fail(Kind::missing, "no netCDF without UTC: the log's clock never saw it", {}, "give --start-utc T");
  if (!any([](const WindPoint& p) { return p.place.has_value(); }))
    return fail(Kind::missing, "no netCDF without a place: the flight has no latitude and longitude", {},
                "log the position of the GNSS receiver");
  return fail(Kind::missing, "no netCDF without heights above the sea: that of the take-off point is not known", {},
              "give --takeoff-msl M");
}

/// A coordinate or another number of every step, beside the wind.
struct StepVariable {
  const char *name, *standard_name, *long_name, *units, *axis, *positive;
  double (*value)(const WindPoint&);
};
constexpr StepVariable step_variables[] = {
    {"time", "time", "time of the sample", "seconds since 1970-01-01T00:00:00Z", "T", "",
     [](const WindPoint& p) { return static_cast<double>(p.utc->ns) * 1e-9; }},
    {"lat", "latitude", "latitude of the vehicle", "degrees_north", "Y", "",
     [](const WindPoint& p) { return p.place->lat_deg; }},
    {"lon", "longitude", "longitude of the vehicle", "degrees_east", "X", "",
     [](const WindPoint& p) { return p.place->lon_deg; }},
    {"altitude", "altitude", "altitude of the vehicle above the geoid", "m", "Z", "up",
     [](const WindPoint& p) { return p.height_msl->m; }},
};

class WindFile {
 public:
  WindFile(const std::vector<const WindPoint*>& points, const estimator::WindSeries& series,
           const ProductSource& source, const NetcdfMetadata& metadata)
      : points_(points), series_(series), source_(source), metadata_(metadata) {}

  ingest::Result<std::string> bytes() {
    const auto id = flight_id(metadata_, source_);
    const auto length = std::max<std::size_t>(32, id.size());
    const auto obs = file_.unlimited("obs"), letters = file_.dimension("id_strlen", length);
    layout_ = {{obs}, {std::min(chunk, points_.size())}, coordinates, "time: point", false, ""};
    const auto trajectory = file_.variable("trajectory_id", Type::character, {letters});
    file_.attribute(trajectory, "cf_role", "trajectory_id");
    file_.attribute(trajectory, "long_name", "flight identifier");
    define_steps();
    define_crs(file_);
    WindVariables wind(file_, layout_);
    write_global_attributes(file_, text(), source_, metadata_);
    file_.attribute(NcFile::global, "quadsonde_mode", estimator::name(series_.mode));
    file_.end_definitions();
    file_.put(trajectory, {length}, padded(id, length));
    put_steps(wind);
    return file_.finish();
  }

 private:
  void define_steps() {
    for (const auto& v : step_variables) {
      steps_.push_back(file_.variable(v.name, Type::float64, layout_.dimensions, layout_.chunks));
      const std::pair<const char*, const char*> texts[] = {{"standard_name", v.standard_name},
                                                           {"long_name", v.long_name},
                                                           {"units", v.units},
                                                           {"axis", v.axis},
                                                           {"positive", v.positive},
                                                           {"coverage_content_type", "coordinate"}};
      for (const auto& [name, value] : texts) file_.attribute(steps_.back(), name, std::string_view(value));
    }
    file_.attribute(steps_.front(), "calendar", "standard");
    height_ = define(file_, layout_, Type::float64,
                     {"height", "height", "height of the vehicle above ground at the take-off point", "m", "", "",
                      "auxiliaryInformation"});
    log_time_ = define(file_, layout_, Type::float64,
                       {"log_time", "", "clock of the source at the same instant, to find it again in the log", "s", "",
                        "", "auxiliaryInformation"});
    undulation_ =
        define(file_, layout_, Type::float32,
               {"geoid_height", "geoid_height_above_reference_ellipsoid",
                "height of the geoid above the ellipsoid: altitude plus this is the height above the ellipsoid", "m",
                "", "", "auxiliaryInformation"});
    file_.attribute(undulation_, "comment", geoid_.provenance());
  }

  ProductText text() const {
    ProductText t;
    t.feature_type = "trajectory", t.cdm_data_type = "Trajectory";
    t.title = "Wind along a multirotor flight";
    t.summary =
        "Horizontal wind estimated from the attitude and the motion of a multirotor, one value per filter step.";
    t.processing_level = "wind per filter step";
    t.comment = fmt::format("{}; {} of {} filter steps are left out because they have no time, place or height",
                            heights_text(source_, geoid_.provenance()), series_.points.size() - points_.size(),
                            series_.points.size());
    t.from = t.to = *points_.front()->utc;
    for (const auto* p : points_) {
      t.lat.add(p->place->lat_deg), t.lon.add(p->place->lon_deg), t.altitude.add(p->height_msl->m);
      t.from = std::min(t.from, *p->utc), t.to = std::max(t.to, *p->utc);
    }
    if (points_.size() > 1) t.time_step_s = median_step();
    t.vertical_resolution = "point";
    return t;
  }

  double median_step() const {
    std::vector<double> steps;
    for (std::size_t i = 1; i < points_.size(); ++i)
      steps.push_back(ingest::to_seconds(*points_[i]->utc - *points_[i - 1]->utc));
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    return steps[steps.size() / 2];
  }

  void put_steps(WindVariables& wind) {
    const std::vector<std::size_t> shape{points_.size()};
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      std::vector<double> values;
      for (const auto* p : points_) values.push_back(step_variables[i].value(*p));
      file_.put(steps_[i], shape, values);
    }
    WindNumbers numbers;
    std::vector<double> heights, times;
    std::vector<float> undulations;
    for (const auto* p : points_) {
      numbers.add(p->wind, p->quality, p->reasons);
      heights.push_back(or_nan_double(p->height_agl ? std::optional(p->height_agl->m) : std::nullopt));
      times.push_back(static_cast<double>(p->time.ns) * 1e-9);
      undulations.push_back(or_nan(geoid_.undulation(*p->place)));
    }
    wind.put(numbers, shape);
    file_.put(height_, shape, heights);
    file_.put(log_time_, shape, times);
    file_.put(undulation_, shape, std::span<const float>(undulations));
  }

  const std::vector<const WindPoint*>& points_;
  const estimator::WindSeries& series_;
  const ProductSource& source_;
  const NetcdfMetadata& metadata_;
  const Geoid geoid_ = Geoid::open();
  NcFile file_;
  VariableLayout layout_;
  std::vector<NcFile::Variable> steps_;
  NcFile::Variable height_ = -1, log_time_ = -1, undulation_ = -1;
};

}  // namespace

ingest::Result<std::string> wind_netcdf(const estimator::WindSeries& series, const ProductSource& source,
                                        const NetcdfMetadata& metadata) {
  const auto points = points_of(series);
  if (!points) return ingest::fail(points.error());
  return WindFile(*points, series, source, metadata).bytes();
}

}  // namespace quadsonde::product
