#include "export/kml/kml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "export/csv/numbers.h"
#include "export/csv/rows.h"
#include "export/report/barb.h"
#include "export/version.h"
#include "ingest/flight/local_frame.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;
using estimator::WindPoint;
using ingest::fail;
using ingest::GeoPoint;
using ingest::Kind;

constexpr std::size_t most_barbs = 60;
constexpr double track_step_s = 1;
constexpr double ring_radius = 4;  // of a calm, in the units of the barb's staff

/// A wind at a place, as it is drawn.
struct Mark {
  GeoPoint place;
  double height = 0;  ///< in the document's altitude mode [m]
  estimator::MaybeWind wind;
  estimator::Quality quality = estimator::Quality::none;
  estimator::Reasons reasons;
  std::string height_text;
  Row row;
};

struct Folder {
  std::string name;
  bool visible = true;
  std::vector<Mark> marks;
};

/// The heights that this document can use of something: above the sea, else above the ground.
class Heights {
 public:
  explicit Heights(const estimator::WindSeries& series) {
    for (const auto& p : series.points) {
      above_sea_ = above_sea_ || p.height_msl;
      any_ = any_ || p.height_msl || p.height_agl;
    }
  }
  bool any() const { return any_; }
  const char* mode() const { return above_sea_ ? "absolute" : "relativeToGround"; }
  template <class Placed>
  std::optional<double> of(const Placed& p) const {
    if (above_sea_) return p.height_msl ? std::optional(p.height_msl->m) : std::nullopt;
    return p.height_agl ? std::optional(p.height_agl->m) : std::nullopt;
  }

 private:
  bool above_sea_ = false, any_ = false;
};

bool is_place(const std::optional<GeoPoint>& p) {
  return p && std::abs(p->lat_deg) <= 90 && std::abs(p->lon_deg) <= 360;
}

std::string coordinates(GeoPoint p, double height) {
  return fmt::format("{},{},{}", fixed(std::remainder(p.lon_deg, 360), digits::degrees),
                     fixed(p.lat_deg, digits::degrees), fixed(height, digits::metres));
}

std::string heights_words(const std::optional<ingest::GroundHeight>& agl, const std::optional<ingest::MslHeight>& msl) {
  if (agl) return fmt::format("{:.0f} m", agl->m);
  return msl ? fmt::format("{:.0f} m above the sea", msl->m) : "";
}

class Document {
 public:
  Document(const estimator::WindSeries& series, const ProductSource& source, const FlightTitle& title,
           const Heights& heights)
      : series_(series), source_(source), title_(title), heights_(heights) {}

  std::string text(const std::vector<Folder>& folders) {
    xml_.trusted("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    {
      const auto kml = xml_.element("kml", {{"xmlns", "http://www.opengis.net/kml/2.2"}});
      const auto document = xml_.element("Document");
      xml_.leaf("name", "Wind of " + title_text(title_));
      xml_.leaf("description",
                fmt::format("{}. Barbs point to where the wind comes from: half feather 2.5 m/s, feather 5 m/s, "
                            "pennant 25 m/s, ring: calm. Blue: good, orange: doubtful, red: bad. Made by quadsonde {} "
                            "of {}, SHA-256 {}.",
                            when_and_where(title_), version(), source_.file, source_.sha256));
      xml_.leaf("open", "1");
      style("good", "ffb35a1f");
      style("doubtful", "ff0080ff");
      style("bad", "ff2020d0");
      style("none", "ff808080");
      track();
      for (const auto& folder : folders) write(folder);
    }
    return xml_.str();
  }

  /// Length of a barb's staff on the globe [m]: a quarter of what the flight spans in height.
  void scale_barbs(const std::vector<Folder>& folders) {
    double low = 0, high = 0;
    bool first = true;
    for (const auto& folder : folders)
      for (const auto& mark : folder.marks) {
        low = first ? mark.height : std::min(low, mark.height);
        high = first ? mark.height : std::max(high, mark.height);
        first = false;
      }
    staff_m_ = std::clamp((high - low) / 4, 20.0, 500.0);
  }

 private:
  /// @param colour  aabbggrr
  void style(const char* id, const char* colour) {
    const auto scope = xml_.element("Style", {{"id", id}});
    {
      const auto icon = xml_.element("IconStyle");
      xml_.leaf("scale", "0");
    }
    {
      const auto label = xml_.element("LabelStyle");
      xml_.leaf("color", colour);
      xml_.leaf("scale", "0.7");
    }
    {
      const auto line = xml_.element("LineStyle");
      xml_.leaf("color", colour);
      xml_.leaf("width", "2.5");
    }
    const auto area = xml_.element("PolyStyle");
    xml_.leaf("color", colour);
  }

  void track() {
    std::string points;
    std::size_t count = 0;
    std::optional<ingest::LogTime> last;
    for (const auto& p : series_.points) {
      const auto height = heights_.of(p);
      if (!is_place(p.place) || !height || (last && ingest::to_seconds(p.time - *last) < track_step_s)) continue;
      points += (count++ ? " " : "") + coordinates(*p.place, *height);
      last = p.time;
    }
    if (count < 2) return;
    const auto placemark = xml_.element("Placemark");
    xml_.leaf("name", "flight track");
    xml_.leaf("styleUrl", "#none");
    const auto line = xml_.element("LineString");
    xml_.leaf("altitudeMode", heights_.mode());
    xml_.leaf("coordinates", points);
  }

  void write(const Folder& folder) {
    const auto scope = xml_.element("Folder");
    xml_.leaf("name", folder.name);
    xml_.leaf("visibility", folder.visible ? "1" : "0");
    for (const auto& mark : folder.marks) write(mark, folder.visible);
  }

  void write(const Mark& mark, bool visible) {
    const auto* wind = std::get_if<WindEstimate>(&mark.wind);
    const auto placemark = xml_.element("Placemark");
    xml_.leaf("name", mark.height_text + ": " + (wind ? label(*wind) : "no wind"));
    xml_.leaf("visibility", visible ? "1" : "0");
    xml_.leaf("styleUrl", "#" + std::string(estimator::name(mark.quality)));
    data(mark);
    const auto geometry = xml_.element("MultiGeometry");
    {
      const auto point = xml_.element("Point");
      xml_.leaf("altitudeMode", heights_.mode());
      xml_.leaf("coordinates", coordinates(mark.place, mark.height));
    }
    if (wind) barb(mark, *wind);
  }

  static std::string label(const WindEstimate& wind) {
    const auto report = estimator::to_report(wind);
    if (!report.from_deg) return fmt::format("{:.1f} m/s, direction not determined", report.speed_m_s);
    const double rounded = std::round(*report.from_deg);
    return fmt::format("{:.1f} m/s from {:.0f}\xC2\xB0", report.speed_m_s, rounded == 0 ? 360 : rounded);
  }

  void data(const Mark& mark) {
    const auto scope = xml_.element("ExtendedData");
    const auto put = [&](std::string_view name, std::string_view value) {
      if (value.empty()) return;
      const auto field = xml_.element("Data", {{"name", name}});
      xml_.leaf("value", value);
    };
    for (const auto& field : mark.row) put(field.name, field.text);
    std::string reasons;
    for (const auto reason : mark.reasons.list())
      reasons += (reasons.empty() ? "" : "; ") + std::string(estimator::sentence(reason));
    put("reasons", reasons);
  }

  void barb(const Mark& mark, const WindEstimate& wind) {
    const auto report = estimator::to_report(wind);
    const auto strokes = barb_strokes(report.speed_m_s, mark.place.lat_deg < 0);
    if (strokes.empty()) return shape(mark, ring(), 0);
    if (!report.from_deg) return;
    for (const auto& stroke : strokes) shape(mark, stroke, *report.from_deg);
  }

  static BarbStroke ring() {
    BarbStroke stroke;
    constexpr int corners = 16;
    for (int i = 0; i <= corners; ++i) {
      const double a = 2 * std::numbers::pi * (i % corners) / corners;
      stroke.points.push_back({ring_radius * std::sin(a), -ring_radius * std::cos(a)});
    }
    return stroke;
  }

  void shape(const Mark& mark, const BarbStroke& stroke, double from_deg) {
    const ingest::LocalFrame frame(mark.place, 0);
    const double a = from_deg * std::numbers::pi / 180, metres = staff_m_ / barb_staff;
    std::string points;
    const auto append = [&](const BarbStroke::Point& p) {
      const double ahead = -p.y * metres, right = p.x * metres;
      const auto at =
          frame.from_ned({ahead * std::cos(a) - right * std::sin(a), ahead * std::sin(a) + right * std::cos(a), 0});
      points += (points.empty() ? "" : " ") + coordinates(at.first, mark.height);
    };
    for (const auto& p : stroke.points) append(p);
    if (!stroke.filled) {
      const auto line = xml_.element("LineString");
      xml_.leaf("altitudeMode", heights_.mode());
      xml_.leaf("coordinates", points);
      return;
    }
    append(stroke.points.front());  // a ring of KML closes itself
    const auto polygon = xml_.element("Polygon");
    xml_.leaf("altitudeMode", heights_.mode());
    const auto boundary = xml_.element("outerBoundaryIs");
    const auto ring = xml_.element("LinearRing");
    xml_.leaf("coordinates", points);
  }

  const estimator::WindSeries& series_;
  const ProductSource& source_;
  const FlightTitle& title_;
  const Heights& heights_;
  double staff_m_ = 50;
  Markup xml_;
};

ingest::Result<std::string> document(const estimator::WindSeries& series, const ProductSource& source,
                                     const FlightTitle& title, const Heights& heights,
                                     const std::vector<Folder>& folders) {
  if (std::all_of(folders.begin(), folders.end(), [](const Folder& f) { return f.marks.empty(); }))
    return fail(Kind::missing,
                heights.any() ? "no KML without a place: the flight has no latitude and longitude"
                              : "no KML without a height: the flight has none",
                {}, heights.any() ? "log the position of the GNSS receiver" : "log a barometer or GNSS height");
  Document made(series, source, title, heights);
  made.scale_barbs(folders);
  return made.text(folders);
}

const char* folder_name(profiles::LegName leg) {
  constexpr const char* names[] = {"ascent", "descent", "whole flight"};
  return names[static_cast<std::size_t>(leg)];
}

}  // namespace

ingest::Result<std::string> profile_kml(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                        const ProductSource& source, const FlightTitle& title) {
  const Heights heights(series);
  const auto* shown = main_leg(profile);
  std::vector<Folder> folders;
  for (const auto& leg : profile.legs) {
    Folder folder{folder_name(leg.name), &leg == shown, {}};
    for (const auto& bin : leg.bins) {
      const auto height = heights.of(bin);
      if (is_place(bin.place) && height)
        folder.marks.push_back({*bin.place, *height, bin.wind, bin.quality, bin.reasons,
                                heights_words(bin.height_agl, bin.height_msl), profile_row(bin, leg.name)});
    }
    folders.push_back(std::move(folder));
  }
  return document(series, source, title, heights, folders);
}

ingest::Result<std::string> wind_kml(const estimator::WindSeries& series, const ProductSource& source,
                                     const FlightTitle& title) {
  const Heights heights(series);
  std::vector<const WindPoint*> points;
  for (const auto& p : series.points)
    if (is_place(p.place) && heights.of(p) && std::holds_alternative<WindEstimate>(p.wind)) points.push_back(&p);
  Folder folder{"wind along the flight", true, {}};
  const std::size_t step = std::max<std::size_t>(1, (points.size() + most_barbs - 1) / most_barbs);
  for (std::size_t i = 0; i < points.size(); i += step) {
    const auto& p = *points[i];
    folder.marks.push_back({*p.place, *heights.of(p), p.wind, p.quality, p.reasons,
                            heights_words(p.height_agl, p.height_msl), wind_row(p, series.mode)});
  }
  return document(series, source, title, heights, {folder});
}

}  // namespace quadsonde::product
