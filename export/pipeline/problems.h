#pragma once
// Lists of problems from several stages, each told once.
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// Appends what is not there yet, by its whole text.
void add_once(std::vector<ingest::Problem>& all, const std::vector<ingest::Problem>& more);
void add_once(std::vector<ingest::Problem>& all, const ingest::Problem& problem);

}  // namespace quadsonde::product
