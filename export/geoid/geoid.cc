#include "export/geoid/geoid.h"

#include <GeographicLib/Geoid.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>

namespace quadsonde::product {
namespace {

constexpr const char* fine_name = "egm96-15";
constexpr double offset = -108, scale = 0.003;

constexpr int coarse_rows = 181, coarse_columns = 360;
constexpr std::array<std::uint16_t, std::size_t{coarse_rows}* coarse_columns> coarse_pixels = {
#include "egm96_coarse.inc"
};

/// A node of the coarse grid, rows from the north pole; beyond a pole the grid goes on along the opposite meridian.
double coarse_node(int row, int column) {
  if (row < 0) row = -row, column += coarse_columns / 2;
  if (row >= coarse_rows) row = 2 * (coarse_rows - 1) - row, column += coarse_columns / 2;
  column = (column % coarse_columns + coarse_columns) % coarse_columns;
  return offset + scale * coarse_pixels[static_cast<std::size_t>(row * coarse_columns + column)];
}

/// Weights of the cubic convolution for the nodes -1, 0, 1, 2 at t in [0, 1].
/// Source: Keys (1981), "Cubic convolution interpolation", a = -1/2.
std::array<double, 4> cubic_weights(double t) {
  return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1, ((-1.5 * t + 2) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t};
}

double coarse_undulation(ingest::GeoPoint point) {
  const double y = 90 - point.lat_deg, x = point.lon_deg - 360 * std::floor(point.lon_deg / 360);
  const int row = std::min(static_cast<int>(y), coarse_rows - 2), column = static_cast<int>(x);
  const auto along = cubic_weights(y - row), across = cubic_weights(x - column);
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      sum += along[static_cast<std::size_t>(i)] * across[static_cast<std::size_t>(j)] *
             coarse_node(row + i - 1, column + j - 1);
  return sum;
}

}  // namespace

struct Geoid::Fine {
  explicit Fine(const std::filesystem::path& folder) : grid(fine_name, folder.string(), true, true) {}
  GeographicLib::Geoid grid;
};

Geoid Geoid::open(const std::filesystem::path& folder) {
  Geoid geoid;
  try {
    geoid.fine_ = std::make_shared<const Fine>(folder);
  } catch (const std::exception&) {
    // GeographicLib throws for a file that is missing, cut or none of its own: then the coarse grid serves.
  }
  return geoid;
}

Geoid Geoid::open() {
  const char* named = std::getenv("QUADSONDE_GEOIDS");
  for (const char* folder : {named, QUADSONDE_GEOIDS_INSTALLED, QUADSONDE_GEOIDS_BUILT}) {
    if (!folder || !*folder) continue;
    if (auto geoid = open(std::filesystem::path(folder)); geoid.is_fine()) return geoid;
  }
  return {};
}

std::optional<double> Geoid::undulation(ingest::GeoPoint point) const {
  // GeographicLib answers latitudes beyond a pole with a NaN, and longitudes of any size.
  if (!std::isfinite(point.lon_deg) || !(std::abs(point.lat_deg) <= 90) || std::abs(point.lon_deg) > 1e6)
    return std::nullopt;
  if (!fine_) return coarse_undulation(point);
  try {
    return fine_->grid(point.lat_deg, point.lon_deg);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::string Geoid::provenance() const {
  return is_fine() ? "EGM96, 0.25 degree grid (egm96_15.gtx of proj-data), cubic interpolation"
                   : "EGM96, 1 degree grid built in because the 0.25 degree grid was not found, cubic interpolation, "
                     "off by up to 1.8 m (99 %)";
}

bool add_msl_heights(ingest::Flight& flight, const Geoid& geoid) {
  const auto& heights = flight.height_ellipsoid;
  if (!flight.height_msl.empty() || heights.empty() || flight.position.empty()) return false;
  ingest::Stream<ingest::MslHeight> msl;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    // Within a flight the geoid is flat to centimetres: the last place will do, and the first before it is known.
    const auto at = std::max<std::ptrdiff_t>(0, ingest::last_at_or_before(flight.position, heights.time[i]));
    const auto undulation = geoid.undulation(flight.position.value[static_cast<std::size_t>(at)]);
    if (undulation) msl.push(heights.time[i], ingest::above_geoid(heights.value[i], *undulation));
  }
  if (msl.empty()) return false;
  msl.source = heights.source + " above the geoid " + Geoid::name();
  flight.height_msl = std::move(msl);
  return true;
}

}  // namespace quadsonde::product
