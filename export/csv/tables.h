#pragma once
// Wind and profile as CSV and JSON, exactly as design/CLI.md has them. Unknowns are empty in CSV, null in JSON.
#include <string>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// One row per filter step. Cannot fail.
std::string wind_csv(const estimator::WindSeries& series);
/// One row per bin and leg, from the ground up, empty bins included. Cannot fail.
std::string profile_csv(const profiles::WindProfile& profile);

/// One object of schema quadsonde.wind/1 or quadsonde.profile/1, indented, with a newline at its end.
std::string wind_json(const estimator::WindSeries& series, const ProductSource& source);
std::string profile_json(const profiles::WindProfile& profile, const ProductSource& source);
/// Several flights: a list of such objects.
std::string json_list(const std::vector<std::string>& objects);

}  // namespace quadsonde::product
