#pragma once
// Pieces of JSON that several products share.
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "profiles/profile.h"

namespace quadsonde::product {

using Json = nlohmann::ordered_json;

/// A number printed with fixed digits, as a JSON number; null for the unknown and for what is not finite.
Json json_number(std::optional<double> value, int digits);
Json json_problem(const ingest::Problem& problem);
Json json_problems(const std::vector<ingest::Problem>& problems);
Json json_vehicle(const ingest::Vehicle& vehicle);
/// The same with the file that it was read from, if there was one.
Json json_vehicle_of(const ProductSource& source);
Json json_settings(const std::vector<NamedSetting>& settings);
/// {"file", "sha256", "flight"}, and "heights" where those above the sea are not the log's own
Json json_source(const ProductSource& source);
/// What every product begins with: schema, version, source, vehicle, settings, problems.
Json json_head(std::string_view schema, const ProductSource& source);
/// A row of a table under the names of its columns, null for the unknown, with its reasons.
Json json_row(const estimator::WindPoint& point, estimator::Mode mode);
Json json_row(const profiles::Bin& bin, profiles::LegName leg);
Json json_reasons(estimator::Reasons reasons);
Json json_diagnostics(const estimator::FlightDiagnostics& diagnostics);
/// What the vehicle did, leg by leg.
Json json_found_legs(const profiles::WindProfile& profile);
/// What is asked of a profile next: winds at heights, shears, laws, jet, Richardson number; what it cannot tell is null.
Json json_levels(const profiles::WindProfile& profile);
/// The test of ascent against descent; null where there is none.
Json json_up_down(const profiles::WindProfile& profile);

/// Indented text with a newline at its end. Bytes that are no UTF-8 (names out of a log) are replaced, not fatal.
std::string json_text(const Json& json);

}  // namespace quadsonde::product
