#include "profiles/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace quadsonde::profiles {
namespace {

using ingest::fail;
using ingest::Kind;

bool has_wind(const Leg& leg) {
  return std::any_of(leg.bins.begin(), leg.bins.end(),
                     [](const Bin& bin) { return std::holds_alternative<estimator::WindEstimate>(bin.wind); });
}

/// The columns of one flight.
std::vector<const Leg*> legs_of(const WindProfile& profile) {
  std::vector<const Leg*> legs;
  for (const auto& leg : profile.flown)
    if (has_wind(leg)) legs.push_back(&leg);
  if (!legs.empty()) return legs;
  for (const auto& leg : profile.legs)
    if (has_wind(leg) && (legs.empty() || leg.name == LegName::all)) legs = {&leg};
  return legs;
}

/// A row for a height that the flight did not reach.
Bin empty_bin(double bottom, double bin_m, Datum datum) {
  Bin bin;
  bin.bottom = bottom, bin.top = bottom + bin_m;
  bin.reasons.add(estimator::Reason::no_samples);
  if (datum == Datum::agl)
    bin.height_agl = ingest::GroundHeight{bottom + bin_m / 2};
  else
    bin.height_msl = ingest::MslHeight{bottom + bin_m / 2};
  return bin;
}

/// All columns from the lowest to the highest bin of any.
void to_one_grid(Section& section) {
  std::int64_t low = INT64_MAX, high = INT64_MIN;
  const auto index = [&](const Bin& bin) { return std::llround(bin.bottom / section.bin_m); };
  for (const auto& column : section.columns)
    for (const auto& bin : column.leg.bins)
      low = std::min<std::int64_t>(low, index(bin)), high = std::max<std::int64_t>(high, index(bin));
  for (auto& column : section.columns) {
    std::vector<Bin> bins;
    for (auto i = low; i <= high; ++i)
      bins.push_back(empty_bin(static_cast<double>(i) * section.bin_m, section.bin_m, section.datum));
    for (auto& bin : column.leg.bins) bins[static_cast<std::size_t>(index(bin) - low)] = std::move(bin);
    column.leg.bins = std::move(bins);
  }
}

}  // namespace

ingest::Result<Section> make_section(const std::vector<NamedProfile>& profiles, const MergeSettings& settings) {
  std::vector<const WindProfile*> all;
  for (const auto& one : profiles) all.push_back(one.profile);
  if (all.empty())
    return fail(Kind::no_answer, "no flight has a profile, so there is no section", {}, "give more logs");
  if (const auto problem = why_not_one_site(all, settings)) return fail(*problem);
  Section section;
  section.datum = all.front()->datum;
  section.bin_m = all.front()->bin_m;
  for (const auto& one : profiles)
    for (const auto* leg : legs_of(*one.profile)) {
      if (!leg->utc_from || !leg->utc_to)
        return fail(Kind::missing, fmt::format("no section without UTC: the clock of {} never saw it", one.name), {},
                    "give --start-utc T");
      section.columns.push_back({one.name, *leg, *leg->utc_from, *leg->utc_to});
    }
  if (section.columns.empty())
    return fail(Kind::no_answer, "no bin of these flights has a wind, so there is no section", {},
                "see the reasons that `quadsonde profile` gives");
  to_one_grid(section);
  const auto middle = [](const SectionColumn& c) { return c.from.ns / 2 + c.to.ns / 2; };
  std::stable_sort(section.columns.begin(), section.columns.end(),
                   [&](const auto& a, const auto& b) { return middle(a) < middle(b); });
  return section;
}

}  // namespace quadsonde::profiles
