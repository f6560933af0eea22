#pragma once
// Several flights' answers to one: the profile of a site.
#include <string>
#include <vector>

#include "export/pipeline/analyse.h"
#include "profiles/merge.h"

namespace quadsonde::product {

/// The flights' profiles merged (profiles/merge.h). Vehicle, station and settings are the first flight's; the source
/// names every file, and its SHA-256 is that of their SHA-256 one after the other. There is no wind along a flight.
/// Fails as merge_profiles does.
ingest::Result<FlightAnswer> merge_answers(const std::vector<const FlightAnswer*>& answers);

/// The flights' ascents and descents over time and height (profiles/section.h), with the merged profile beside them where
/// there are several flights that can be merged, and the flight's own where there is one. Fails as make_section does.
ingest::Result<FlightAnswer> section_of(const std::vector<const FlightAnswer*>& answers);

/// How the flights agree with each other and with what they claim, in a sentence or two.
std::string spread_sentence(const FlightAnswer& merged);

}  // namespace quadsonde::product
