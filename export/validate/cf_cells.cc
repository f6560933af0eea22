// CF-1.8 sections 7 and 8: bounds, cell methods, packing.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/validate/netcdf_file.h"
#include "export/validate/standard_names.h"

namespace quadsonde::product {
namespace {

void check_cells(const NcVariable& v, const NcVariable& bounds, Findings& found) {
  if (v.data != NcData::all || bounds.data != NcData::all) return;
  const auto &at = v.values, &edges = bounds.values;
  if (edges.size() != 2 * at.size()) return;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto [low, high] = std::minmax(edges[2 * i], edges[2 * i + 1]);
    if (at[i] >= low && at[i] <= high) continue;
    found.add(rule("cf.bounds-enclose"), bounds.name,
              fmt::format("the cell {} to {} does not hold {}", low, high, at[i]));
    return;
  }
  // Records of different legs may overlap or leave gaps in time; cells along a height may not.
  if (NetcdfFile::standard_name_of(v) == "time") return;
  for (std::size_t i = 1; i < at.size(); ++i)
    if (std::abs(edges[2 * i] - edges[2 * i - 1]) > 1e-6 * std::max(1.0, std::abs(edges[2 * i]))) {
      found.add(rule("cf.bounds-contiguous"), bounds.name,
                fmt::format("one cell ends at {}, the next begins at {}", edges[2 * i - 1], edges[2 * i]));
      return;
    }
}

void check_bounds(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  if (!NetcdfFile::attribute(v, "bounds")) return;
  const auto name = NetcdfFile::text(v, "bounds");
  const auto* bounds = f.find(name);
  if (!bounds) {
    found.add(rule("cf.bounds"), v.name + ":bounds", "there is no " + name);
    return;
  }
  const bool shaped = bounds->dimensions.size() == v.dimensions.size() + 1 &&
                      std::equal(v.dimensions.begin(), v.dimensions.end(), bounds->dimensions.begin()) &&
                      (v.dimensions.size() != 1 || f.dimension(*bounds, 1).length == 2);
  if (!shaped) {
    found.add(rule("cf.bounds-shape"), name,
              fmt::format("its dimensions are {}, those of {} {}", f.shape_text(*bounds), v.name, f.shape_text(v)));
    return;
  }
  for (const auto* attribute : {"units", "standard_name", "calendar", "axis", "positive"})
    if (NetcdfFile::attribute(*bounds, attribute) &&
        NetcdfFile::text(*bounds, attribute) != NetcdfFile::text(v, attribute))
      found.add(rule("cf.bounds-attributes"), name + ":" + attribute, "it differs from that of " + v.name);
  check_cells(v, *bounds, found);
}

/// Takes the texts in parentheses out; false where they do not close.
bool without_parentheses(std::string_view text, std::string& plain) {
  int depth = 0;
  for (const char c : text) {
    if (c == '(') ++depth;
    if (depth == 0) plain += c;
    if (c == ')' && --depth < 0) return false;
  }
  return depth == 0;
}

bool is_method(const std::string& word) {
  constexpr std::array<std::string_view, 16> methods{"point",
                                                     "sum",
                                                     "maximum",
                                                     "maximum_absolute_value",
                                                     "median",
                                                     "mid_range",
                                                     "minimum",
                                                     "minimum_absolute_value",
                                                     "mean",
                                                     "mean_absolute_value",
                                                     "mean_of_upper_decile",
                                                     "mode",
                                                     "range",
                                                     "root_mean_square",
                                                     "standard_deviation",
                                                     "variance"};
  return word == "sum_of_squares" || std::find(methods.begin(), methods.end(), word) != methods.end();
}

bool is_cell_name(const NetcdfFile& f, const NcVariable& v, const std::string& name) {
  for (std::size_t i = 0; i < v.dimensions.size(); ++i)
    if (f.dimension(v, i).name == name) return true;
  const auto* scalar = f.find(name);
  return name == "area" || (scalar && scalar->dimensions.empty()) || standard_name(name) != nullptr;
}

void check_cell_methods(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  if (!NetcdfFile::attribute(v, "cell_methods")) return;
  const auto where = v.name + ":cell_methods";
  std::string plain;
  if (!without_parentheses(NetcdfFile::text(v, "cell_methods"), plain)) {
    found.add(rule("cf.cell-methods"), where, "its parentheses do not close");
    return;
  }
  const auto all = words(plain);
  for (std::size_t i = 0; i < all.size();) {
    std::size_t names = 0;
    for (; i < all.size() && all[i].ends_with(':'); ++i, ++names) {
      const auto name = all[i].substr(0, all[i].size() - 1);
      if (!is_cell_name(f, v, name))
        found.add(rule("cf.cell-methods-name"), where, name + " is none of its dimensions");
    }
    if (names == 0 || i == all.size()) {
      found.add(rule("cf.cell-methods"), where, "it is \"" + NetcdfFile::text(v, "cell_methods") + "\"");
      return;
    }
    if (!is_method(all[i])) found.add(rule("cf.cell-method"), where, all[i] + " is no method");
    ++i;
    // "where land over sea", "within days": words up to the next name.
    while (i < all.size() && !all[i].ends_with(':') && i > 0 &&
           (all[i] == "where" || all[i] == "over" || all[i] == "within" || all[i - 1] == "where" ||
            all[i - 1] == "over" || all[i - 1] == "within"))
      ++i;
  }
}

void check_packing(const NcVariable& v, Findings& found) {
  const auto *scale = NetcdfFile::attribute(v, "scale_factor"), *offset = NetcdfFile::attribute(v, "add_offset");
  if (!scale && !offset) return;
  const auto type = scale ? scale->type : offset->type;
  if ((scale && offset && scale->type != offset->type) || (type != v.type && !is_float(type)))
    found.add(rule("cf.packing"), v.name, "scale_factor and add_offset have types that do not go together");
}

}  // namespace

void check_cf_cells(const NetcdfFile& f, Findings& found) {
  for (const auto& v : f.variables()) {
    check_bounds(f, v, found);
    check_cell_methods(f, v, found);
    check_packing(v, found);
  }
}

}  // namespace quadsonde::product
