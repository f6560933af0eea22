// Recorded flights through `check` as a user calls it: the verdicts that their own papers and anemometers demand.
#include "tests/replay/check_table.h"

#include <gtest/gtest.h>

#include "tests/support/data.h"

namespace quadsonde::replay {
namespace {

using ingest::Verdict;

CheckRow checked(const std::string& file, const std::optional<std::filesystem::path>& columns = {}) {
  const auto data = support::data_file("");
  const auto row = check_file(data / file, data, columns);
  std::printf("%s", markdown({row}).c_str());
  return row;
}

TEST(CheckOfRecordedFlights, CondemnsTheSkyhubTableAsItsColumnsAreNamedAndNamesTheExchange) {
  QUADSONDE_NEEDS_DATA("flights/sph_skyhub_wind/wind-trajectory1.csv.gz");
  const auto row = checked("flights/sph_skyhub_wind/wind-trajectory1.csv.gz");
  EXPECT_EQ(row.verdict, Verdict::inconsistent);
  EXPECT_EQ(row.fault, "roll-pitch-exchanged");
  EXPECT_EQ(row.exit_code, 3);
  EXPECT_LT(row.chi2_restored, row.chi2 / 2) << "undoing what it names must restore the flight";
}

TEST(CheckOfRecordedFlights, DoesNotCondemnTheSkyhubTableWithItsColumnsPutRight) {
  QUADSONDE_NEEDS_DATA("flights/sph_skyhub_wind/wind-trajectory1.csv.gz");
  const auto row = checked("flights/sph_skyhub_wind/wind-trajectory1.csv.gz",
                           std::filesystem::path(QUADSONDE_MAPS) / "skyhub_exchanged.toml");
  ASSERT_TRUE(row.verdict.has_value()) << row.reason;
  EXPECT_NE(row.verdict, Verdict::inconsistent) << row.reason;
}

TEST(CheckOfRecordedFlights, CondemnsTheM600WhosePitchIsNoBodyPitch) {
  QUADSONDE_NEEDS_DATA("flights/nmt_m600_trisonica/level0.csv.gz");
  const auto row = checked("flights/nmt_m600_trisonica/level0.csv.gz");
  EXPECT_EQ(row.verdict, Verdict::inconsistent) << row.reason;
  EXPECT_EQ(row.exit_code, 3);
}

TEST(CheckOfRecordedFlights, DoesNotCondemnTheThreeFlightsBesideTheMast) {
  for (const char* name :
       {"derived_FLY139__20210420_092926__Hover.csv.gz", "derived_FLY139__20210420_093827__Square.csv.gz",
        "derived_FLY168__20210503_143909__Vertical3ms.csv.gz"}) {
    const auto file = std::string("flights/epfl_wemuav/") + name;
    QUADSONDE_NEEDS_DATA(file);
    const auto row = checked(file);
    ASSERT_TRUE(row.verdict.has_value()) << row.reason;
    EXPECT_NE(row.verdict, Verdict::inconsistent) << row.reason;
  }
}

TEST(CheckOfRecordedFlights, SaysOfEveryFileAVerdictOrWhyThereIsNone) {
  QUADSONDE_NEEDS_DATA("logs/ulog");
  const auto data = support::data_file("");
  // The largest logs are left to the table's program.
  const auto rows = check_folder(data / "logs", data, {"mcap-conformance", "sample.ulg", "80_01_06"});
  EXPECT_GT(rows.size(), 20u);
  for (const auto& row : rows) EXPECT_FALSE(row.reason.empty() && row.verdict != Verdict::consistent) << row.file;
}

}  // namespace
}  // namespace quadsonde::replay
