#include <algorithm>

#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

/// The .log, a NUL, the .data; without a NUL all is .data.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ingest::Bytes bytes(data, size);
  const auto nul = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  (void)ingest::looks_like_paparazzi_data(bytes);
  if (nul == bytes.end()) {
    fuzz::require_sound(ingest::read_paparazzi(bytes, std::nullopt, "fuzz.data"), size);
    return 0;
  }
  const auto at = static_cast<std::size_t>(nul - bytes.begin());
  const auto log = bytes.first(at), lines = bytes.subspan(at + 1);
  fuzz::require_sound(ingest::read_paparazzi(lines, log, "fuzz.data"), size);
  fuzz::require_sound(ingest::read_paparazzi(lines, log, "fuzz.data", {ingest::Reading::strict, "42"}), size);
  return 0;
}
