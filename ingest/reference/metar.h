#pragma once
#include <optional>
#include <string_view>

#include "ingest/reference/reference.h"

namespace quadsonde::ingest {

inline constexpr double knot = 1852.0 / 3600.0;  ///< [m/s], exact

/// The wind of one METAR or SPECI: station, DDHHMMZ, dddff(f)(Gff(f))KT|MPS|KMH, dddVddd; remarks are not read.
/// Height 10 m. VRB has no direction, 00000KT is calm, P99 means above. Empty where the report holds no wind (NIL, /////).
/// @param near  see read_reference
/// Source: WMO-No. 306, Vol. I.1, FM 15 METAR.
std::optional<ReferenceWind> parse_metar(std::string_view report, std::optional<UtcTime> near);

}  // namespace quadsonde::ingest
