#include "export/version.h"

namespace quadsonde::product {

std::string_view version() { return QUADSONDE_VERSION; }

}  // namespace quadsonde::product
