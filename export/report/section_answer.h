#pragma once
// A time-height section for a terminal of 80 columns.
#include <string>

#include "export/report/words.h"
#include "profiles/section.h"

namespace quadsonde::product {

/// Title, then speed and direction of every bin, height down and time across, at most six columns side by side; what is
/// doubtful has a "?", what is bad an "!".
std::string section_answer(const FlightTitle& title, const profiles::Section& section, const ingest::Vehicle& vehicle);

}  // namespace quadsonde::product
