#pragma once
#include "export/validate/findings.h"
#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// Every message of a file: its sections by their bytes, its values as ecCodes decodes them in a process of its own.
/// Fails with Kind::no_answer where there is no process to be had.
ingest::Result<void> check_bufr(ingest::Bytes file, Findings& found);

}  // namespace quadsonde::product
