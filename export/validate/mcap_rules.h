#pragma once
#include "export/validate/findings.h"
#include "ingest/flight/bytes.h"

namespace quadsonde::product {

/// An MCAP file against its specification: records, CRCs, schemas, messages, indexes, statistics. Memory: one chunk.
void check_mcap(ingest::Bytes file, Findings& found);

}  // namespace quadsonde::product
