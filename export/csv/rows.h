#pragma once
// The rows of wind and profile tables, once for CSV and JSON: names, order and digits.
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// One field as it is printed; an empty text is an unknown. `word` fields are text in JSON, the others numbers.
struct Field {
  std::string_view name;
  std::string text;
  bool word = false;
};
using Row = std::vector<Field>;

/// design/CLI.md, `estimate -o X.csv`.
Row wind_row(const estimator::WindPoint& point, estimator::Mode mode);
/// design/CLI.md, `profile -o X.csv`.
Row profile_row(const profiles::Bin& bin, profiles::LegName leg);

}  // namespace quadsonde::product
