#pragma once
// The variables that both netCDF products hold: the wind, its uncertainty, its quality.
#include <optional>
#include <string>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "export/cf_netcdf/nc_file.h"

namespace quadsonde::product {

/// A wind as numbers, NaN where there is none; kept until all are written.
struct WindNumbers {
  std::vector<float> east, north, speed, from, se_east, se_north, se_speed, se_from, covariance;
  std::vector<signed char> quality;
  std::vector<std::int32_t> reasons;
  void add(const estimator::MaybeWind& wind, estimator::Quality quality, estimator::Reasons reasons);
};

/// How the variables of one product lie in its file.
struct VariableLayout {
  std::vector<NcFile::Dimension> dimensions;
  std::vector<std::size_t> chunks;
  std::string coordinates;
  std::string cell_methods;    ///< without its parenthesis
  bool mean_of_bin = false;    ///< the parenthesis says how the mean was made
  std::string more_ancillary;  ///< other variables that tell about the wind
};

/// One variable as it is defined.
struct VariableText {
  std::string name, standard_name, long_name, units, cell_methods, ancillary_variables, content_type;
};

/// Defines a variable with what all of them have: coordinates, grid_mapping and, for floats, NaN for missing.
NcFile::Variable define(NcFile& file, const VariableLayout& layout, NcFile::Type type, const VariableText& text);

/// Wind, standard errors, covariance, wind_qc and wind_qc_reasons: defined first, put after end_definitions().
class WindVariables {
 public:
  WindVariables(NcFile& file, const VariableLayout& layout);
  void put(const WindNumbers& numbers, const std::vector<std::size_t>& shape);

 private:
  void define_flags(const VariableLayout& layout);
  NcFile& file_;
  std::vector<NcFile::Variable> floats_;
  NcFile::Variable quality_ = -1, reasons_ = -1;
};

/// The scalar crs: WGS84 and the geoid that heights above the sea refer to.
NcFile::Variable define_crs(NcFile& file);

float or_nan(const std::optional<double>& value);
double or_nan_double(const std::optional<double>& value);

}  // namespace quadsonde::product
