// CF-1.8 sections 2 and 3: names, types, attributes, units, standard names, flags.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "export/validate/netcdf_file.h"
#include "export/validate/standard_names.h"

namespace quadsonde::product {
namespace {

bool is_plain_name(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (name.empty() || !letter(name.front())) return false;
  return std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

void check_globals(const NetcdfFile& f, Findings& found) {
  const auto conventions = f.global_text("Conventions");
  if (!f.claims_cf())
    found.add(rule("cf.conventions"), "",
              conventions.empty() ? "it has no attribute Conventions" : "Conventions is \"" + conventions + "\"");
  else if (conventions.find("CF-1.8") == std::string::npos)
    found.add(rule("cf.version"), "", "Conventions is \"" + conventions + "\"");
  for (const auto* name : {"title", "institution", "source", "history", "references", "comment"}) {
    const auto* a = f.global(name);
    if (a && !is_text(a->type)) found.add(rule("cf.attribute-type"), std::string(":") + name, "it is no text");
  }
  if (f.is_uasdc()) return;  // the campaign asks for none of them
  std::vector<std::string> absent;
  for (const auto* name : {"title", "history"})
    if (!f.global(name)) absent.push_back(name);
  if (!absent.empty())
    found.add(rule("cf.description"), "", fmt::format("it has no {}", fmt::join(absent, " and no ")));
}

void check_names(const NetcdfFile& f, Findings& found) {
  std::map<std::string, std::string> seen;
  for (const auto& v : f.variables()) {
    if (!is_plain_name(v.name)) found.add(rule("cf.name"), v.name, "the name has other signs, or begins with none");
    const auto [at, fresh] = seen.try_emplace(lower_case(v.name), v.name);
    if (!fresh) found.add(rule("cf.name-case"), v.name, "it is told from " + at->second + " by case alone");
    for (const auto& a : v.attributes)
      if (a.name != "_FillValue" && !is_plain_name(a.name))
        found.add(rule("cf.name"), v.name + ":" + a.name, "the name has other signs");
    const std::set<std::uint32_t> distinct(v.dimensions.begin(), v.dimensions.end());
    if (distinct.size() != v.dimensions.size())
      found.add(rule("cf.dimension-twice"), v.name, "it has one dimension twice: " + f.shape_text(v));
  }
}

void check_types(const NetcdfFile& f, Findings& found) {
  // int64 and the unsigned ones came with CF-1.9; the campaign's files number their observations with them.
  constexpr std::array<NcType, 6> later{NcType::ubyte, NcType::uint16, NcType::uint32,
                                        NcType::int64, NcType::uint64, NcType::other};
  constexpr std::array<std::string_view, 10> texts{"units",    "standard_name", "long_name",    "coordinates",
                                                   "bounds",   "flag_meanings", "cell_methods", "grid_mapping",
                                                   "calendar", "positive"};
  for (const auto& v : f.variables()) {
    if (std::find(later.begin(), later.end(), v.type) != later.end())
      found.add(rule("cf.type"), v.name, fmt::format("its type is {}", name_of(v.type)));
    for (const auto& a : v.attributes) {
      if (std::find(texts.begin(), texts.end(), a.name) != texts.end() && !is_text(a.type))
        found.add(rule("cf.attribute-type"), v.name + ":" + a.name, "it is no text");
      const bool own_type = a.name == "_FillValue" || a.name == "missing_value" || a.name.starts_with("valid_");
      if (own_type && a.type != v.type && !NetcdfFile::attribute(v, "scale_factor"))
        found.add(rule("cf.fill-type"), v.name + ":" + a.name,
                  fmt::format("its type is {}, that of the variable {}", name_of(a.type), name_of(v.type)));
    }
  }
}

void check_standard_name(const NcVariable& v, Findings& found) {
  std::string modifier;
  const auto name = NetcdfFile::standard_name_of(v, &modifier);
  if (name.empty()) return;
  const auto where = v.name + ":standard_name";
  if (!standard_name(name)) {
    if (const auto* almost = almost_standard_name(name))
      found.add(rule("cf.standard-name-spelling"), where,
                fmt::format("{} is not in the table, {} is", name, almost->name));
    else
      found.add(rule("cf.standard-name"), where, name + " is not among the names known here");
  }
  constexpr std::array<std::string_view, 4> modifiers{"detection_minimum", "number_of_observations", "standard_error",
                                                      "status_flag"};
  if (!modifier.empty() && std::find(modifiers.begin(), modifiers.end(), modifier) == modifiers.end())
    found.add(rule("cf.standard-name-modifier"), where, modifier + " is none");
}

bool is_reference_time(const std::string& units) { return words(units).size() > 1 && words(units)[1] == "since"; }

/// Canonical units of what a variable says it is; empty where it says nothing, or has none.
std::string canonical_units(const NcVariable& v) {
  std::string modifier;
  const auto name = NetcdfFile::standard_name_of(v, &modifier);
  if (modifier == "number_of_observations") return "1";
  if (modifier == "status_flag") return "";
  const auto* known = standard_name(name);
  return known ? std::string(known->units) : "";
}

/// Differences of temperatures and spreads have the units of what spreads, times that of time.
bool wants_units(const NetcdfFile& f, const NcVariable& v) {
  if (is_text(v.type) || v.type == NcType::other || f.is_grid_mapping(v) || f.is_bounds(v)) return false;
  return !NetcdfFile::is_flags(v);
}

void check_units(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  const auto units = NetcdfFile::text(v, "units"), canonical = canonical_units(v);
  const auto where = v.name + ":units";
  if (!NetcdfFile::attribute(v, "units")) {
    const bool plain = canonical.empty() || canonical == "1";
    if (wants_units(f, v)) {
      // Integers along a dimension, "obs" or "month", only count.
      if (!plain || (f.is_coordinate(v) && is_float(v.type)))
        found.add(rule("cf.units-missing"), v.name, "it is a quantity and has no units");
      else
        found.add(rule("cf.units-absent"), v.name, "it has no units");
    }
    return;
  }
  if (f.is_uasdc() && v.name == "eddy_dissipation_rate") return;  // uasdc.edr-units
  if (!f.units.of(units).known) {
    found.add(rule("cf.units-parse"), where, "UDUNITS does not know \"" + units + "\"");
    return;
  }
  if (!canonical.empty() && !f.units.of(units, canonical).convertible)
    found.add(rule("cf.units-convert"), where,
              fmt::format("\"{}\" does not convert to {}, the canonical units of {}", units, canonical,
                          NetcdfFile::standard_name_of(v)));
}

void check_flags(const NcVariable& v, Findings& found) {
  const auto *values = NetcdfFile::attribute(v, "flag_values"), *masks = NetcdfFile::attribute(v, "flag_masks");
  const auto meanings = words(NetcdfFile::text(v, "flag_meanings"));
  if (!values && !masks && !NetcdfFile::attribute(v, "flag_meanings")) return;
  if (!values && !masks) {
    found.add(rule("cf.flag-meanings"), v.name, "it has flag_meanings, and neither flag_values nor flag_masks");
    return;
  }
  for (const auto* flags : {values, masks}) {
    if (!flags) continue;
    const auto where = v.name + ":" + flags->name;
    if (flags->numbers.size() != meanings.size())
      found.add(rule("cf.flag-meanings"), where,
                fmt::format("{} flags and {} meanings", flags->numbers.size(), meanings.size()));
    if (flags->type != v.type)
      found.add(rule("cf.flag-type"), where,
                fmt::format("its type is {}, that of the variable {}", name_of(flags->type), name_of(v.type)));
    const std::set<double> distinct(flags->numbers.begin(), flags->numbers.end());
    if (!masks && distinct.size() != flags->numbers.size())
      found.add(rule("cf.flag-values"), where, "one value stands twice");
    if (flags == masks && distinct.contains(0)) found.add(rule("cf.flag-values"), where, "a mask is zero");
  }
  if (!values || masks || v.data != NcData::all) return;
  const std::set<double> known(values->numbers.begin(), values->numbers.end());
  for (const double value : NetcdfFile::data(v))
    if (!std::isnan(value) && !known.contains(value)) {
      found.add(rule("cf.flag-data"), v.name, fmt::format("{} has no meaning", value));
      return;
    }
}

void check_ancillary(const NetcdfFile& f, const NcVariable& v, Findings& found) {
  for (const auto& name : words(NetcdfFile::text(v, "ancillary_variables")))
    if (!f.find(name))
      found.add(rule("cf.ancillary-variables"), v.name + ":ancillary_variables", "there is no " + name);
}

}  // namespace

void ask_cf_units(NetcdfFile& f) {
  for (const auto& v : f.variables()) {
    const auto units = NetcdfFile::text(v, "units");
    f.units.ask(units);
    f.units.ask(units, canonical_units(v));
    if (is_reference_time(units)) f.units.ask(units, "seconds since 1970-01-01");
    f.units.ask(units, "m");
    f.units.ask(units, "Pa");
  }
}

void check_cf_texts(const NetcdfFile& f, Findings& found) {
  check_globals(f, found);
  check_names(f, found);
  check_types(f, found);
  for (const auto& v : f.variables()) {
    check_standard_name(v, found);
    check_flags(v, found);
    check_ancillary(f, v, found);
    const bool told = !NetcdfFile::text(v, "long_name").empty() || !NetcdfFile::text(v, "standard_name").empty();
    if (!told && f.is_data(v)) found.add(rule("cf.described"), v.name, "it has neither long_name nor standard_name");
  }
}

void check_cf_units(const NetcdfFile& f, Findings& found) {
  for (const auto& v : f.variables()) check_units(f, v, found);
}

}  // namespace quadsonde::product
