#pragma once
#include "ingest/motion/toml_fields.h"
#include "ingest/motion/vehicle.h"

namespace quadsonde::ingest {

/// The vehicle that [vehicle], [drag], [noise] and [provenance] of a file describe, be it a vehicle file or a scenario.
/// What is wrong goes to the fields' Problem, with the line.
Vehicle vehicle_from_tables(TomlFields& root);

}  // namespace quadsonde::ingest
