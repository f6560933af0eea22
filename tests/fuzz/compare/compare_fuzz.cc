#include "export/csv/read_tables.h"
#include "export/pipeline/compare.h"
#include "profiles/make_profile.h"
#include "tests/export/made_up.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

namespace {

/// Says all that there is to say; every text must come out.
void say(const product::Comparison& comparison) {
  fuzz::require(!product::comparison_text(comparison).empty());
  fuzz::require(!product::comparison_json(comparison, "fuzz", 1).empty());
}

void compare(const product::FlightWinds& ours, const product::ReferenceFile& reference) {
  say(product::compare_with(ours, {reference}, {}));
}

}  // namespace

/// Anything as a reference for a made-up flight, and as a wind or profile of ours beside a report.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(ingest::as_text({data, size}));
  const auto series = support::made_up_series(60);
  const auto profile = support::made_up_profile();
  if (const auto reference = product::reference_of("fuzz", text)) {
    compare({&series, nullptr, &profile}, *reference);
    compare({nullptr, nullptr, &profile}, *reference);
  }
  const auto tables = product::read_tables(text, "fuzz");
  if (!tables) return 0;
  const auto report = product::reference_of("fuzz", "2025-06-15 15:10 LFBO 151510Z 24006G12KT 210V280\n");
  const product::ReferenceFile truth{
      "fuzz", ingest::Truth{{ingest::LogTime{0}, {10}, {1, 2, 0}}, {ingest::LogTime{1'000'000'000}, {12}, {1, 2, 0}}}};
  for (const auto& table : *tables) {
    const auto* wind = std::get_if<estimator::WindSeries>(&table.content);
    const auto* bins = std::get_if<profiles::WindProfile>(&table.content);
    const auto made = wind ? profiles::make_profile(*wind) : ingest::Result<profiles::WindProfile>(*bins);
    const product::FlightWinds ours{wind, nullptr, made ? &*made : nullptr};
    if (!wind && !bins) continue;
    compare(ours, *report);
    compare(ours, truth);
  }
  return 0;
}
