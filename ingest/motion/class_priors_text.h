#pragma once
// class_priors.toml as a constant; the definition is made while configuring.
#include <string_view>

namespace quadsonde::ingest {

extern const std::string_view shipped_class_priors;

}  // namespace quadsonde::ingest
