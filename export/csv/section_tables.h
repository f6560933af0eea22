#pragma once
// A time-height section as CSV and JSON.
#include <string>

#include "export/csv/source.h"
#include "profiles/section.h"

namespace quadsonde::product {

/// The columns of a profile, then `section_column` (from 1), `section_from_utc` and `section_to_utc`; one row per
/// column and bin, empty bins included. Cannot fail.
std::string section_csv(const profiles::Section& section);
/// One object of schema quadsonde.section/1: its `columns` say whose they are, its `rows` are those of the CSV with
/// their reasons.
std::string section_json(const profiles::Section& section, const ProductSource& source);

}  // namespace quadsonde::product
