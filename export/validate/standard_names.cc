#include "export/validate/standard_names.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace quadsonde::product {
namespace {

constexpr std::string_view time_units = "seconds since 1970-01-01";

// Names and canonical units of the CF Standard Name Table, version 83: the part that files about air, platforms and
// places use.
constexpr StandardName names[] = {
    // where and when
    {"time", time_units},
    {"forecast_reference_time", time_units},
    {"forecast_period", "s"},
    {"latitude", "degree_north"},
    {"longitude", "degree_east"},
    {"grid_latitude", "degree"},
    {"grid_longitude", "degree"},
    {"projection_x_coordinate", "m"},
    {"projection_y_coordinate", "m"},
    {"altitude", "m"},
    {"height", "m"},
    {"depth", "m"},
    {"height_above_mean_sea_level", "m"},
    {"height_above_geopotential_datum", "m"},
    {"height_above_reference_ellipsoid", "m"},
    {"geoid_height_above_reference_ellipsoid", "m"},
    {"surface_altitude", "m"},
    {"ground_level_altitude", "m"},
    {"bedrock_altitude", "m"},
    {"geopotential", "m2 s-2"},
    {"geopotential_height", "m"},
    {"geopotential_height_anomaly", "m"},
    {"model_level_number", "1"},
    {"atmosphere_hybrid_sigma_pressure_coordinate", "1"},
    {"atmosphere_sigma_coordinate", "1"},
    {"atmosphere_hybrid_height_coordinate", "m"},
    {"atmosphere_ln_pressure_coordinate", "1"},
    {"realization", "1"},
    {"region", ""},
    {"area_type", ""},
    {"land_binary_mask", "1"},
    {"land_area_fraction", "1"},
    {"solar_zenith_angle", "degree"},
    {"solar_azimuth_angle", "degree"},
    {"sensor_zenith_angle", "degree"},
    {"sensor_azimuth_angle", "degree"},
    {"angle_of_rotation_from_east_to_x", "degree"},
    // wind
    {"eastward_wind", "m s-1"},
    {"northward_wind", "m s-1"},
    {"x_wind", "m s-1"},
    {"y_wind", "m s-1"},
    {"upward_air_velocity", "m s-1"},
    {"downward_air_velocity", "m s-1"},
    {"lagrangian_tendency_of_air_pressure", "Pa s-1"},
    {"wind_speed", "m s-1"},
    {"wind_from_direction", "degree"},
    {"wind_to_direction", "degree"},
    {"wind_speed_of_gust", "m s-1"},
    {"wind_gust_from_direction", "degree"},
    {"wind_speed_shear", "s-1"},
    {"radial_velocity_of_scatterers_away_from_instrument", "m s-1"},
    {"specific_turbulent_kinetic_energy_of_air", "m2 s-2"},
    {"specific_kinetic_energy_of_air", "m2 s-2"},
    {"atmosphere_boundary_layer_thickness", "m"},
    {"atmosphere_upward_relative_vorticity", "s-1"},
    {"atmosphere_upward_absolute_vorticity", "s-1"},
    {"divergence_of_wind", "s-1"},
    {"eastward_wind_shear", "s-1"},
    {"northward_wind_shear", "s-1"},
    {"surface_downward_eastward_stress", "Pa"},
    {"surface_downward_northward_stress", "Pa"},
    {"surface_roughness_length", "m"},
    {"square_of_eastward_wind", "m2 s-2"},
    {"square_of_northward_wind", "m2 s-2"},
    {"product_of_eastward_wind_and_northward_wind", "m2 s-2"},
    // the state of the air
    {"air_temperature", "K"},
    {"air_potential_temperature", "K"},
    {"equivalent_potential_temperature", "K"},
    {"pseudo_equivalent_potential_temperature", "K"},
    {"wet_bulb_temperature", "K"},
    {"wet_bulb_potential_temperature", "K"},
    {"virtual_temperature", "K"},
    {"dew_point_temperature", "K"},
    {"dew_point_depression", "K"},
    {"frost_point_temperature", "K"},
    {"surface_temperature", "K"},
    {"soil_temperature", "K"},
    {"sea_surface_temperature", "K"},
    {"air_temperature_lapse_rate", "K m-1"},
    {"air_pressure", "Pa"},
    {"air_pressure_at_mean_sea_level", "Pa"},
    {"air_pressure_at_sea_level", "Pa"},
    {"surface_air_pressure", "Pa"},
    {"barometric_altitude", "m"},
    {"tendency_of_air_pressure", "Pa s-1"},
    {"relative_humidity", "1"},
    {"specific_humidity", "1"},
    {"humidity_mixing_ratio", "1"},
    {"water_vapor_partial_pressure_in_air", "Pa"},
    {"water_vapor_saturation_deficit_in_air", "Pa"},
    {"mass_concentration_of_water_vapor_in_air", "kg m-3"},
    {"atmosphere_mass_content_of_water_vapor", "kg m-2"},
    {"air_density", "kg m-3"},
    {"speed_of_sound_in_air", "m s-1"},
    {"richardson_number_in_atmosphere", "1"},
    {"visibility_in_air", "m"},
    {"cloud_area_fraction", "1"},
    {"cloud_base_altitude", "m"},
    {"rainfall_rate", "m s-1"},
    {"rainfall_amount", "kg m-2"},
    {"precipitation_amount", "kg m-2"},
    {"precipitation_flux", "kg m-2 s-1"},
    {"lwe_precipitation_rate", "m s-1"},
    {"thickness_of_rainfall_amount", "m"},
    {"lwe_thickness_of_precipitation_amount", "m"},
    {"mole_fraction_of_ozone_in_air", "1"},
    {"mole_fraction_of_carbon_dioxide_in_air", "1"},
    {"mole_fraction_of_methane_in_air", "1"},
    {"mass_concentration_of_pm2p5_ambient_aerosol_particles_in_air", "kg m-3"},
    {"mass_concentration_of_pm10_ambient_aerosol_particles_in_air", "kg m-3"},
    {"atmosphere_convective_available_potential_energy", "J kg-1"},
    {"atmosphere_convective_inhibition", "J kg-1"},
    {"surface_upward_sensible_heat_flux", "W m-2"},
    {"surface_upward_latent_heat_flux", "W m-2"},
    {"surface_downwelling_shortwave_flux_in_air", "W m-2"},
    {"surface_downwelling_longwave_flux_in_air", "W m-2"},
    {"surface_upwelling_shortwave_flux_in_air", "W m-2"},
    {"surface_upwelling_longwave_flux_in_air", "W m-2"},
    // platforms
    {"platform_id", ""},
    {"platform_name", ""},
    {"station_wmo_id", ""},
    {"platform_course", "degree"},
    {"platform_orientation", "degree"},
    {"platform_azimuth_angle", "degree"},
    {"platform_zenith_angle", "degree"},
    {"platform_view_angle", "degree"},
    {"platform_pitch", "degree"},
    {"platform_pitch_fore_up", "degree"},
    {"platform_pitch_fore_down", "degree"},
    {"platform_roll", "degree"},
    {"platform_roll_starboard_down", "degree"},
    {"platform_roll_starboard_up", "degree"},
    {"platform_yaw", "degree"},
    {"platform_yaw_fore_starboard", "degree"},
    {"platform_yaw_fore_port", "degree"},
    {"platform_pitch_rate", "degree s-1"},
    {"platform_roll_rate", "degree s-1"},
    {"platform_yaw_rate", "degree s-1"},
    {"platform_heave", "m"},
    {"platform_surge", "m"},
    {"platform_sway", "m"},
    {"platform_speed_wrt_ground", "m s-1"},
    {"platform_speed_wrt_air", "m s-1"},
    {"battery_voltage", "V"},
    // quality
    {"quality_flag", ""},
    {"status_flag", ""},
    {"aggregate_quality_flag", ""},
    {"spike_test_quality_flag", ""},
    {"gap_test_quality_flag", ""},
    {"gross_range_test_quality_flag", ""},
    {"climatology_test_quality_flag", ""},
    {"flat_line_test_quality_flag", ""},
    {"location_test_quality_flag", ""},
    {"rate_of_change_test_quality_flag", ""},
    {"neighbor_test_quality_flag", ""},
    {"attenuated_signal_test_quality_flag", ""},
    {"multi_variate_test_quality_flag", ""},
    {"number_of_observations", "1"},
};

/// Letters to change, add or take away; more than two are not counted.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const auto changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, changed}));
    }
  }
  return row.back();
}

}  // namespace

const StandardName* standard_name(std::string_view name) {
  for (const auto& known : names)
    if (known.name == name) return &known;
  return nullptr;
}

const StandardName* almost_standard_name(std::string_view name) {
  if (name.size() < 4 || name.size() > 128) return nullptr;
  for (const auto& known : names)
    if (distance(name, known.name) <= 2) return &known;
  return nullptr;
}

}  // namespace quadsonde::product
