#include "export/validate/validate.h"

#include "export/bufr/bufr_decoder.h"
#include "export/cf_netcdf/describe.h"
#include "export/cf_netcdf/read_profile.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

/// Anything as a file to be judged or read, and as what a child process that decodes one may hand back.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ingest::Bytes bytes{data, size};
  if (const auto said = product::validate(bytes, "UASDC_007_QS001_20260601053007Z.nc")) {
    fuzz::require(!product::validation_text(*said).empty());
    fuzz::require(!product::validation_json(*said).empty());
  }
  if (const auto profile = product::read_profile_netcdf(bytes, "fuzz.nc")) fuzz::require(!profile->records.empty());
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto description = product::unpack_description(text)) fuzz::require(product::pack(*description).size() == size);
  if (const auto content = product::unpack_content(text)) fuzz::require(product::pack(*content).size() == size);
  return 0;
}
