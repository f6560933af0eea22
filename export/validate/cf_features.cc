// CF-1.8 section 9: discrete sampling geometries.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "export/validate/netcdf_file.h"

namespace quadsonde::product {
namespace {

std::vector<std::string> roles_of(const std::string& feature) {
  if (feature == "timeSeries") return {"timeseries_id"};
  if (feature == "trajectory") return {"trajectory_id"};
  if (feature == "profile") return {"profile_id"};
  if (feature == "timeSeriesProfile") return {"timeseries_id", "profile_id"};
  if (feature == "trajectoryProfile") return {"trajectory_id", "profile_id"};
  return {};
}

void check_roles(const NetcdfFile& f, const std::string& feature, Findings& found) {
  std::map<std::string, int> seen;
  for (const auto& v : f.variables()) {
    if (!NetcdfFile::attribute(v, "cf_role")) continue;
    const auto role = NetcdfFile::text(v, "cf_role");
    constexpr std::array<std::string_view, 3> roles{"timeseries_id", "profile_id", "trajectory_id"};
    if (std::find(roles.begin(), roles.end(), role) == roles.end())
      found.add(rule("cf.cf-role"), v.name + ":cf_role", "it is \"" + role + "\"");
    else if (++seen[role] > 1)
      found.add(rule("cf.cf-role"), v.name + ":cf_role", role + " stands twice");
  }
  const auto wanted = roles_of(feature);
  for (const auto& [role, count] : seen)
    if (std::find(wanted.begin(), wanted.end(), role) == wanted.end() && role.ends_with("_id"))
      found.add(rule("cf.cf-role-feature"), "", fmt::format("a {} has no {}", feature, role));
  for (const auto& role : wanted)
    if (!seen.contains(role) && !f.is_uasdc())
      found.add(rule("cf.cf-role-missing"), "", fmt::format("a {} without {}", feature, role));
}

/// Whether a data variable can be placed by this coordinate: by its dimension, a scalar, or its own list.
bool places(const NetcdfFile& f, const NcVariable& v, std::string_view standard) {
  for (const auto& c : f.variables()) {
    if (NetcdfFile::standard_name_of(c) != standard && !(standard == "vertical" && f.is_vertical(c))) continue;
    if (&c == &v) return true;
    const auto named = words(NetcdfFile::text(v, "coordinates"));
    if (std::find(named.begin(), named.end(), c.name) != named.end()) return true;
    if (f.is_coordinate_variable(c) &&
        std::find(v.dimensions.begin(), v.dimensions.end(), c.dimensions[0]) != v.dimensions.end())
      return true;
  }
  return false;
}

void check_placed(const NetcdfFile& f, const std::string& feature, Findings& found) {
  const bool tall = feature == "profile" || feature.ends_with("Profile");
  for (const auto& v : f.variables()) {
    if (!f.is_data(v) || v.dimensions.empty() || NetcdfFile::text(v, "coverage_content_type") == "coordinate") continue;
    if (f.is_vertical(v) && !NetcdfFile::attribute(v, "coordinates")) continue;
    std::vector<std::string> absent;
    for (const auto* name : {"time", "latitude", "longitude"})
      if (!places(f, v, name)) absent.push_back(name);
    if (tall && v.dimensions.size() > 1 && !places(f, v, "vertical")) absent.push_back("height");
    std::string list;
    for (const auto& name : absent) list += (list.empty() ? "" : ", ") + name;
    if (!absent.empty()) found.add(rule("cf.feature-coordinates"), v.name + ":coordinates", "nothing gives it " + list);
  }
}

/// Data where a coordinate of the same shape is missing belong to no place or time.
void check_missing(const NetcdfFile& f, Findings& found) {
  for (const auto& v : f.variables()) {
    if (!f.is_data(v) || v.data != NcData::all) continue;
    for (const auto& name : words(NetcdfFile::text(v, "coordinates"))) {
      const auto* c = f.find(name);
      if (!c || c->dimensions != v.dimensions || c->data != NcData::all || is_text(c->type)) continue;
      const auto at = NetcdfFile::data(*c), values = NetcdfFile::data(v);
      for (std::size_t i = 0; i < values.size() && is_float(v.type); ++i)
        if (std::isnan(at[i]) && !std::isnan(values[i])) {
          found.add(rule("cf.feature-missing"), v.name, "it has a value where " + name + " is missing");
          break;
        }
    }
  }
}

}  // namespace

void check_cf_features(const NetcdfFile& f, Findings& found) {
  const auto feature = f.feature_type();
  if (!f.global("featureType")) return;
  constexpr std::array<std::string_view, 6> types{"point",   "timeSeries",        "trajectory",
                                                  "profile", "timeSeriesProfile", "trajectoryProfile"};
  if (std::find(types.begin(), types.end(), feature) == types.end()) {
    found.add(rule("cf.feature-type"), ":featureType", "it is \"" + feature + "\"");
    return;
  }
  check_roles(f, feature, found);
  if (!f.is_uasdc()) check_placed(f, feature, found);
  check_missing(f, found);
}

}  // namespace quadsonde::product
