#include "tests/fuzz/mcap/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  quadsonde::fuzz::mcap_indexed({data, size});
  return 0;
}
