#pragma once
#include <string>

#include "ingest/flight/flight.h"

namespace quadsonde::product {

/// A flight as a table that the CSV reader takes without a map: the canonical columns of design/CLI.md, one row per
/// instant at which anything was measured, a cell filled where that stream has a sample. Times have nine decimals, so
/// none is lost. Events, gaps and the autopilot's own wind have no column. Cannot fail.
std::string flight_csv(const ingest::Flight& flight);

}  // namespace quadsonde::product
