#include "export/pipeline/merge.h"

#include <fmt/format.h>

#include "export/pipeline/problems.h"
#include "export/sha256.h"

namespace quadsonde::product {

namespace {

std::string name_of(const FlightAnswer& answer) {
  return answer.source.file + (answer.title.flights > 1 ? fmt::format(" ({})", answer.source.flight) : "");
}

/// Who and what the flights were, as of one.
FlightAnswer together(const std::vector<const FlightAnswer*>& answers) {
  const FlightAnswer& first = *answers.front();
  FlightAnswer out;
  out.part = first.part;
  out.title = first.title;
  out.station = first.station;
  out.product = first.product;
  out.source = first.source;
  out.source.file.clear();
  std::string fingerprints;
  double flown = 0;
  for (const auto* answer : answers) {
    if (answer != &first) out.source.file += ", ";
    out.source.file += name_of(*answer);
    fingerprints += answer->source.sha256 + fmt::format(" {}\n", answer->source.flight);
    flown += answer->title.duration_s;
    add_once(out.source.problems, answer->source.problems);
  }
  out.source.sha256 = sha256_hex(ingest::as_bytes(fingerprints));
  out.title.flight = out.title.flights = 1;
  out.title.duration_s = flown;
  return out;
}

}  // namespace

ingest::Result<FlightAnswer> merge_answers(const std::vector<const FlightAnswer*>& answers) {
  std::vector<const profiles::WindProfile*> all;
  for (const auto* answer : answers)
    if (answer->profile) all.push_back(&*answer->profile);
  auto merged = profiles::merge_profiles(all);
  if (!merged) return ingest::fail(merged.error());
  auto out = together(answers);
  add_once(out.source.problems, merged->profile.problems);
  out.title.file = fmt::format("{} flights merged ({})", answers.size(), out.source.file);
  out.merged = MergeFacts{merged->spread, merged->hours, merged->farthest_m, answers.size()};
  out.profile = std::move(merged->profile);
  return out;
}

ingest::Result<FlightAnswer> section_of(const std::vector<const FlightAnswer*>& answers) {
  std::vector<profiles::NamedProfile> all;
  for (const auto* answer : answers)
    if (answer->profile) all.push_back({name_of(*answer), &*answer->profile});
  auto section = profiles::make_section(all);
  if (!section) return ingest::fail(section.error());
  FlightAnswer out;
  if (answers.size() == 1) {
    out = *answers.front();
  } else if (auto merged = merge_answers(answers)) {
    out = std::move(*merged);
  } else {
    out = together(answers);
    out.title.file = fmt::format("{} flights ({})", answers.size(), out.source.file);
  }
  out.section = std::move(*section);
  return out;
}

std::string spread_sentence(const FlightAnswer& merged) {
  const auto& facts = *merged.merged;
  return fmt::format(
      "{} flights within {:.1f} h and {:.0f} m: they differ from their mean with chi-square {:.0f} for {} degrees of "
      "freedom (p = {:.3f}), so {}.",
      facts.flights, facts.hours, facts.farthest_m, facts.spread.chi2, facts.spread.degrees_of_freedom,
      facts.spread.p_value,
      facts.spread.degrees_of_freedom == 0 ? "no height was flown twice and nothing tests them"
      : facts.spread.p_value < 0.01        ? "they scatter more than their uncertainties say"
                                           : "they scatter as their uncertainties say");
}

}  // namespace quadsonde::product
