#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace quadsonde::product {

/// A standard name with its canonical units; empty units: it has none (flags, identifiers).
struct StandardName {
  std::string_view name, units;
};

/// Out of a part of the CF Standard Name Table v83: places and times, the air and the wind, platforms, quality, and
/// what weather files hold beside them. Null for others.
const StandardName* standard_name(std::string_view name);
/// The one that is spelt almost so: at most two letters differ. Null if there is none.
const StandardName* almost_standard_name(std::string_view name);

}  // namespace quadsonde::product
