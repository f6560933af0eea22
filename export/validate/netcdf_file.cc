#include "export/validate/netcdf_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

namespace quadsonde::product {

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> all;
  while (true) {
    const auto begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return all;
    const auto end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
    all.emplace_back(text.substr(begin, end - begin));
    text.remove_prefix(end);
  }
}

std::string lower_case(std::string text) {
  for (auto& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

NetcdfFile::NetcdfFile(NcDescription description, std::string file_name)
    : d_(std::move(description)), file_name_(std::move(file_name)) {}

const NcVariable* NetcdfFile::find(std::string_view name) const {
  const auto at = std::find_if(d_.variables.begin(), d_.variables.end(), [&](const auto& v) { return v.name == name; });
  return at == d_.variables.end() ? nullptr : &*at;
}

bool NetcdfFile::has_dimension(std::string_view name) const {
  return std::any_of(d_.dimensions.begin(), d_.dimensions.end(), [&](const auto& d) { return d.name == name; });
}

const NcAttribute* NetcdfFile::attribute(const std::vector<NcAttribute>& of, std::string_view name) {
  const auto at = std::find_if(of.begin(), of.end(), [&](const auto& a) { return a.name == name; });
  return at == of.end() ? nullptr : &*at;
}

namespace {
std::string text_of(const NcAttribute* a) { return a && !a->texts.empty() ? a->texts.front() : ""; }
}  // namespace

std::string NetcdfFile::text(const NcVariable& v, std::string_view name) { return text_of(attribute(v, name)); }
std::string NetcdfFile::global_text(std::string_view name) const { return text_of(global(name)); }

bool NetcdfFile::claims_cf() const { return global_text("Conventions").find("CF-1.") != std::string::npos; }
bool NetcdfFile::claims_acdd() const { return global_text("Conventions").find("ACDD") != std::string::npos; }
bool NetcdfFile::is_uasdc() const {
  return global("wmo__cf_profile") || global_text("Conventions").find("WMO-CF") != std::string::npos ||
         file_name_.starts_with("UASDC_");
}

std::string NetcdfFile::feature_type() const {
  const auto said = global_text("featureType");
  constexpr std::array<std::string_view, 6> types{"point",   "timeSeries",        "trajectory",
                                                  "profile", "timeSeriesProfile", "trajectoryProfile"};
  for (const auto type : types)
    if (lower_case(said) == lower_case(std::string(type))) return std::string(type);
  return said;
}

bool NetcdfFile::is_coordinate_variable(const NcVariable& v) const {
  return v.dimensions.size() == 1 && dimension(v, 0).name == v.name;
}

bool NetcdfFile::is_auxiliary_coordinate(const NcVariable& v) const {
  if (is_coordinate_variable(v) || is_grid_mapping(v)) return false;
  return named_in("coordinates", v.name) || attribute(v, "axis");
}

bool NetcdfFile::named_in(std::string_view name, const std::string& variable) const {
  return std::any_of(d_.variables.begin(), d_.variables.end(), [&](const auto& v) {
    const auto list = words(text(v, name));
    return std::find(list.begin(), list.end(), variable) != list.end();
  });
}

bool NetcdfFile::is_grid_mapping(const NcVariable& v) const {
  return attribute(v, "grid_mapping_name") || named_in("grid_mapping", v.name) ||
         named_in("grid_mapping", v.name + ":");
}

bool NetcdfFile::is_flags(const NcVariable& v) {
  return attribute(v, "flag_values") || attribute(v, "flag_masks") || attribute(v, "flag_meanings");
}

bool NetcdfFile::is_data(const NcVariable& v) const {
  return !is_text(v.type) && v.type != NcType::other && !is_coordinate(v) && !is_bounds(v) && !is_grid_mapping(v);
}

std::string NetcdfFile::standard_name_of(const NcVariable& v, std::string* modifier) {
  const auto parts = words(text(v, "standard_name"));
  if (modifier) *modifier = parts.size() > 1 ? parts[1] : "";
  return parts.empty() ? "" : parts[0];
}

bool NetcdfFile::is_vertical(const NcVariable& v) const {
  const auto name = standard_name_of(v);
  constexpr std::array<std::string_view, 9> heights{"altitude",
                                                    "height",
                                                    "depth",
                                                    "height_above_mean_sea_level",
                                                    "height_above_geopotential_datum",
                                                    "height_above_reference_ellipsoid",
                                                    "geopotential_height",
                                                    "barometric_altitude",
                                                    "air_pressure"};
  return text(v, "axis") == "Z" || std::find(heights.begin(), heights.end(), name) != heights.end();
}

const NcVariable* NetcdfFile::with_standard_name(std::string_view standard_name) const {
  for (const auto& v : d_.variables)
    if (is_coordinate(v) && text(v, "standard_name") == standard_name) return &v;
  for (const auto& v : d_.variables)
    if (text(v, "standard_name") == standard_name) return &v;
  return nullptr;
}

std::vector<double> NetcdfFile::data(const NcVariable& v) {
  auto values = v.values;
  // What the library fills unwritten floating-point data with. Source: NUG, appendix "Fill Values" (netcdf.h).
  constexpr double unwritten = 9.9692099683868690e+36;
  const auto number = [&](const char* name) {
    const auto* a = attribute(v, name);
    return a && !a->numbers.empty() ? std::optional(a->numbers.front()) : std::nullopt;
  };
  std::vector<double> missing;
  for (const auto* name : {"_FillValue", "missing_value"})
    if (const auto* a = attribute(v, name)) missing.insert(missing.end(), a->numbers.begin(), a->numbers.end());
  if (is_float(v.type) && !attribute(v, "_FillValue")) missing.push_back(unwritten);
  const double scale = number("scale_factor").value_or(1), offset = number("add_offset").value_or(0);
  for (auto& value : values) {
    const bool none = std::find(missing.begin(), missing.end(), value) != missing.end();
    value = none ? std::numeric_limits<double>::quiet_NaN() : value * scale + offset;
  }
  return values;
}

std::string NetcdfFile::shape_text(const NcVariable& v) const {
  std::string all;
  for (std::size_t i = 0; i < v.dimensions.size(); ++i) all += (i ? ", " : "") + dimension(v, i).name;
  return all.empty() ? "no dimension" : all;
}

}  // namespace quadsonde::product
