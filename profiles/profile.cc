#include "profiles/profile.h"

namespace quadsonde::profiles {

std::string_view name(LegName leg) {
  constexpr std::string_view names[] = {"up", "down", "all"};
  return names[static_cast<int>(leg)];
}
std::string_view name(Datum datum) { return datum == Datum::agl ? "agl" : "msl"; }
std::string_view name(Method method) { return method == Method::bins ? "bins" : "optimal"; }
std::string_view name(FoundLeg::Kind kind) {
  constexpr std::string_view names[] = {"ascent", "descent", "hover", "level leg", "transit"};
  return names[static_cast<int>(kind)];
}

}  // namespace quadsonde::profiles
