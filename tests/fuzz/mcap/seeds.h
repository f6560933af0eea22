#pragma once
// Small files to start fuzzing from.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace quadsonde::fuzz {

std::vector<std::pair<std::string, std::vector<std::uint8_t>>> mcap_seeds();

}  // namespace quadsonde::fuzz
