#include "export/cf_netcdf/wind_variables.h"

#include <array>
#include <cmath>
#include <limits>

#include "export/geoid/geoid.h"

namespace quadsonde::product {
namespace {

using estimator::Quality;
using estimator::Reason;
using estimator::WindEstimate;
using Type = NcFile::Type;

/// The words of MET.md 1.3 (section 1.3 of the formats notes): good 1, doubtful 3, bad 4, none 9; 2 is never written.
signed char quality_flag(Quality quality) {
  constexpr signed char flags[] = {1, 3, 4, 9};
  return flags[static_cast<int>(quality)];
}

struct FloatVariable {
  const char *name, *standard_name, *long_name, *units, *mean;  // mean: how a bin's value was made
  std::vector<float> WindNumbers::*values;
  bool physical;  // else it tells how good another one is
};
constexpr FloatVariable float_variables[] = {
    {"eastward_wind", "eastward_wind", "eastward component of the wind", "m s-1",
     "vector mean of all valid samples in the bin", &WindNumbers::east, true},
    {"northward_wind", "northward_wind", "northward component of the wind", "m s-1",
     "vector mean of all valid samples in the bin", &WindNumbers::north, true},
    {"wind_speed", "wind_speed", "speed of the horizontal wind", "m s-1", "modulus of the vector mean",
     &WindNumbers::speed, true},
    {"wind_from_direction", "wind_from_direction",
     "direction the wind comes from, clockwise from true north, north is 360; missing below twice the uncertainty of "
     "the speed",
     "degree", "direction of the vector mean", &WindNumbers::from, true},
    {"eastward_wind_se", "eastward_wind standard_error", "standard uncertainty (k=1) of eastward_wind", "m s-1", "",
     &WindNumbers::se_east, false},
    {"northward_wind_se", "northward_wind standard_error", "standard uncertainty (k=1) of northward_wind", "m s-1", "",
     &WindNumbers::se_north, false},
    {"wind_speed_se", "wind_speed standard_error", "standard uncertainty (k=1) of wind_speed", "m s-1", "",
     &WindNumbers::se_speed, false},
    {"wind_from_direction_se", "wind_from_direction standard_error",
     "standard uncertainty (k=1) of wind_from_direction", "degree", "", &WindNumbers::se_from, false},
    {"wind_error_covariance", "", "covariance of the errors of eastward_wind and northward_wind", "m2 s-2", "",
     &WindNumbers::covariance, false},
};

}  // namespace

float or_nan(const std::optional<double>& value) {
  return value ? static_cast<float>(*value) : std::numeric_limits<float>::quiet_NaN();
}
double or_nan_double(const std::optional<double>& value) {
  return value ? *value : std::numeric_limits<double>::quiet_NaN();
}

void WindNumbers::add(const estimator::MaybeWind& maybe, Quality q, estimator::Reasons why) {
  const auto* wind = std::get_if<WindEstimate>(&maybe);
  if (const auto* none = std::get_if<estimator::NoEstimate>(&maybe)) why.add(none->reason);
  std::optional<double> none;
  const bool has_sd = wind && wind->has_covariance;
  const auto report = wind ? estimator::to_report(*wind) : estimator::WindReport{};
  north.push_back(or_nan(wind ? wind->v_NA_N.x() : none));
  east.push_back(or_nan(wind ? wind->v_NA_N.y() : none));
  speed.push_back(or_nan(wind ? report.speed_m_s : none));
  from.push_back(or_nan(wind ? report.from_deg : none));
  se_north.push_back(or_nan(has_sd ? std::sqrt(wind->covariance(0, 0)) : none));
  se_east.push_back(or_nan(has_sd ? std::sqrt(wind->covariance(1, 1)) : none));
  se_speed.push_back(or_nan(has_sd ? estimator::speed_sd(*wind) : none));
  se_from.push_back(or_nan(has_sd ? estimator::direction_sd_deg(*wind) : none));
  covariance.push_back(or_nan(has_sd ? wind->covariance(0, 1) : none));
  // A value and its flag cannot contradict each other in the file, whatever came in.
  quality.push_back(quality_flag(wind ? q : Quality::none));
  std::int32_t bits = 0;
  for (const auto reason : why.list()) bits |= std::int32_t{1} << static_cast<int>(reason);
  reasons.push_back(bits);
}

NcFile::Variable define(NcFile& file, const VariableLayout& layout, Type type, const VariableText& text) {
  const auto variable = file.variable(text.name, type, layout.dimensions, layout.chunks);
  if (type == Type::float32 || type == Type::float64) file.nan_is_missing(variable, type);
  file.attribute(variable, "standard_name", text.standard_name);
  file.attribute(variable, "long_name", text.long_name);
  file.attribute(variable, "units", text.units);
  file.attribute(variable, "coordinates", layout.coordinates);
  file.attribute(variable, "grid_mapping", "crs");
  file.attribute(variable, "cell_methods", text.cell_methods);
  file.attribute(variable, "ancillary_variables", text.ancillary_variables);
  file.attribute(variable, "coverage_content_type", text.content_type);
  return variable;
}

WindVariables::WindVariables(NcFile& file, const VariableLayout& layout) : file_(file) {
  for (const auto& v : float_variables) {
    VariableText text{v.name, v.standard_name, v.long_name, v.units, {}, {}, "qualityInformation"};
    if (v.physical) {
      text.cell_methods = layout.cell_methods + (layout.mean_of_bin ? std::string(" (") + v.mean + ")" : "");
      text.ancillary_variables =
          std::string(v.name) + "_se wind_error_covariance wind_qc wind_qc_reasons" + layout.more_ancillary;
      text.content_type = "physicalMeasurement";
    }
    floats_.push_back(define(file, layout, Type::float32, text));
  }
  define_flags(layout);
}

void WindVariables::define_flags(const VariableLayout& layout) {
  quality_ = define(
      file_, layout, Type::byte,
      {"wind_qc", "aggregate_quality_flag", "quality of the wind", "", "", "wind_qc_reasons", "qualityInformation"});
  constexpr std::array<signed char, 5> flags{1, 2, 3, 4, 9};
  constexpr std::array<signed char, 2> range{1, 9};
  file_.attribute(quality_, "flag_values", flags);
  file_.attribute(quality_, "flag_meanings", "good not_evaluated suspect fail missing");
  file_.attribute(quality_, "valid_range", range);
  reasons_ = define(file_, layout, Type::int32,
                    {"wind_qc_reasons", "status_flag", "why the wind is not simply good, or is not there", "", "", "",
                     "qualityInformation"});
  std::vector<std::int32_t> masks;
  std::string meanings, sentences;
  for (int i = 0; i < static_cast<int>(Reason::count); ++i) {
    const auto reason = static_cast<Reason>(i);
    masks.push_back(std::int32_t{1} << i);
    meanings += (i ? " " : "") + std::string(estimator::name(reason));
    sentences +=
        (i ? "; " : "") + std::string(estimator::name(reason)) + ": " + std::string(estimator::sentence(reason));
  }
  file_.attribute(reasons_, "flag_masks", masks);
  file_.attribute(reasons_, "flag_meanings", meanings);
  file_.attribute(reasons_, "comment", sentences);
}

void WindVariables::put(const WindNumbers& numbers, const std::vector<std::size_t>& shape) {
  for (std::size_t i = 0; i < floats_.size(); ++i)
    file_.put(floats_[i], shape, std::span<const float>(numbers.*float_variables[i].values));
  file_.put(quality_, shape, std::span<const signed char>(numbers.quality));
  file_.put(reasons_, shape, std::span<const std::int32_t>(numbers.reasons));
}

NcFile::Variable define_crs(NcFile& file) {
  const auto crs = file.variable("crs", Type::int32, {});
  // CF-1.8 appendix F; the names go together.
  file.attribute(crs, "grid_mapping_name", "latitude_longitude");
  file.attribute(crs, "geographic_crs_name", "WGS 84");
  file.attribute(crs, "horizontal_datum_name", "WGS_1984");
  file.attribute(crs, "reference_ellipsoid_name", "WGS 84");
  file.attribute(crs, "prime_meridian_name", "Greenwich");
  file.attribute(crs, "longitude_of_prime_meridian", 0.0);
  file.attribute(crs, "semi_major_axis", 6378137.0);
  file.attribute(crs, "inverse_flattening", 298.257223563);
  file.attribute(crs, "geoid_name", Geoid::name());
  return crs;
}

}  // namespace quadsonde::product
