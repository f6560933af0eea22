#include "ingest/flight/flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace quadsonde::ingest {
namespace {

LogTime at(double s) { return LogTime{} + seconds(s); }
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Flight ten_samples() {
  Flight flight;
  for (int i = 0; i < 10; ++i) {
    flight.attitude.push(at(i), Eigen::Quaterniond(std::cos(0.05 * i), 0, 0, std::sin(0.05 * i)));
    flight.velocity.push(at(i), Eigen::Vector3d(i, 0, 0));
    flight.velocity.sd.push_back(0.1 * (i + 1));
    flight.height_msl.push(at(i), MslHeight{100.0 + i});
    flight.landed.push(at(i), i < 2);
  }
  return flight;
}

TEST(Tidy, SortsAStreamByTimeAndKeepsTheOrderOfEqualTimes) {
  Flight flight;
  flight.velocity.push(at(2), {2, 0, 0});
  flight.velocity.push(at(1), {1, 0, 0});
  flight.velocity.push(at(2), {3, 0, 0});
  flight.velocity.sd = {0.2, 0.1, 0.3};
  tidy(flight);
  ASSERT_EQ(flight.velocity.size(), 3u);
  EXPECT_EQ(flight.velocity.value[0].x(), 1);
  EXPECT_EQ(flight.velocity.value[1].x(), 2);
  EXPECT_EQ(flight.velocity.value[2].x(), 3);
  EXPECT_EQ(flight.velocity.sd, (std::vector<double>{0.1, 0.2, 0.3})) << "the sds go with their samples";
  EXPECT_TRUE(flight.problems.empty()) << "nothing was lost";
}

TEST(Tidy, LeavesOutWhatIsNotANumberAndSaysSoOncePerStream) {
  Flight flight = ten_samples();
  flight.velocity.value[3].y() = nan;
  flight.velocity.value[4].z() = std::numeric_limits<double>::infinity();
  flight.attitude.value[5] = Eigen::Quaterniond(0, 0, 0, 0);
  flight.position.push(at(0), {0, 0});
  flight.position.push(at(1), {43.5, 1.5});
  flight.position.push(at(2), {nan, 1.5});
  flight.height_msl.value[9].m = 1e9;
  tidy(flight);
  EXPECT_EQ(flight.velocity.size(), 8u);
  EXPECT_EQ(flight.velocity.sd.size(), 8u);
  EXPECT_EQ(flight.velocity.sd[3], 0.1 * 6);
  EXPECT_EQ(flight.attitude.size(), 9u);
  ASSERT_EQ(flight.position.size(), 1u) << "0, 0 is what receivers write before the first fix";
  EXPECT_EQ(flight.height_msl.size(), 9u);
  ASSERT_EQ(flight.problems.size(), 4u);
  EXPECT_EQ(flight.problems[1].what, "2 of 10 velocity samples are not numbers and were left out");
}

TEST(Tidy, MakesQuaternionsUnitAndASecondTimeChangesNoBit) {
  Flight flight;
  flight.attitude.push(at(0), Eigen::Quaterniond(1.1, 0.2, -0.3, 0.4));
  tidy(flight);
  EXPECT_NEAR(flight.attitude.value[0].norm(), 1, 1e-15);
  const auto once = flight.attitude.value[0].coeffs().eval();
  tidy(flight);
  EXPECT_EQ(flight.attitude.value[0].coeffs(), once);
}

TEST(Cut, KeepsBothEndsAndEveryColumnOfTheSameLength) {
  const Flight part = cut(ten_samples(), at(2), at(5));
  EXPECT_EQ(part.velocity.size(), 4u);
  EXPECT_EQ(part.velocity.sd, (std::vector<double>{0.1 * 3, 0.1 * 4, 0.1 * 5, 0.1 * 6}));
  EXPECT_EQ(part.attitude.size(), 4u);
  EXPECT_EQ(part.height_msl.value.front(), MslHeight{102});
  EXPECT_EQ(part.landed.size(), 4u);
}

TEST(Cut, OfNothingIsEmpty) {
  EXPECT_TRUE(cut(ten_samples(), at(20), at(30)).velocity.empty());
  // An interval that ends before it begins.
  const Flight none = cut(ten_samples(), at(6), at(3));
  EXPECT_TRUE(none.velocity.empty() && none.velocity.sd.empty() && none.attitude.empty());
}

TEST(TimeSpan, CoversAttitudeAndVelocityTogether) {
  Flight flight;
  EXPECT_FALSE(time_span(flight));
  flight.attitude.push(at(3), Eigen::Quaterniond::Identity());
  flight.velocity.push(at(1), {0, 0, 0});
  flight.velocity.push(at(2), {0, 0, 0});
  const auto span = time_span(flight);
  ASSERT_TRUE(span);
  EXPECT_EQ(span->first, at(1));
  EXPECT_EQ(span->second, at(3));
}

TEST(Stream, FindsTheLastSampleAtOrBeforeATime) {
  const Flight flight = ten_samples();
  EXPECT_EQ(last_at_or_before(flight.height_msl, at(-1)), -1);
  EXPECT_EQ(last_at_or_before(flight.height_msl, at(4)), 4);
  EXPECT_EQ(last_at_or_before(flight.height_msl, at(4.5)), 4);
  EXPECT_EQ(last_at_or_before(flight.height_msl, at(99)), 9);
}

}  // namespace
}  // namespace quadsonde::ingest
