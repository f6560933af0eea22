#include "ingest/dataflash/dataflash_reader.h"
#include "ingest/dataflash/flight_from_dataflash.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

namespace {

/// Every field of every message can be asked for, and skipped, partial and decoded bytes make up the whole.
void walk(ingest::Bytes bytes) {
  ingest::DataflashReader reader(bytes);
  ingest::DataflashMessage message;
  std::uint64_t decoded = 0;
  while (reader.next(message)) {
    decoded += message.layout->length;
    for (const auto& field : message.layout->fields) {
      (void)message.scaled(field);
      (void)message.integer(field);
      fuzz::require(message.text(field).size() <= field.size);
    }
  }
  fuzz::require(decoded + reader.skipped_bytes() + reader.trailing_partial_bytes() == bytes.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ingest::Bytes bytes(data, size);
  walk(bytes);
  (void)ingest::looks_like_dataflash(bytes);
  fuzz::require_sound(ingest::read_dataflash(bytes, "fuzz.bin"), size);
  fuzz::require_sound(ingest::read_dataflash(bytes, "fuzz.bin", {ingest::Reading::strict}), size);
  return 0;
}
