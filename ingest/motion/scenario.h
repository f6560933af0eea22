#pragma once
#include <filesystem>
#include <string_view>

#include "ingest/flight/problem.h"
#include "ingest/motion/simulator.h"

namespace quadsonde::ingest {

/// SCENARIO.toml of design/CLI.md: [vehicle] (a vehicle file's tables, a path to one, or nothing for the published
/// vehicle), [site], [wind], [[path]], [sensors], seed; [simulator] model = "rigid_body" flies the vehicle of
/// [rigid_body] instead of a point mass. Unknown keys are a Problem, with the line.
Result<Scenario> parse_scenario(std::string_view toml, const std::filesystem::path& file);
Result<Scenario> read_scenario(const std::filesystem::path& file);

}  // namespace quadsonde::ingest
