// Recorded flights whose faults are known from their own papers and anemometers (PROVENANCE.md of the shared data).
#include <gtest/gtest.h>

#include <algorithm>

#include "ingest/flight/segments.h"
#include "ingest/motion/consistency.h"
#include "ingest/open/open_log.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

/// The longest airborne part of a log; all of it where take-off and landing were cut off.
Flight longest(const std::filesystem::path& file, const std::optional<std::filesystem::path>& map = {}) {
  OpenSettings settings;
  if (map) settings.columns = read_column_map(*map).value();
  const auto log = open_log(file, settings);
  EXPECT_TRUE(log) << (log ? "" : to_string(log.error()));
  if (!log || log->flights.empty()) return {};
  const auto& flight = log->flights.front();
  const auto segments = airborne_segments(flight);
  if (segments.empty()) return flight;
  const auto best = *std::max_element(segments.begin(), segments.end(),
                                      [](const auto& a, const auto& b) { return a.to - a.from < b.to - b.from; });
  return cut(flight, best.from, best.to);
}

ConsistencyReport checked(const Flight& flight) {
  const auto report = check_consistency(flight);
  EXPECT_TRUE(report) << (report ? "" : to_string(report.error()));
  return report ? *report : ConsistencyReport{};
}

TEST(RecordedFlight, WithRollAndPitchExchangedIsCondemnedForIt) {
  QUADSONDE_NEEDS_DATA("flights/sph_skyhub_wind/wind-trajectory1.csv.gz");
  const auto report = checked(longest(support::data_file("flights/sph_skyhub_wind/wind-trajectory1.csv.gz")));
  EXPECT_EQ(report.verdict, Verdict::inconsistent) << to_text(report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.front().id, "roll-pitch-exchanged") << to_text(report);
}

TEST(RecordedFlight, WithItsColumnsPutRightIsNotCondemned) {
  QUADSONDE_NEEDS_DATA("flights/sph_skyhub_wind/wind-trajectory1.csv.gz");
  const auto report = checked(longest(support::data_file("flights/sph_skyhub_wind/wind-trajectory1.csv.gz"),
                                      std::filesystem::path(QUADSONDE_MAPS) / "skyhub_exchanged.toml"));
  EXPECT_NE(report.verdict, Verdict::inconsistent) << to_text(report);
}

TEST(RecordedFlight, WhosePitchIsNoBodyPitchIsCondemned) {
  QUADSONDE_NEEDS_DATA("flights/nmt_m600_trisonica/level0.csv.gz");
  const auto report = checked(longest(support::data_file("flights/nmt_m600_trisonica/level0.csv.gz")));
  EXPECT_EQ(report.verdict, Verdict::inconsistent) << to_text(report);
}

TEST(RecordedFlight, BesideTheMastIsNotCondemned) {
  for (const char* name :
       {"derived_FLY139__20210420_092926__Hover.csv.gz", "derived_FLY139__20210420_093827__Square.csv.gz",
        "derived_FLY168__20210503_143909__Vertical3ms.csv.gz"}) {
    const auto file = std::string("flights/epfl_wemuav/") + name;
    QUADSONDE_NEEDS_DATA(file);
    const auto report = checked(longest(support::data_file(file)));
    EXPECT_NE(report.verdict, Verdict::inconsistent) << name << "\n" << to_text(report);
    if (std::string_view(name).find("Hover") != std::string_view::npos) {
      EXPECT_EQ(report.verdict, Verdict::cannot_be_shown);
    }
  }
}

}  // namespace
}  // namespace quadsonde::ingest
