#include "export/magnetic/magnetic_north.h"

#include <fmt/format.h>

#include <GeographicLib/MagneticModel.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>

namespace quadsonde::product {
namespace {

constexpr double least_horizontal = 2000;    // [nT]: the "blackout zones" of the World Magnetic Model
constexpr double ageing_deg_per_year = 0.1;  // of the error beyond a set's five years; models differ by .1 to .2
constexpr int epochs[] = {2015, 2020, 2025};

/// 1970-01-01 is 1970.0; the day's share of the year is not needed better than to a day.
double year_of(ingest::UtcTime time) { return 1970 + static_cast<double>(time.ns) / 1e9 / (365.2425 * 86400); }

struct Field {
  double declination = 0, horizontal = 0;
};

}  // namespace

struct MagneticNorth::Model {
  Model(const std::string& name, const std::filesystem::path& folder) : field(name, folder.string()) {}
  GeographicLib::MagneticModel field;

  Field at(ingest::GeoPoint point, double height, double year) const {
    double east = 0, north = 0, up = 0, horizontal = 0, total = 0, declination = 0, inclination = 0;
    field(year, point.lat_deg, point.lon_deg, height, east, north, up);
    GeographicLib::MagneticModel::FieldComponents(east, north, up, horizontal, total, declination, inclination);
    return {declination, horizontal};
  }
};

MagneticNorth MagneticNorth::open(const std::filesystem::path& folder) {
  MagneticNorth north;
  for (const int epoch : epochs) {
    try {
      north.models_.push_back(std::make_shared<const Model>(fmt::format("wmm{}", epoch), folder));
    } catch (const std::exception&) {
      // GeographicLib throws for a set that is missing, cut or none of its own: the others may do.
    }
  }
  return north;
}

MagneticNorth MagneticNorth::open() {
  // A folder that is named is the only one that counts: so it can be told to have none.
  if (const char* named = std::getenv("QUADSONDE_MAGNETIC"); named && *named) return open(std::filesystem::path(named));
  const std::string by_tool = GeographicLib::MagneticModel::DefaultMagneticPath();
  for (const std::string& folder :
       {std::string(QUADSONDE_MAGNETIC_INSTALLED), std::string(QUADSONDE_MAGNETIC_BUILT), by_tool})
    if (auto north = open(std::filesystem::path(folder)); !north.empty()) return north;
  return {};
}

std::optional<Declination> MagneticNorth::declination(ingest::GeoPoint point, double height,
                                                      std::optional<ingest::UtcTime> time) const {
  if (models_.empty() || !std::isfinite(point.lon_deg) || !(std::abs(point.lat_deg) <= 90) ||
      std::abs(point.lon_deg) > 1e6 || !std::isfinite(height))
    return std::nullopt;
  const double year = time ? year_of(*time) : models_.back()->field.MinTime();
  auto best = models_.front();
  for (const auto& model : models_)
    if (year >= model->field.MinTime()) best = model;
  try {
    const auto& set = best->field;
    const auto field = best->at(point, height, year);
    if (field.horizontal < least_horizontal) return std::nullopt;
    Declination d;
    d.deg = field.declination;
    d.model =
        fmt::format("World Magnetic Model {:.0f}, valid {:.0f} to {:.0f}", set.MinTime(), set.MinTime(), set.MaxTime());
    d.sd_deg = std::hypot(0.26, 5625 / field.horizontal);
    const double years_off = std::max({0.0, set.MinTime() - year, year - set.MaxTime()});
    d.outside_validity = years_off > 0;
    d.sd_deg = std::hypot(d.sd_deg, ageing_deg_per_year * years_off);
    d.date_known = time.has_value();
    if (!time) {
      const auto& first = models_.front();
      const double then = first->at(point, height, first->field.MinTime()).declination;
      d.sd_deg = std::hypot(d.sd_deg, std::remainder(field.declination - then, 360));
    }
    return d;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace quadsonde::product
