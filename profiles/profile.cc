#include "profiles/profile.h"

namespace quadsonde::profiles {

std::string_view name(LegName leg) {
  constexpr std::string_view names[] = {"up", "down", "all"};
  return names[static_cast<int>(leg)];
}
std::string_view name(Datum datum) { return datum == Datum::agl ? "agl" : "msl"; }

}  // namespace quadsonde::profiles
