#pragma once
// A netCDF file as the rules see it: its description, and what the conventions call the parts of it.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "export/cf_netcdf/describe.h"
#include "export/validate/findings.h"
#include "export/validate/units.h"

namespace quadsonde::product {

/// Blank-separated words.
std::vector<std::string> words(std::string_view text);
std::string lower_case(std::string text);

class NetcdfFile {
 public:
  NetcdfFile(NcDescription description, std::string file_name);

  const std::vector<NcVariable>& variables() const { return d_.variables; }
  const NcDescription& description() const { return d_; }
  /// Without folders.
  const std::string& file_name() const { return file_name_; }
  const NcVariable* find(std::string_view name) const;
  const NcDimension& dimension(const NcVariable& v, std::size_t i) const { return d_.dimensions[v.dimensions[i]]; }
  bool has_dimension(std::string_view name) const;

  static const NcAttribute* attribute(const std::vector<NcAttribute>& of, std::string_view name);
  static const NcAttribute* attribute(const NcVariable& v, std::string_view name) {
    return attribute(v.attributes, name);
  }
  const NcAttribute* global(std::string_view name) const { return attribute(d_.attributes, name); }
  /// Empty where it is not there or no text.
  static std::string text(const NcVariable& v, std::string_view name);
  std::string global_text(std::string_view name) const;

  bool claims_cf() const;
  bool claims_acdd() const;
  bool is_uasdc() const;
  bool is_ours() const { return global("quadsonde_version") && !is_uasdc(); }
  /// "timeSeriesProfile", whatever its case; as it stands where it is none; empty without one.
  std::string feature_type() const;

  /// Of one dimension, by the name of it.
  bool is_coordinate_variable(const NcVariable& v) const;
  /// Named in a `coordinates` attribute, or a scalar that tells an axis.
  bool is_auxiliary_coordinate(const NcVariable& v) const;
  bool is_coordinate(const NcVariable& v) const { return is_coordinate_variable(v) || is_auxiliary_coordinate(v); }
  bool is_bounds(const NcVariable& v) const { return named_in("bounds", v.name); }
  bool is_grid_mapping(const NcVariable& v) const;
  /// Has flag_values, flag_masks or flag_meanings.
  static bool is_flags(const NcVariable& v);
  /// Numbers that are neither coordinate nor bounds nor grid mapping.
  bool is_data(const NcVariable& v) const;
  bool is_vertical(const NcVariable& v) const;
  /// The first word of standard_name; the second in `modifier`.
  static std::string standard_name_of(const NcVariable& v, std::string* modifier = nullptr);
  /// The coordinates with that standard name or axis, else the variable of that name.
  const NcVariable* with_standard_name(std::string_view standard_name) const;

  /// Values unpacked, NaN where they are missing.
  static std::vector<double> data(const NcVariable& v);
  /// "time, altitude"
  std::string shape_text(const NcVariable& v) const;

  Units units;

 private:
  bool named_in(std::string_view attribute, const std::string& variable) const;
  NcDescription d_;
  std::string file_name_;
};

// Each looks at the whole file. Units are asked for first (ask_...), then answered, then the rules are run.
void ask_cf_units(NetcdfFile& f);
void ask_uasdc_units(NetcdfFile& f);

void check_cf_texts(const NetcdfFile& f, Findings& found);        ///< sections 2 and 3.2 to 3.5
void check_cf_units(const NetcdfFile& f, Findings& found);        ///< sections 3.1, 3.3, 4.1, 4.2, 4.4
void check_cf_coordinates(const NetcdfFile& f, Findings& found);  ///< sections 1.2, 2.5, 4, 5
void check_cf_cells(const NetcdfFile& f, Findings& found);        ///< sections 7 and 8
void check_cf_features(const NetcdfFile& f, Findings& found);     ///< section 9
void check_acdd(const NetcdfFile& f, Findings& found);
void check_uasdc(const NetcdfFile& f, Findings& found);
void check_wind(const NetcdfFile& f, Findings& found);

}  // namespace quadsonde::product
