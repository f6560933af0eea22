#pragma once
// The texts of ingest/csv/maps/*.toml, compiled in (shipped_maps.cc is made by CMake).
#include <string_view>
#include <utility>

namespace quadsonde::ingest::csv {

extern const std::pair<std::string_view, std::string_view> shipped_map_texts[SHIPPED_MAP_COUNT];

}  // namespace quadsonde::ingest::csv
