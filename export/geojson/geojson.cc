#include "export/geojson/geojson.h"

#include <algorithm>
#include <cmath>

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/geoid/geoid.h"

namespace quadsonde::product {
namespace {

constexpr double track_step_s = 1;  // between the points of the line

bool is_place(const std::optional<ingest::GeoPoint>& p) {
  return p && std::abs(p->lat_deg) <= 90 && std::abs(p->lon_deg) <= 360;
}

class Collection {
 public:
  Collection(const char* schema, const estimator::WindSeries& series, const ProductSource& source) {
    object_["type"] = "FeatureCollection";
    object_["quadsonde"] = json_head(schema, source);
    object_["features"] = Json::array();
    add_track(series);
  }

  void add_point(const std::optional<ingest::GeoPoint>& place, const std::optional<ingest::MslHeight>& height,
                 Json properties) {
    if (!is_place(place)) return;
    add({{"type", "Point"}, {"coordinates", position(*place, height)}}, std::move(properties));
  }

  ingest::Result<std::string> text() const {
    if (object_["features"].empty())
      return ingest::fail(ingest::Kind::missing, "no GeoJSON without a place: the flight has no latitude and longitude",
                          {}, "log the position of the GNSS receiver");
    return json_text(object_);
  }

 private:
  void add(Json geometry, Json properties) {
    object_["features"].push_back(
        {{"type", "Feature"}, {"geometry", std::move(geometry)}, {"properties", std::move(properties)}});
  }

  Json position(ingest::GeoPoint place, const std::optional<ingest::MslHeight>& height) const {
    Json at = {json_number(std::remainder(place.lon_deg, 360), digits::degrees),
               json_number(place.lat_deg, digits::degrees)};
    const auto undulation = height ? geoid_.undulation(place) : std::nullopt;
    if (undulation) at.push_back(json_number(height->m + *undulation, digits::metres));
    return at;
  }

  void add_track(const estimator::WindSeries& series) {
    std::vector<Json> lines(1, Json::array());
    std::optional<double> last_lon;
    std::optional<ingest::LogTime> last_time;
    for (const auto& p : series.points) {
      if (!is_place(p.place) || (last_time && ingest::to_seconds(p.time - *last_time) < track_step_s)) continue;
      const double lon = std::remainder(p.place->lon_deg, 360);
      if (last_lon && std::abs(lon - *last_lon) > 180) lines.push_back(Json::array());
      lines.back().push_back(position(*p.place, p.height_msl));
      last_lon = lon, last_time = p.time;
    }
    // A line has two points at least.
    std::erase_if(lines, [](const Json& line) { return line.size() < 2; });
    if (lines.empty()) return;
    const auto first = series.points.front().utc, last = series.points.back().utc;
    const auto time = [](std::optional<ingest::UtcTime> t) { return t ? Json(utc_text(t)) : Json(); };
    Json properties = {{"name", "flight track"}, {"utc_from", time(first)}, {"utc_to", time(last)}};
    if (lines.size() == 1)
      add({{"type", "LineString"}, {"coordinates", lines.front()}}, std::move(properties));
    else
      add({{"type", "MultiLineString"}, {"coordinates", lines}}, std::move(properties));
  }

  const Geoid geoid_ = Geoid::open();
  Json object_ = Json::object();
};

}  // namespace

ingest::Result<std::string> wind_geojson(const estimator::WindSeries& series, const ProductSource& source) {
  Collection collection("quadsonde.wind/1", series, source);
  for (const auto& p : series.points) collection.add_point(p.place, p.height_msl, json_row(p, series.mode));
  return collection.text();
}

ingest::Result<std::string> profile_geojson(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                            const ProductSource& source) {
  Collection collection("quadsonde.profile/1", series, source);
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins) collection.add_point(bin.place, bin.height_msl, json_row(bin, leg.name));
  return collection.text();
}

}  // namespace quadsonde::product
