#include "export/met_point/met_point.h"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/export/made_up.h"

namespace quadsonde {
namespace {

using product::NetcdfMetadata;
using Line = std::vector<std::string>;

NetcdfMetadata known() {
  NetcdfMetadata metadata;
  metadata.station.wigos_id = "0-454-2-AWSNAMITAMBO";
  metadata.takeoff_msl = ingest::MslHeight{150};
  return metadata;
}

product::Observations one(const estimator::MaybeWind& wind, const product::AirState& air = {}) {
  product::Observations all;
  all.all.push_back({ingest::UtcTime{1'750'000'000'600'000'000},
                     {43.5657, 1.4815},
                     {165.1},
                     profiles::LegName::up,
                     wind,
                     estimator::Quality::doubtful,
                     air});
  return all;
}

std::vector<Line> lines(const product::Observations& observations, const NetcdfMetadata& metadata = known()) {
  std::istringstream stream(product::met_point(observations, metadata));
  std::vector<Line> all;
  for (std::string text; std::getline(stream, text);) {
    std::istringstream words(text);
    auto& line = all.emplace_back();
    for (std::string word; words >> word;) line.push_back(word);
  }
  return all;
}

TEST(MetPoint, HasElevenColumnsAndALinePerValue) {
  const auto all = lines(one(support::estimate_of(5, 270)));
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0], (Line{"ADPUPA", "0-454-2-AWSNAMITAMBO", "20250615_150641", "43.5657000", "1.4815000", "150.00",
                          "UGRD", "NA", "165.10", "1", "5.0000"}));
  EXPECT_EQ(all[1][6], "VGRD");
  EXPECT_EQ(all[1][10], "0.0000");
  EXPECT_EQ(all[2][6], "WIND");
  EXPECT_EQ(all[3][6], "WDIR");
  EXPECT_EQ(all[3][10], "270.00");
}

TEST(MetPoint, PressureIsTheLevelWhereItWasMeasured) {
  const auto all = lines(one(support::estimate_of(5, 270), {285.15, 80, 99000, 281.8, 0.0071}));
  ASSERT_EQ(all.size(), 8u);
  for (const auto& line : all) {
    EXPECT_EQ(line.size(), 11u);
    EXPECT_EQ(line[7], "990.00");
  }
  EXPECT_EQ(all[4][6], "TMP");
  EXPECT_EQ(all[4][10], "285.15");
  EXPECT_EQ(all[7][6], "MIXR");
  EXPECT_EQ(all[7][10], "0.0071000");
}

TEST(MetPoint, WhatIsMissingHasNoLine) {
  EXPECT_TRUE(lines(one(estimator::NoEstimate{})).empty());
  EXPECT_EQ(lines(one(support::estimate_of(0.5, 270, 0.4))).size(), 3u) << "the direction is not known";
}

TEST(MetPoint, AStationIsOneWordWhateverItIsCalled) {
  NetcdfMetadata metadata;
  metadata.station.name = "a name\twith blanks, \xc3\xa9, and far more than forty characters";
  const auto all = lines(one(support::estimate_of(5, 270)), metadata);
  ASSERT_EQ(all[0].size(), 11u);
  EXPECT_EQ(all[0][1].size(), 40u);
  EXPECT_EQ(all[0][5], "NA");
  EXPECT_EQ(lines(one(support::estimate_of(5, 270)), {})[0][1], "43.5657,1.4815") << "no identifier is made up";
}

}  // namespace
}  // namespace quadsonde
