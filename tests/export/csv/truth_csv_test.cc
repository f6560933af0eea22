#include "export/csv/truth_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

ingest::Truth two_rows() {
  return {{ingest::LogTime{100'000'000}, {10}, {-1.5, 2.25, 0.125}},
          {ingest::LogTime{200'000'000}, {10.5}, {-1.25, 2, -0.5}}};
}

TEST(TruthCsv, HasTheColumnsOfTheContract) {
  EXPECT_EQ(truth_csv(two_rows()),
            "time_s,height_agl_m,wind_east_m_s,wind_north_m_s,wind_up_m_s\n"
            "0.100000,10.000,2.250000,-1.500000,-0.125000\n"
            "0.200000,10.500,2.000000,-1.250000,0.500000\n");
}

TEST(TruthCsv, IsReadBackAsItWasWritten) {
  const auto back = parse_truth_csv(truth_csv(two_rows()), "t.csv");
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*back)[i].time, two_rows()[i].time);
    EXPECT_EQ((*back)[i].height, two_rows()[i].height);
    EXPECT_EQ((*back)[i].v_NA_N, two_rows()[i].v_NA_N);
  }
}

TEST(TruthCsv, TakesColumnsInAnyOrderAndLeavesOthersAlone) {
  const auto read =
      parse_truth_csv("note,wind_up_m_s,wind_north_m_s,wind_east_m_s,height_agl_m,time_s\r\nx,0,1,2,3,4\r\n", "t.csv");
  ASSERT_TRUE(read);
  EXPECT_EQ((*read)[0].v_NA_N, Eigen::Vector3d(1, 2, 0));
  EXPECT_EQ((*read)[0].time, ingest::LogTime{4'000'000'000});
}

TEST(TruthCsv, NamesTheMissingColumnAndTheBadLine) {
  const auto missing = parse_truth_csv("time_s,wind_east_m_s\n1,2\n", "t.csv");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ingest::Kind::missing);
  EXPECT_EQ(missing.error().where.topic, "height_agl_m");
  const std::string head = "time_s,height_agl_m,wind_east_m_s,wind_north_m_s,wind_up_m_s\n";
  for (const auto* row : {"2,1,nan,0,0\n", "2,1,,0,0\n", "2,1,3\n", "1,1,3,0,0\n"}) {
    const auto bad = parse_truth_csv(head + "1,1,1,1,1\n" + row, "t.csv");
    ASSERT_FALSE(bad) << row;
    EXPECT_EQ(bad.error().where.line, 3u) << row;
  }
  EXPECT_FALSE(parse_truth_csv("", "t.csv"));
  EXPECT_FALSE(parse_truth_csv(head, "t.csv"));
  EXPECT_FALSE(read_truth_csv("/nowhere/t.csv"));
}

}  // namespace
}  // namespace quadsonde::product
