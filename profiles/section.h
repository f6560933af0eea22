#pragma once
// The wind over time and height: each ascent and descent of one flight or of several as a column of its own.
#include <string>
#include <vector>

#include "profiles/merge.h"

namespace quadsonde::profiles {

struct SectionColumn {
  std::string flight;  ///< whose it is, as it was named
  Leg leg;             ///< on the section's bins; with its times
  ingest::UtcTime from, to;
};

/// Nothing is interpolated: what no flight measured, in height or time, is an empty bin or no column.
struct Section {
  Datum datum = Datum::agl;
  double bin_m = 10;
  std::vector<SectionColumn> columns;  ///< in the order of their middle times
};

struct NamedProfile {
  std::string name;
  const WindProfile* profile = nullptr;
};

/// Ascents and descents of the profiles (`flown`); a flight without one gives the leg that stands for it as one column.
/// Kind::usage for other bins or datums and for two sites, Kind::missing where a column has no UTC, Kind::no_answer
/// where nothing has a wind.
ingest::Result<Section> make_section(const std::vector<NamedProfile>& profiles, const MergeSettings& settings = {});

}  // namespace quadsonde::profiles
