#pragma once
// What the fuzzers do with their bytes; the replay test does the same with the corpus. A broken promise aborts.
#include "ingest/flight/bytes.h"

namespace quadsonde::fuzz {

void mcap_reader(ingest::Bytes bytes);
void mcap_indexed(ingest::Bytes bytes);
void mcap_flight(ingest::Bytes bytes);
void mcap_schema(ingest::Bytes bytes);

}  // namespace quadsonde::fuzz
