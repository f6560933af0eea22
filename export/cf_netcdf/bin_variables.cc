#include "export/cf_netcdf/bin_variables.h"

#include "profiles/air_levels.h"

namespace quadsonde::product {
namespace {

using profiles::Bin;
using Type = NcFile::Type;

}  // namespace

const std::vector<BinVariable>& bin_variables() {
  const std::string mean = "altitude: time: mean", spread = "altitude: time: standard_deviation";
  const char *quality = "qualityInformation", *auxiliary = "auxiliaryInformation", *measured = "physicalMeasurement";
  static const std::vector<BinVariable> variables{
      {{"effective_n_obs", "", "number of independent samples that the bin is worth", "1", "", "", auxiliary},
       Type::float32,
       [](const Bin& b) { return b.effective_samples; }},
      {{"wind_sd_sampling", "",
        "what turbulence adds to the uncertainty (k=1, per component) where the bin stands for the mean state", "m s-1",
        "", "", quality},
       Type::float32,
       [](const Bin& b) { return b.sd_sampling; }},
      {{"wind_sd_calibration", "",
        "part of drag, latency, climb law and heading in the uncertainty (k=1, per component)", "m s-1", "", "",
        quality},
       Type::float32,
       [](const Bin& b) { return b.sd_calibration; }},
      {{"wind_sd_trim", "", "part of the tilt trim in the uncertainty (k=1, per component)", "m s-1", "", "", quality},
       Type::float32,
       [](const Bin& b) { return b.sd_trim; }},
      {{"wind_sd_noise", "", "part of sensors and gusts in the uncertainty (k=1, per component)", "m s-1", "", "",
        quality},
       Type::float32,
       [](const Bin& b) { return b.sd_noise; }},
      {{"wind_sd_climb_law", "", "part of the climb law in wind_sd_calibration (k=1, per component)", "m s-1", "", "",
        quality},
       Type::float32,
       [](const Bin& b) { return b.sd_climb_law; }},
      {{"eastward_wind_sigma", "eastward_wind", "turbulence of the eastward wind in the bin", "m s-1", spread, "",
        measured},
       Type::float32,
       [](const Bin& b) { return b.sigma ? std::optional(b.sigma->y()) : std::nullopt; }},
      {{"northward_wind_sigma", "northward_wind", "turbulence of the northward wind in the bin", "m s-1", spread, "",
        measured},
       Type::float32,
       [](const Bin& b) { return b.sigma ? std::optional(b.sigma->x()) : std::nullopt; }},
      {{"wind_from_direction_spread", "wind_from_direction", "spread of the direction of the samples", "degree",
        spread + " (Yamartino)", "", measured},
       Type::float32,
       [](const Bin& b) { return b.spread_from_deg; }},
      {{"sample_altitude", "", "mean altitude of the samples of the bin above the geoid", "m", mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.height_msl && b.samples ? std::optional(b.height_msl->m) : std::nullopt; }},
      {{"sample_lat", "", "mean latitude of the samples of the bin", "degrees_north", mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.place ? std::optional(b.place->lat_deg) : std::nullopt; }},
      {{"sample_lon", "", "mean longitude of the samples of the bin", "degrees_east", mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.place ? std::optional(b.place->lon_deg) : std::nullopt; }},
      {{"sample_time", "", "mean time of the samples of the bin", time_units, mean, "", auxiliary},
       Type::float64,
       [](const Bin& b) { return b.utc ? std::optional(static_cast<double>(b.utc->ns) * 1e-9) : std::nullopt; }},
      {{"vertical_resolution", "",
        "height over which the value is an average: (row sum)^2 / (row sum of squares) of the "
        "averaging kernel x spacing",
        "m", "", "", quality},
       Type::float32,
       [](const Bin& b) { return b.resolution_m; },
       false},
      {{"degrees_of_freedom", "", "diagonal of the averaging kernel: 1 is measured, 0 is prior", "1", "", "", quality},
       Type::float32,
       [](const Bin& b) { return b.freedom; },
       false},
      {{"air_pressure", "air_pressure", "static pressure in the heights of the bin, mean over all legs", "Pa", mean, "",
        measured},
       Type::float64,
       [](const Bin& b) { return b.pressure_pa; },
       false},
      {{"air_temperature", "air_temperature", "temperature in the heights of the bin, mean over all legs", "K", mean,
        "", measured},
       Type::float32,
       [](const Bin& b) { return b.temperature_k; },
       false},
      {{"relative_humidity", "relative_humidity", "relative humidity in the heights of the bin, mean over all legs",
        "percent", mean, "", measured},
       Type::float32,
       [](const Bin& b) { return b.relative_humidity_pct; },
       false},
      {{"barometric_altitude", "barometric_altitude",
        "pressure height: altitude of air_pressure in the standard atmosphere, above 1013.25 hPa", "m", mean, "",
        measured},
       Type::float64,
       [](const Bin& b) { return profiles::barometric_altitude(b); },
       false},
  };
  return variables;
}

}  // namespace quadsonde::product
