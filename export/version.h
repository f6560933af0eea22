#pragma once
#include <string_view>

namespace quadsonde::product {

/// "0.1.0": what every product names as its maker.
std::string_view version();

}  // namespace quadsonde::product
