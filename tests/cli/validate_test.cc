// Every product of ours is conformant by our own checker; what is not is said, with its place and its source.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.h"
#include "tests/export/pipeline/flown.h"

namespace quadsonde::cli {
namespace {

using support::quadsonde;
using support::read_text;
using testing::HasSubstr;

struct Place {
  support::TemporaryFolder folder;
  Place() {
    support::place_flight(folder / "a.csv");
    support::write_text(
        folder / "station.toml",
        "[station]\nwigos_id = \"0-454-2-AWSNAMITAMBO\"\n[uasdc]\noperator_id = \"007\"\nairframe_id = \"QS001\"\n");
  }
  support::Ended run(const std::vector<std::string>& arguments) const { return quadsonde(arguments, folder.path()); }
};

TEST(ValidateVerb, IsContentWithEveryProductOfOurs) {
  const Place place;
  ASSERT_THAT(place.run({"run", "a.csv", "-o", "out"}).code, testing::AnyOf(0, 3));
  for (const auto* bufr : {"profiler", "uasdc", "own"})
    ASSERT_THAT(place.run({"profile", "a.csv", "--bufr", bufr, "-o", std::string(bufr) + ".bufr"}).code,
                testing::AnyOf(0, 3));
  ASSERT_THAT(place.run({"profile", "a.csv", "--layout", "uasdc", "-o", "uasdc/"}).code, testing::AnyOf(0, 3));
  ASSERT_THAT(place.run({"estimate", "a.csv", "-o", "wind.mcap"}).code, testing::AnyOf(0, 3));
  ASSERT_THAT(place.run({"archive", "add", "winds", "a.csv"}).code, testing::AnyOf(0, 3));
  ASSERT_THAT(place.run({"archive", "export", "winds", "-o", "merged.nc"}).code, testing::AnyOf(0, 3));
  for (const auto& file : support::tree(place.folder.path())) {
    const auto ending = std::filesystem::path(file).extension();
    if (ending != ".nc" && ending != ".bufr" && ending != ".mcap") continue;
    const auto ended = place.run({"validate", file});
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("conformant: 0 errors, 0 warnings")) << ended.out;
  }
}

TEST(ValidateVerb, SaysWhereAFileIsWrongAndEndsWithThree) {
  const Place place;
  ASSERT_THAT(place.run({"profile", "a.csv", "--bufr", "own", "-o", "p.bufr"}).code, testing::AnyOf(0, 3));
  auto bytes = read_text(place.folder / "p.bufr");
  bytes[7] = 9;
  support::write_text(place.folder / "p.bufr", bytes);
  const auto ended = place.run({"validate", "p.bufr"});
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(ended.out,
              testing::AllOf(HasSubstr("bufr.edition"), HasSubstr("section 0, octet 8"), HasSubstr("not conformant")));
  const auto json = place.run({"validate", "--json", "p.bufr"});
  EXPECT_EQ(json.code, 3);
  EXPECT_THAT(json.out, HasSubstr("\"rule\": \"bufr.edition\""));
}

TEST(ValidateVerb, RefusesWhatItDoesNotKnow) {
  const Place place;
  const auto table = place.run({"validate", "a.csv"});
  EXPECT_EQ(table.code, 1);
  EXPECT_THAT(table.err, HasSubstr("neither netCDF nor BUFR nor MCAP"));
  EXPECT_EQ(place.run({"validate", "nowhere.nc"}).code, 1);
  EXPECT_EQ(place.run({"validate", "."}).code, 1);
  EXPECT_EQ(place.run({"validate"}).code, 2);
}

}  // namespace
}  // namespace quadsonde::cli
