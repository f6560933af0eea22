#pragma once
// Short answers for a terminal of 80 columns, plain ASCII.
#include <string>

#include "export/report/autopilot_wind.h"
#include "export/report/words.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// Breaks text between words; lines after the first start with `indent` blanks.
std::string wrapped(const std::string& text, std::size_t columns = 79, std::size_t indent = 0);

/// The profile as a table, highest bin first: height, then speed and direction of the whole flight with 95 %
/// intervals, ascent and descent beside them where both were flown.
std::string profile_table(const profiles::WindProfile& profile);
/// Title, table, what the wind rests on and what would make it better.
std::string profile_answer(const FlightTitle& title, const profiles::WindProfile& profile,
                           const estimator::FlightDiagnostics& diagnostics, const ingest::Vehicle& vehicle,
                           const std::optional<AutopilotComparison>& autopilot = {});
/// The same of several flights; `spread` says how they agree.
std::string merged_answer(const FlightTitle& title, const profiles::WindProfile& profile, const std::string& spread,
                          const ingest::Vehicle& vehicle);

/// Title, the wind in up to twelve parts of the flight, what it rests on and what would make it better.
std::string wind_answer(const FlightTitle& title, const estimator::WindSeries& series, const ingest::Vehicle& vehicle,
                        const std::optional<AutopilotComparison>& autopilot = {});

}  // namespace quadsonde::product
